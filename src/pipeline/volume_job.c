#include "hewn/volume_job.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/distinct.h"
#include "pipeline/frame.h"
#include "pipeline/mesh_parts.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/stages.h"

/* A job under way. */
typedef struct volume_job {
    const hewn_volume_job_desc *desc;
    hewn_volume_report *report;
    hewn_stages stages;
    hewn_volume volume;
    uint64_t frame; /* of `volume`: what is asked for, or 0 where only that one is left */
    hewn_triangles mesh;
    hewn_mesh_parts parts; /* where there is a limit of memory: `mesh` is a view of them */
} volume_job;

/* --- before any work ---------------------------------------------------------------------------------------------- */

static hewn_result check_method(const hewn_volume_job_desc *desc, hewn_error *error)
{
    if (desc->method != HEWN_METHOD_DEFAULT && !hewn_method_name(desc->method))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "volumes are meshed by mc33, mc, nets or dc");
    return HEWN_OK;
}

static hewn_result check(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    if (!desc->input || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    HEWN_TRY(hewn_output_format(desc->output, desc->format, &job->report->to, error));
    HEWN_TRY(hewn_frame_check_space(job->report->to, desc->space, desc->to_unit, error));
    HEWN_TRY(check_method(desc, error));
    if (desc->open && desc->keep)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "which bodies to keep can be said where their surfaces are closed, not with open ones");
    if (desc->max_memory > 0 && (desc->filter || desc->keep || desc->smooth || desc->simplify))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s needs all of it in memory, so it excludes a limit of memory",
                         desc->filter   ? "smoothing a volume"
                         : desc->keep   ? "choosing bodies"
                         : desc->smooth ? "smoothing a mesh"
                                        : "simplifying a mesh");
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

/* Samples that cannot stay in the file are read whole, and have to fit. */
static hewn_result read_within(volume_job *job, hewn_volume_read_desc *read, hewn_error *error)
{
    uint64_t most = job->desc->max_memory;
    bool limits = most > 0 && (read->memory_limit == 0 || most < read->memory_limit);
    if (limits)
        read->memory_limit = most;
    hewn_result result = hewn_volume_read(job->desc->input, read, &job->volume, error);
    if (result != HEWN_LIMIT || !limits)
        return result;
    return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->desc->input, 0,
                        "a volume that is packed or not in this machine's byte order is read whole, and its samples "
                        "take more than the %llu bytes that are allowed",
                        (unsigned long long)most);
}

static hewn_result load(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    hewn_volume_read_desc read = desc->read;
    read.progress = desc->progress;
    read.blocks = !desc->filter; /* filters write samples that lie in a row */
    hewn_stage_begin(&job->stages);
    report->from = read.format != HEWN_VOLUME_UNKNOWN ? read.format : hewn_volume_format_of_file(desc->input);
    HEWN_TRY(read_within(job, &read, error));
    const hewn_volume *volume = &job->volume;
    if (desc->frame >= volume->frame_count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no frame %llu; the volume has %llu, counted from 0",
                         (unsigned long long)desc->frame, (unsigned long long)volume->frame_count);
    memcpy(report->dims, volume->dims, sizeof report->dims);
    report->type = volume->type;
    report->slope = volume->slope;
    report->intercept = volume->intercept;
    report->frame_count = volume->frame_count;
    report->frame = job->frame = desc->frame;
    report->anatomical = volume->anatomical;
    report->left_handed = hewn_volume_determinant(volume) < 0;
    report->remark = volume->remark ? hewn_strdup(volume->remark) : NULL;
    hewn_stage_end(&job->stages, "load");
    return HEWN_OK;
}

/* The smoothed frame takes the place of the volume. */
static hewn_result filter(volume_job *job, hewn_error *error)
{
    if (!job->desc->filter)
        return HEWN_OK;
    hewn_volume_smooth_desc desc = *job->desc->filter;
    hewn_volume smooth;
    desc.frame = job->frame;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_volume_smooth(&job->volume, &desc, &smooth, error));
    hewn_volume_destroy(&job->volume);
    job->volume = smooth;
    job->frame = 0;
    job->report->filter = desc;
    hewn_stage_end(&job->stages, "filter");
    return HEWN_OK;
}

