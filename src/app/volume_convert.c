#include "app/volume_convert.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/file_arguments.h"
#include "app/number.h"
#include "app/path_arguments.h"
#include "app/simplify_arguments.h"
#include "app/smooth_arguments.h"
#include "app/volume_arguments.h"
#include "base/error.h"

static const char *const names[] = {"method",  "inside",     "space",         "open",    "smooth-volume",
                                    "largest", "min-volume", "fill-cavities", "threads", "max-memory"};

bool hewn_volume_convert_any(const hewn_arguments *arguments)
{
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (hewn_arguments_has(arguments, names[i]))
            return true;
    return hewn_volume_arguments_any(arguments);
}

/* The command line as a job. */
typedef struct request {
    hewn_volume_job_desc desc;
    hewn_volume_arguments volume;
    hewn_volume_smooth_desc filter;
    hewn_body_choice keep;
    hewn_file_smooth smooth;
    hewn_simplify_desc simplify;
    bool quiet;
} request;

/* --- arguments ---------------------------------------------------------------------------------------------------- */

static hewn_result read_unit(const hewn_arguments *arguments, const char *name, const hewn_unit **out,
                             hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, name);
    *out = text ? hewn_unit_find(text) : NULL;
    if (!text || *out)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s is one of %s, not '%s'", name, hewn_unit_names(), text);
}

