#include "pipeline/label_job.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/frame.h"
#include "pipeline/label_paths.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/stages.h"

/* A job under way. */
typedef struct label_job {
    const hewn_label_job_desc *desc;
    hewn_label_report *report;
    hewn_stages stages;
    hewn_label_target target;
    hewn_frame wanted; /* to write in */
    hewn_label_table names;
    hewn_volume volume;
    hewn_body_choice keep; /* in the unit of the mesh */
    hewn_label_mesh mesh;
    hewn_model frame;   /* unit and axes of the mesh, without anything else */
    hewn_model *shells; /* of each label, where they go together into a GLB */
    bool folder_made;
    uint32_t written; /* files of labels */
} label_job;

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the meshes of labels");
}

/* --- before any work -----------------------------------------------------------------------------------------------
 */

static hewn_result check(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_report *report = job->report;
    HEWN_TRY(hewn_label_target_find(desc, &job->target, &report->to, error));
    HEWN_TRY(hewn_frame_check_space(report->to, desc->space, desc->to_unit, error));
    HEWN_TRY(
        hewn_frame_choose(job->report->to, (hewn_frame){job->desc->to_unit, job->desc->to_up}, &job->wanted, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    if (job->target != HEWN_LABELS_FOLDER)
        HEWN_TRY(hewn_output_check(desc->output, error));
    if (desc->report)
        HEWN_TRY(hewn_output_check(desc->report, error));
    report->input = hewn_strdup(desc->input);
    report->output = hewn_strdup(desc->output);
    if (!report->input || !report->output)
        return fail_memory(error);
    if (!desc->names)
        return HEWN_OK;
    return hewn_blame_input(hewn_label_table_read(desc->names, &job->names, error), desc->names, error);
}

/* --- the stages ----------------------------------------------------------------------------------------------------
 */

static hewn_result load(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_report *report = job->report;
    hewn_volume_read_desc read = desc->read;
    read.progress = desc->progress;
    hewn_stage_begin(&job->stages);
    report->from = read.format != HEWN_VOLUME_UNKNOWN ? read.format : hewn_volume_format_of_file(desc->input);
    hewn_result result = hewn_volume_read(desc->input, &read, &job->volume, error);
    if (result != HEWN_OK)
        return result == HEWN_INVALID_ARGUMENT ? result : hewn_blame_input(result, desc->input, error);
    memcpy(report->dims, job->volume.dims, sizeof report->dims);
    report->anatomical = job->volume.anatomical;
    hewn_stage_end(&job->stages, "load");
    return HEWN_OK;
}

/* Labels are meshed where they shall be: what is wanted takes the place of the volume's world. */
static hewn_result place(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_report *report = job->report;
    hewn_volume *volume = &job->volume;
    double to[16];
    report->space = hewn_frame_choose_space(report->to, desc->space, volume);
    const bool patient = report->space == HEWN_SPACE_RAS || report->space == HEWN_SPACE_LPS;
    const bool voxels = report->space == HEWN_SPACE_VOXEL, gltf = report->space == HEWN_SPACE_GLTF;
    const double size = fabs(hewn_volume_determinant(volume));
    hewn_result result = hewn_volume_bring(volume, report->space, 1, to, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    if (desc->keep)
        job->keep = *desc->keep;
    if (voxels)
        job->keep.least_volume /= size;
    memcpy(volume->to_world, to, sizeof to);
    const hewn_unit *unit = desc->unit ? desc->unit : volume->unit;
    report->unit_assumed = !unit && volume->anatomical && !voxels;
    job->frame.unit = voxels ? NULL : report->unit_assumed ? hewn_unit_find("mm") : unit;
    job->frame.up = gltf ? HEWN_AXIS_PLUS_Y : HEWN_AXIS_PLUS_Z;
    job->frame.up_known = volume->anatomical && (patient || gltf);
    if (gltf && !job->wanted.unit)
        job->wanted.unit = hewn_unit_find("m");
    return HEWN_OK;
}

static hewn_result mesh(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_desc label = {.frame = desc->frame,
                             .labels = desc->labels,
                             .label_count = desc->label_count,
                             .relaxations = desc->relaxations,
                             .keep = desc->keep ? &job->keep : NULL,
                             .progress = desc->progress};
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_labels_mesh(&job->volume, &label, &job->mesh, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    job->report->relaxations = desc->relaxations;
    job->report->islands = job->mesh.islands;
    hewn_volume_destroy(&job->volume); /* its samples are not looked at any more */
    hewn_stage_end(&job->stages, "label");
    return HEWN_OK;
}

static hewn_result smooth(label_job *job, hewn_error *error)
{
    if (!job->desc->smooth)
        return HEWN_OK;
    hewn_smooth_desc desc = job->desc->smooth->desc;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_label_mesh_smooth(&job->mesh, &desc, &job->report->smooth, error));
    job->report->smoothed = true;
    job->report->smooth_method = desc.method;
    hewn_stage_end(&job->stages, "smooth");
    return HEWN_OK;
}

static hewn_result simplify(label_job *job, hewn_error *error)
{
    if (!job->desc->simplify)
        return HEWN_OK;
    hewn_simplify_desc desc = *job->desc->simplify;
    desc.labels = NULL;
    desc.frozen = NULL;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_label_mesh_simplify(&job->mesh, &desc, &job->report->simplify, error));
    job->report->simplified = true;
    hewn_stage_end(&job->stages, "simplify");
    return HEWN_OK;
}

/* All positions at once, so that shells go on sharing them. */
static hewn_result convert(label_job *job, hewn_error *error)
{
    hewn_label_report *report = job->report;
    hewn_model all = job->frame;
    all.positions = job->mesh.positions;
    all.vertex_count = job->mesh.vertex_count;
    HEWN_TRY(hewn_model_convert(&all, hewn_frame_unit(report->to, job->wanted, &all), job->wanted.up,
                                &report->conversion, error));
    job->frame.unit = all.unit;
    job->frame.up = all.up;
    job->frame.up_known = all.up_known;
    report->up_known = all.up_known;
    return HEWN_OK;
}

/* A colour for labels that have none: hues as far apart as the golden section puts them. */
static void make_color(int64_t label, uint8_t out[4])
{
    double turn = (double)(label % 100000) * 0.6180339887498949, hue = 6 * (turn - (double)(int64_t)turn);
    hue = hue < 0 ? hue + 6 : hue;
    for (int k = 0; k < 3; k++) {
        double at = hue + 2.0 * (3 - k);
        at = at - 6 * (double)(int)(at / 6);
        double share = at < 1 ? at : at < 3 ? 1 : at < 4 ? 4 - at : 0;
        out[k] = (uint8_t)(95 + 140 * share);
    }
    out[3] = 255;
}

static hewn_result name_labels(label_job *job, hewn_error *error)
{
    hewn_label_report *report = job->report;
    const hewn_label_mesh *mesh = &job->mesh;
    report->labels = hewn_alloc_zero(mesh->label_count, sizeof *report->labels);
    if (!report->labels)
        return fail_memory(error);
    report->label_count = mesh->label_count;
    for (uint32_t n = 0; n < mesh->label_count; n++) {
        hewn_label_fact *fact = &report->labels[n];
        const hewn_label_name *known = hewn_label_table_find(&job->names, mesh->labels[n]);
        char made[40];
        snprintf(made, sizeof made, "label_%" PRId64, mesh->labels[n]);
        fact->label = mesh->labels[n];
        fact->voxels = mesh->voxel_count[n];
        fact->name = hewn_strdup(known ? known->name : made);
        if (!fact->name)
            return fail_memory(error);
        report->unnamed_count += job->names.count > 0 && !known;
        if (known && known->has_color)
            memcpy(fact->color, known->color, sizeof fact->color);
        else
            make_color(fact->label, fact->color);
    }
    return hewn_label_paths_find(job->desc, job->target, report->to, report->labels, report->label_count, error);
}

static hewn_result find_missing(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_report *report = job->report;
    report->missing = hewn_alloc(desc->label_count, sizeof *report->missing);
    if (!report->missing)
        return fail_memory(error);
    for (size_t i = 0; desc->labels && i < desc->label_count; i++)
        if (hewn_label_mesh_find(&job->mesh, desc->labels[i]) == 0)
            report->missing[report->missing_count++] = desc->labels[i];
    return HEWN_OK;
}

static hewn_result make_shell(const label_job *job, uint32_t n, hewn_model *out, hewn_error *error)
{
    HEWN_TRY(hewn_label_mesh_shell(&job->mesh, n + 1, out, error));
    out->unit = job->frame.unit;
    out->up = job->frame.up;
    out->up_known = job->frame.up_known;
    return HEWN_OK;
}

static bool is_small(const label_job *job, uint32_t n)
{
    enum { MOST = 1 << 18 };
    return job->mesh.first[n + 2] - job->mesh.first[n + 1] < MOST;
}

/* Proves a shell, as floats. */
static hewn_result prove(label_job *job, uint32_t n, hewn_error *error)
{
    hewn_label_fact *fact = &job->report->labels[n];
    hewn_triangles triangles = {0};
    hewn_model shell;
    HEWN_TRY(make_shell(job, n, &shell, error));
    fact->vertices = shell.vertex_count;
    fact->faces = shell.face_count;
    hewn_result result = hewn_triangles_from_model(&shell, &triangles, error);
    hewn_model_destroy(&shell);
    if (result == HEWN_OK)
        result = hewn_certify(&triangles, NULL, &fact->certificate, error);
    hewn_triangles_destroy(&triangles);
    HEWN_TRY(result);
    const hewn_certificate *is = &fact->certificate;
    if (is->closed && is->manifold && is->oriented)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INTERNAL, "the shell of label %" PRId64 " is not closed, manifold and oriented",
                     fact->label);
}

/* Threads that share a small shell would wait for each other more than they work, so each takes shells of its own. Of
 * several failures the one of the first label is told. */
static hewn_result prove_small(label_job *job, uint32_t from, uint32_t to, hewn_error *error)
{
    hewn_result result = HEWN_OK;
    hewn_error first = {0};
    uint32_t failed = UINT32_MAX;
#pragma omp parallel for schedule(dynamic, 1)
    for (uint32_t n = from; n < to; n++) {
        hewn_error own = {0};
        hewn_result is = is_small(job, n) ? prove(job, n, &own) : HEWN_OK;
#pragma omp critical(hewn_label_prove)
        if (is != HEWN_OK && n < failed) {
            failed = n;
            result = is;
            first = own;
        }
    }
    if (result != HEWN_OK && error)
        *error = first;
    return result;
}

static hewn_result prove_all(label_job *job, hewn_error *error)
{
    enum { BATCH = 64 }; /* after which it is told how far this is */
    uint32_t count = job->report->label_count;
    hewn_stage_begin(&job->stages);
    for (uint32_t from = 0; from < count; from += BATCH) {
        uint32_t to = count - from < BATCH ? count : from + BATCH;
        for (uint32_t n = from; n < to; n++)
            if (!is_small(job, n))
                HEWN_TRY(prove(job, n, error));
        HEWN_TRY(prove_small(job, from, to, error));
        HEWN_TRY(hewn_progress_report(job->desc->progress, "certify", (double)to / count, error));
    }
    hewn_stage_end(&job->stages, "certify");
    return HEWN_OK;
}

/* --- writing -------------------------------------------------------------------------------------------------------
 */

/* None where the axes were turned once more. */
static const char *tag(const label_job *job)
{
    const hewn_label_report *report = job->report;
    const hewn_axis up = report->space == HEWN_SPACE_GLTF ? HEWN_AXIS_PLUS_Y : HEWN_AXIS_PLUS_Z;
    return report->up_known && job->frame.up != up ? NULL : hewn_frame_space_tag(report->space, report->anatomical);
}

static hewn_result write_each(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_report *report = job->report;
    HEWN_TRY(hewn_label_folder_make(desc, job->target, &job->folder_made, error));
    for (uint32_t n = 0; n < report->label_count; n++) {
        const hewn_label_fact *fact = &report->labels[n];
        hewn_model shell;
        HEWN_TRY(make_shell(job, n, &shell, error));
        hewn_result result;
        if (report->to == HEWN_MESH_GLB) {
            hewn_object object = {.model = &shell, .name = fact->name};
            memcpy(object.color, fact->color, sizeof object.color);
            result = hewn_objects_write_glb(&object, 1, &fact->label, tag(job), fact->path, NULL, error);
        } else {
            hewn_write_desc write = {.format = report->to, .name = fact->name, .space = tag(job)};
            result = hewn_model_write(&shell, fact->path, &write, error);
        }
        hewn_model_destroy(&shell);
        HEWN_TRY(result);
        job->written = n + 1;
        HEWN_TRY(hewn_progress_report(desc->progress, "write", (n + 1.0) / report->label_count, error));
    }
    return HEWN_OK;
}

static hewn_result write_glb(label_job *job, hewn_error *error)
{
    hewn_label_report *report = job->report;
    hewn_object *objects = hewn_alloc_zero(report->label_count, sizeof *objects);
    job->shells = hewn_alloc_zero(report->label_count, sizeof *job->shells);
    hewn_result result = objects && job->shells ? HEWN_OK : fail_memory(error);
    for (uint32_t n = 0; n < report->label_count && result == HEWN_OK; n++) {
        result = make_shell(job, n, &job->shells[n], error);
        objects[n] = (hewn_object){.model = &job->shells[n], .name = report->labels[n].name};
        memcpy(objects[n].color, report->labels[n].color, sizeof objects[n].color);
    }
    if (result == HEWN_OK)
        result = hewn_objects_write_glb(objects, report->label_count, job->mesh.labels, tag(job), job->desc->output,
                                        job->desc->progress, error);
    for (uint32_t n = 0; job->shells && n < report->label_count; n++)
        hewn_model_destroy(&job->shells[n]);
    hewn_free(job->shells);
    job->shells = NULL;
    hewn_free(objects);
    return result;
}

/* All shells in one mesh, or the mesh that they share. */
static hewn_result write_together(label_job *job, hewn_error *error)
{
    const hewn_label_job_desc *desc = job->desc;
    hewn_label_report *report = job->report;
    hewn_model model;
    char name[256];
    if (desc->complex) {
        HEWN_TRY(hewn_label_mesh_model(&job->mesh, 0, &model, error));
    } else {
        const char **names = hewn_alloc(report->label_count, sizeof *names);
        if (!names)
            return fail_memory(error);
        for (uint32_t n = 0; n < report->label_count; n++)
            names[n] = report->labels[n].name;
        hewn_result made = hewn_label_mesh_shells(&job->mesh, names, &model, error);
        hewn_free(names);
        HEWN_TRY(made);
    }
    model.unit = job->frame.unit;
    model.up = job->frame.up;
    model.up_known = job->frame.up_known;
    hewn_path_stem(strcmp(desc->output, "-") == 0 ? desc->input : desc->output, name, sizeof name);
    hewn_write_desc write = {.format = report->to, .name = name, .space = tag(job), .progress = desc->progress};
    hewn_result result = hewn_model_write(&model, desc->output, &write, error);
    hewn_model_destroy(&model);
    return result;
}

/* STL joins what has one position, and OFF and 3MF keep no names: shells that touch could not be told apart. */
static hewn_result check_together(const label_job *job, hewn_error *error)
{
    hewn_mesh_format to = job->report->to;
    bool keeps = to == HEWN_MESH_GLB || to == HEWN_MESH_OBJ || to == HEWN_MESH_PLY;
    if (job->target != HEWN_LABELS_TOGETHER || keeps || job->mesh.label_count == 1)
        return HEWN_OK;
    return hewn_fail(
        error, HEWN_INVALID_ARGUMENT,
        "%u labels cannot be told apart in one %s file; name a folder (-o DIR/), a pattern with {label} or "
        "{name}, or a .glb, .obj or .ply file",
        job->mesh.label_count, hewn_mesh_format_name(to));
}

static hewn_result write_meshes(label_job *job, hewn_error *error)
{
    hewn_stage_begin(&job->stages);
    if (job->target != HEWN_LABELS_TOGETHER)
        HEWN_TRY(write_each(job, error));
    else if (job->report->to == HEWN_MESH_GLB)
        HEWN_TRY(write_glb(job, error));
    else
        HEWN_TRY(write_together(job, error));
    hewn_stage_end(&job->stages, "write");
    return HEWN_OK;
}

/* --- the whole -----------------------------------------------------------------------------------------------------
 */

static hewn_result run(label_job *job, hewn_error *error)
{
    HEWN_TRY(check(job, error));
    HEWN_TRY(load(job, error));
    HEWN_TRY(place(job, error));
    HEWN_TRY(mesh(job, error));
    HEWN_TRY(check_together(job, error));
    HEWN_TRY(name_labels(job, error));
    HEWN_TRY(find_missing(job, error));
    HEWN_TRY(smooth(job, error));
    HEWN_TRY(simplify(job, error));
    job->report->vertices = job->mesh.vertex_count;
    job->report->faces = job->mesh.triangle_count;
    HEWN_TRY(convert(job, error));
    HEWN_TRY(prove_all(job, error));
    return write_meshes(job, error);
}

/* Takes back files of labels that were written before one could not be. */
static void unwrite(const label_job *job)
{
    for (uint32_t n = 0; n < job->written; n++)
        unlink(job->report->labels[n].path);
    if (job->folder_made)
        rmdir(job->desc->output);
}

hewn_result hewn_labels_convert(const hewn_label_job_desc *desc, hewn_label_report *out, hewn_error *error)
{
    *out = (hewn_label_report){0};
    label_job job = {.desc = desc,
                     .report = out,
                     .stages = hewn_stages_start(desc->began, out->stages, sizeof out->stages / sizeof *out->stages,
                                                 &out->stage_count)};
    hewn_result result = run(&job, error);
    if (result != HEWN_OK)
        unwrite(&job);
    hewn_label_table_destroy(&job.names);
    hewn_volume_destroy(&job.volume);
    hewn_label_mesh_destroy(&job.mesh);
    out->seconds = hewn_stages_seconds(&job.stages);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_label_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_label_report_destroy(out);
    return result;
}