/* --- where the mesh shall be -------------------------------------------------------------------------------------- */

/* A volume of a patient without a unit is in millimetres; another one is in what the output is to be in. */
static hewn_result choose_place(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    const hewn_unit *unit = desc->unit ? desc->unit : job->volume.unit;
    report->space = hewn_frame_choose_space(report->to, desc->space, &job->volume);
    if (report->space == HEWN_SPACE_VOXEL)
        return hewn_volume_bring(&job->volume, report->space, 1, report->place, error);
    report->unit_assumed = !unit && (job->volume.anatomical || desc->to_unit || report->space == HEWN_SPACE_GLTF);
    if (!unit && job->volume.anatomical)
        unit = hewn_unit_find("mm");
    const hewn_unit *wanted = desc->to_unit;
    if (!wanted && report->space == HEWN_SPACE_GLTF)
        wanted = hewn_unit_find("m");
    if (!unit)
        unit = wanted;
    report->unit_before = unit;
    report->unit = wanted ? wanted : unit;
    double scale = 1;
    if (unit && report->unit != unit)
        scale = hewn_unit_metres(unit) / hewn_unit_metres(report->unit);
    return hewn_volume_bring(&job->volume, report->space, scale, report->place, error);
}

/* --- values ------------------------------------------------------------------------------------------------------- */

/* A number needs no look at the values; the surface tells whether it was a good one. */
static hewn_result choose_iso(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    report->iso_chosen = !desc->iso;
    report->iso = desc->iso               ? *desc->iso
                  : job->volume.level_set ? (hewn_iso){.kind = HEWN_ISO_NUMBER}
                                          : (hewn_iso){.kind = HEWN_ISO_OTSU, .threshold = 1, .classes = 2};
    report->iso_value = report->iso.number;
    if (report->iso.kind == HEWN_ISO_NUMBER)
        return HEWN_OK;
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_iso_find(&report->iso, &job->volume, job->frame, &report->iso_value, error));
    hewn_stage_end(&job->stages, "iso");
    return HEWN_OK;
}

static hewn_result measure(volume_job *job, hewn_error *error)
{
    hewn_volume_report *report = job->report;
    const hewn_volume *volume = &job->volume;
    if (report->measured)
        return HEWN_OK;
    hewn_stage_begin(&job->stages);
    report->range = hewn_volume_find_range(volume, job->frame);
    report->measured = true;
    if (report->range.finite_count > 0 && report->range.sample_lo < report->range.sample_hi) {
        hewn_volume_histogram histogram;
        HEWN_TRY(hewn_volume_find_histogram(volume, job->frame, report->range.sample_lo, report->range.sample_hi,
                                            HEWN_VOLUME_REPORT_BINS, &histogram, error));
        for (int i = 0; i < HEWN_VOLUME_REPORT_BINS; i++) /* of values: from the least */
            report->bins[volume->slope < 0 ? HEWN_VOLUME_REPORT_BINS - 1 - i : i] = histogram.bins[i];
        hewn_volume_histogram_destroy(&histogram);
    }
    hewn_stage_end(&job->stages, "measure");
    return HEWN_OK;
}

/* Why there is no surface, from what values there are. */
static hewn_result explain_nothing(volume_job *job, hewn_error *error)
{
    hewn_volume_report *report = job->report;
    double quarter[3];
    HEWN_TRY(measure(job, error));
    const hewn_volume_range *range = &report->range;
    if (range->finite_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "no value of the volume is finite, so it has no surface");
    if (range->lo == range->hi)
        return hewn_fail(error, HEWN_BAD_INPUT, "all values of the volume are %g, so there is no surface at %g",
                         range->lo, report->iso_value);
    for (int i = 0; i < 3; i++)
        HEWN_TRY(hewn_volume_find_percentile(&job->volume, job->frame, 25.0 * (i + 1), &quarter[i], error));
    return hewn_fail(
        error, HEWN_BAD_INPUT,
        "there is no surface at the iso value %.9g: the values are from %.9g to %.9g, a quarter of them up "
        "to %.9g, half up to %.9g, three quarters up to %.9g; --iso otsu finds a value between",
        report->iso_value, range->lo, range->hi, quarter[0], quarter[1], quarter[2]);
}