static hewn_result read_place(const hewn_arguments *arguments, hewn_volume_job_desc *desc, hewn_error *error)
{
    static const char *const others[] = {"up", "to-up"};
    const char *space = hewn_arguments_value(arguments, "space");
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (hewn_arguments_has(arguments, others[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "--%s is for meshes; where a volume's mesh is to be, --space says", others[i]);
    if (space && !hewn_space_find(space, &desc->space))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--space is ras, lps, gltf, world or voxel, not '%s'", space);
    HEWN_TRY(read_unit(arguments, "unit", &desc->unit, error));
    return read_unit(arguments, "to-unit", &desc->to_unit, error);
}

/* LENGTH, gaussian:LENGTH or median:LENGTH. */
static hewn_result read_filter(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, "smooth-volume");
    if (!text)
        return HEWN_OK;
    bool median = strncmp(text, "median:", 7) == 0, gaussian = strncmp(text, "gaussian:", 9) == 0;
    const char *length = text + (median ? 7 : gaussian ? 9 : 0);
    if (!median && !gaussian && strchr(text, ':'))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--smooth-volume takes a length, gaussian:LENGTH or median:LENGTH, not '%s'", text);
    out->filter.filter = median ? HEWN_VOLUME_MEDIAN : HEWN_VOLUME_GAUSSIAN;
    HEWN_TRY(hewn_number_parse(length, "--smooth-volume", &out->filter.length, error));
    if (!(out->filter.length > 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--smooth-volume must be greater than 0, not %s", length);
    out->desc.filter = &out->filter;
    return HEWN_OK;
}

static hewn_result read_bodies(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    HEWN_TRY(hewn_body_arguments_read(arguments, &out->keep, error));
    bool any = out->keep.largest > 0 || out->keep.least_volume > 0 || out->keep.fill_cavities;
    if (any && out->desc.open)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--largest, --min-volume and --fill-cavities do not go with --open: where surfaces are open, "
                         "they enclose no bodies");
    out->desc.keep = any ? &out->keep : NULL;
    return HEWN_OK;
}

static hewn_result read_steps(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    const char *smooth = hewn_arguments_value(arguments, "smooth");
    bool simplify;
    HEWN_TRY(read_filter(arguments, out, error));
    HEWN_TRY(read_bodies(arguments, out, error));
    if (smooth) {
        HEWN_TRY(hewn_smooth_spec_parse(smooth, "--smooth", &out->smooth, error));
        out->desc.smooth = &out->smooth.desc;
    }
    if (out->smooth.lock_labels)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--smooth lock=labels is for meshes; the surface of a volume "
                         "has no labels");
    HEWN_TRY(hewn_simplify_target_read(arguments, &out->simplify, &simplify, error));
    out->simplify.measure = out->desc.report != NULL;
    out->desc.simplify = simplify ? &out->simplify : NULL;
    return HEWN_OK;
}

static hewn_result read_surface(const hewn_arguments *arguments, hewn_volume_job_desc *desc, hewn_error *error)
{
    const char *method = hewn_arguments_value(arguments, "method"), *inside = hewn_arguments_value(arguments, "inside");
    const char *threads = hewn_arguments_value(arguments, "threads");
    const char *memory = hewn_arguments_value(arguments, "max-memory");
    if (method && !hewn_method_named(method, &desc->method))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--method of a volume is mc33, mc, nets or dc, not '%s'",
                         method);
    if (inside && strcmp(inside, "above") != 0 && strcmp(inside, "below") != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--inside is above or below, not '%s'", inside);
    if (inside)
        desc->inside = inside[0] == 'a' ? HEWN_INSIDE_ABOVE : HEWN_INSIDE_BELOW;
    desc->open = hewn_arguments_has(arguments, "open");
    if (memory)
        HEWN_TRY(hewn_bytes_parse(memory, "--max-memory", &desc->max_memory, error));
    if (threads)
        HEWN_TRY(hewn_count_parse(threads, "--threads", 1, &desc->threads, error));
    if (desc->threads > 4096)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--threads is at most 4096, not %s", threads);
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, hewn_volume_format format, request *out,
                                hewn_error *error)
{
    hewn_volume_job_desc *desc = &out->desc;
    HEWN_TRY(hewn_input_argument_read(arguments, &desc->input, error));
    HEWN_TRY(hewn_volume_arguments_read(arguments, &out->volume, error));
    desc->read = out->volume.read;
    desc->read.format = format;
    desc->frame = out->volume.frame;
    desc->iso = out->volume.has_iso ? &out->volume.iso : NULL;
    HEWN_TRY(read_place(arguments, desc, error));
    HEWN_TRY(read_surface(arguments, desc, error));
    HEWN_TRY(hewn_mesh_output_read(arguments, &desc->output, &desc->report, &desc->format, error));
    HEWN_TRY(read_steps(arguments, out, error));
    out->quiet = hewn_arguments_has(arguments, "quiet");
    return HEWN_OK;
}

/* --- what people see ---------------------------------------------------------------------------------------------- */

static const char *plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

static const char *shown(const char *path, const char *standard)
{
    return strcmp(path, "-") == 0 ? standard : path;
}

static void print_mesh(const hewn_volume_report *report)
{
    const hewn_certificate *certificate = &report->certificate;
    const char *unit = report->unit ? report->unit->name : "";
    const char *space = report->unit ? " " : "";
    fprintf(stderr,
            "%s -> %s: %" PRIu64 " vertices, %" PRIu64 " faces; %s, manifold, oriented; %" PRIu64 " component%s",
            shown(report->input, "standard input"), shown(report->output, "standard output"), report->vertices,
            report->faces, certificate->closed ? "closed" : "open", certificate->components,
            plural(certificate->components));
    if (certificate->genus >= 0)
        fprintf(stderr, ", genus %" PRId64, certificate->genus);
    fputs("\n  ", stderr);
    if (certificate->closed)
        fprintf(stderr, "volume %.6g%s%s%s, ", certificate->volume, space, unit, report->unit ? "³" : "");
    fprintf(stderr, "area %.6g%s%s%s", certificate->area, space, unit, report->unit ? "²" : "");
    fprintf(stderr, "; iso value %.9g%s, inside where values are %s; %s, %.2f s\n", report->iso_value,
            report->iso.kind == HEWN_ISO_OTSU ? " (Otsu's threshold)" : "",
            report->extraction.below ? "below" : "at least that", hewn_method_name(report->method), report->seconds);
}

static void print_place(const hewn_volume_report *report)
{
    fprintf(stderr, "  %u x %u x %u voxels (%s); space %s, ", report->dims[0], report->dims[1], report->dims[2],
            hewn_voxel_name(report->type), hewn_space_name(report->space));
    if (report->space == HEWN_SPACE_VOXEL)
        fputs("lengths in voxels", stderr);
    else if (!report->unit)
        fputs("unit unknown", stderr);
    else if (report->unit_before == report->unit)
        fprintf(stderr, "unit %s", report->unit->name);
    else
        fprintf(stderr, "unit %s -> %s", report->unit_before->name, report->unit->name);
    fprintf(stderr, "%s%s\n",
            report->unit_assumed && report->unit ? " (assumed: the volume does not say its unit)" : "",
            report->left_handed ? "; left-handed voxels, faces turned" : "");
}

static void print_steps(const hewn_volume_report *report)
{
    const hewn_body_counts *bodies = &report->extraction.bodies;
    if (report->filter.length > 0)
        fprintf(stderr, "  values smoothed by %s of %g%s%s\n",
                report->filter.filter == HEWN_VOLUME_MEDIAN ? "the median in a radius" : "a Gaussian",
                report->filter.length, report->unit_before ? " " : "",
                report->unit_before ? report->unit_before->name : "");
    if (bodies->bodies > 0)
        fprintf(stderr, "  %" PRIu64 " of %" PRIu64 " bod%s and %" PRIu64 " of %" PRIu64 " cavit%s kept\n",
                bodies->kept_bodies, bodies->bodies, bodies->bodies == 1 ? "y" : "ies", bodies->kept_cavities,
                bodies->cavities, bodies->cavities == 1 ? "y" : "ies");
    if (report->smoothed)
        hewn_smooth_print(&report->smooth, report->smooth_method);
    if (report->simplified)
        hewn_simplify_print(&report->simplify);
}

static void print_notes(const hewn_volume_report *report)
{
    if (report->remark)
        fprintf(stderr, "hewn: note: %s\n", report->remark);
    bool thin = report->dims[0] == 1 || report->dims[1] == 1 || report->dims[2] == 1;
    if (report->box_shaped && thin)
        fputs("hewn: note: the volume is one slice, so its surface is a sheet that is closed around it\n", stderr);
    else if (report->box_shaped)
        fprintf(stderr,
                "hewn: warning: most of the mesh is the cap at the volume's border, so it is hardly more than a box: "
                "values are from %.9g to %.9g, and most of those at the border are inside at %.9g; %s or "
                "--inside may say better what is wanted\n",
                report->range.lo, report->range.hi, report->iso_value,
                report->iso.kind == HEWN_ISO_NUMBER ? "--iso otsu" : "another --iso");
    else if (report->extraction.cap_vertices > 0)
        fputs("hewn: note: the surface reaches the volume's border and was closed there with a flat cap; --open leaves "
              "it open\n",
              stderr);
    if (report->range.nan_count > 0)
        fprintf(stderr, "hewn: note: %" PRIu64 " value%s not a number and count%s as outside\n",
                report->range.nan_count, report->range.nan_count == 1 ? " is" : "s are",
                report->range.nan_count == 1 ? "s" : "");
}

/* --- running ------------------------------------------------------------------------------------------------------ */

int hewn_volume_convert_run(const hewn_command *command, const hewn_arguments *arguments, hewn_volume_format format)
{
    hewn_error error = {0};
    request wanted = {0};
    hewn_result result = read_request(arguments, format, &wanted, &error);
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(wanted.quiet);
    hewn_volume_report report;
    wanted.desc.progress = &progress;
    wanted.desc.began = hewn_started();
    result = hewn_volume_convert(&wanted.desc, &report, &error);
    hewn_progress_end();
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    if (!wanted.quiet) {
        print_mesh(&report);
        print_place(&report);
        print_steps(&report);
        print_notes(&report);
    }
    hewn_volume_report_destroy(&report);
    return 0;
}