/* --- the mesh ----------------------------------------------------------------------------------------------------- */

static double determinant(const double m[16])
{
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

/* How many of the mesh's cubes a cube of the volume's world is. */
static double find_scale(const volume_job *job)
{
    return fabs(determinant(job->report->place) / hewn_volume_determinant(&job->volume));
}

static hewn_result extract(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    hewn_body_choice keep = desc->keep ? *desc->keep : (hewn_body_choice){0};
    keep.least_volume *= find_scale(job);
    hewn_volume_extract_desc wanted = {.frame = job->frame,
                                       .iso = report->iso_value,
                                       .method = desc->method,
                                       .inside = desc->inside,
                                       .open = desc->open,
                                       .no_normals = report->to == HEWN_MESH_STL || report->to == HEWN_MESH_3MF,
                                       .place = report->place,
                                       .keep = desc->keep ? &keep : NULL,
                                       .max_memory = desc->max_memory,
                                       .progress = desc->progress};
    hewn_stage_begin(&job->stages);
    hewn_result result;
    if (desc->max_memory > 0)
        result = hewn_mesh_parts_of_volume(&job->parts, &job->volume, &wanted, desc->output, &report->extraction,
                                           &report->certificate, error);
    else
        result = hewn_volume_extract(&job->volume, &wanted, &job->mesh, &report->extraction, error);
    report->max_memory = desc->max_memory;
    report->method = report->extraction.method;
    report->open = desc->open;
    if (result == HEWN_BAD_INPUT && report->extraction.active_cells == 0 && report->extraction.stage_count > 0)
        return explain_nothing(job, error);
    HEWN_TRY(result);
    hewn_stage_end(&job->stages, "extract");
    if (desc->max_memory > 0)
        job->mesh = job->parts.triangles;
    /* A head that touches the border has a cap too, but not mostly. */
    report->box_shaped = 2 * report->extraction.cap_vertices > job->mesh.vertex_count;
    return report->box_shaped || desc->report ? measure(job, error) : HEWN_OK;
}

/* Lengths come in the volume's unit; in voxels' space there is none. */
static hewn_result smooth(volume_job *job, double scale, hewn_error *error)
{
    hewn_volume_report *report = job->report;
    hewn_smooth_desc desc = *job->desc->smooth;
    desc.step *= scale;
    desc.radius *= scale;
    desc.labels = NULL;
    desc.freedom = NULL;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_triangles_smooth(&job->mesh, &desc, &report->smooth, error));
    report->smoothed = true;
    report->smooth_method = desc.method;
    hewn_stage_end(&job->stages, "smooth");
    return HEWN_OK;
}

static hewn_result simplify(volume_job *job, double scale, hewn_error *error)
{
    hewn_volume_report *report = job->report;
    hewn_simplify_desc desc = *job->desc->simplify;
    desc.error *= scale;
    desc.labels = NULL;
    desc.frozen = NULL;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_triangles_simplify(&job->mesh, &desc, &report->simplify, error));
    report->simplified = true;
    hewn_stage_end(&job->stages, "simplify");
    return HEWN_OK;
}

/* What changes the mesh itself. The samples are not looked at any more. */
static hewn_result refine(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    double scale = report->space == HEWN_SPACE_VOXEL ? 1 : cbrt(find_scale(job));
    hewn_volume_destroy(&job->volume);
    if (desc->smooth)
        HEWN_TRY(smooth(job, scale, error));
    if (desc->simplify)
        HEWN_TRY(simplify(job, scale, error));
    if (desc->smooth || desc->simplify)
        HEWN_TRY(hewn_triangles_make_distinct(&job->mesh, NULL, error));
    report->vertices = job->mesh.vertex_count;
    report->faces = job->mesh.triangle_count;
    return HEWN_OK;
}

static hewn_result certify(volume_job *job, hewn_error *error)
{
    hewn_certificate *certificate = &job->report->certificate;
    if (job->desc->max_memory == 0) { /* else it was certified as it came */
        hewn_stage_begin(&job->stages);
        HEWN_TRY(hewn_certify(&job->mesh, job->desc->progress, certificate, error));
        hewn_stage_end(&job->stages, "certify");
    }
    certificate->max_residual = 0.0 / 0.0; /* samples are all that is known of the field */
    if (certificate->manifold && certificate->oriented && (certificate->closed || job->desc->open))
        return HEWN_OK;
    return hewn_fail(error, HEWN_INTERNAL,
                     "the mesh is not what it must be (%llu open edges); nothing was written, and "
                     "this is a fault of Hewn, please report it",
                     (unsigned long long)certificate->boundary_edges);
}

static hewn_result write(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    bool patient = report->space == HEWN_SPACE_RAS || report->space == HEWN_SPACE_LPS;
    bool known = patient || report->space == HEWN_SPACE_GLTF;
    char name[256];
    hewn_stage_begin(&job->stages);
    hewn_path_stem(strcmp(desc->output, "-") == 0 ? desc->input : desc->output, name, sizeof name);
    hewn_write_desc write_desc = {.format = report->to,
                                  .name = name,
                                  .unit = report->unit,
                                  .up = patient ? HEWN_AXIS_PLUS_Z : HEWN_AXIS_PLUS_Y,
                                  .unsure = !known,
                                  .space = hewn_frame_space_tag(report->space, report->anatomical),
                                  .progress = desc->progress};
    if (desc->max_memory > 0)
        write_desc.progress = hewn_mesh_parts_progress(&job->parts, desc->progress);
    HEWN_TRY(hewn_triangles_write(&job->mesh, desc->output, &write_desc, error));
    hewn_stage_end(&job->stages, "write");
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result blame(const volume_job *job, hewn_result result, hewn_error *error)
{
    bool theirs = result == HEWN_OK || result == HEWN_INVALID_ARGUMENT || result == HEWN_CANCELLED;
    return theirs ? result : hewn_blame_input(result, job->desc->input, error);
}

static hewn_result mesh(volume_job *job, hewn_error *error)
{
    HEWN_TRY(load(job, error));
    HEWN_TRY(choose_place(job, error));
    HEWN_TRY(filter(job, error));
    HEWN_TRY(choose_iso(job, error));
    HEWN_TRY(extract(job, error));
    return refine(job, error);
}

static hewn_result run(volume_job *job, hewn_error *error)
{
    const hewn_volume_job_desc *desc = job->desc;
    hewn_volume_report *report = job->report;
    HEWN_TRY(check(job, error));
    if (desc->threads > 0)
        omp_set_num_threads((int)desc->threads);
    report->input = hewn_strdup(desc->input);
    report->output = hewn_strdup(desc->output);
    if (!report->input || !report->output)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    HEWN_TRY(blame(job, mesh(job, error), error));
    HEWN_TRY(certify(job, error));
    return write(job, error);
}

hewn_result hewn_volume_convert(const hewn_volume_job_desc *desc, hewn_volume_report *out, hewn_error *error)
{
    *out = (hewn_volume_report){0};
    volume_job job = {.desc = desc,
                      .report = out,
                      .stages = hewn_stages_start(desc->began, out->stages, sizeof out->stages / sizeof *out->stages,
                                                  &out->stage_count)};
    hewn_result result = run(&job, error);
    if (desc->max_memory > 0)
        job.mesh = (hewn_triangles){0};
    hewn_triangles_destroy(&job.mesh);
    hewn_mesh_parts_clear(&job.parts);
    hewn_volume_destroy(&job.volume);
    out->seconds = hewn_stages_seconds(&job.stages);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_volume_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_volume_report_destroy(out);
    return result;
}

void hewn_volume_report_destroy(hewn_volume_report *report)
{
    hewn_free(report->input);
    hewn_free(report->output);
    hewn_free(report->remark);
    *report = (hewn_volume_report){0};
}
