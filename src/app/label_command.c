#include "app/label_command.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/file_arguments.h"
#include "app/number.h"
#include "app/simplify_arguments.h"
#include "app/smooth_arguments.h"
#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/label_job.h"

enum { DEFAULT_RELAXATIONS = 16, MOST_LISTED = 65536 };

/* A job as the arguments say. `file` has paths and frames, which are read as they are for meshes. */
typedef struct request {
    hewn_label_job_desc desc;
    hewn_file_arguments file;
    hewn_file_smooth smooth;
    hewn_body_choice keep;
    hewn_simplify_desc simplify;
    int64_t *labels;
    size_t label_count, room;
} request;

bool hewn_label_arguments_any(const hewn_arguments *arguments)
{
    static const char *const names[] = {"labels", "names", "smooth-labels", "complex"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (hewn_arguments_has(arguments, names[i]))
            return true;
    return false;
}

/* --- reading the arguments ------------------------------------------------------------------------------------------
 */

/* A whole number at `*at`, which goes behind it. */
static bool read_label(const char **at, int64_t *out)
{
    char *end;
    const char *digit = **at == '-' ? *at + 1 : *at;
    if (*digit < '0' || *digit > '9')
        return false;
    errno = 0;
    *out = strtoll(*at, &end, 10);
    *at = end;
    return errno == 0;
}

static hewn_result add_labels(request *to, int64_t first, int64_t last, hewn_error *error)
{
    if (first > last || (uint64_t)last - (uint64_t)first >= MOST_LISTED)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--labels: from %" PRId64 " to %" PRId64 " are no labels, or more than %d", first, last,
                         MOST_LISTED);
    for (int64_t label = first;; label++) {
        void *items = to->labels;
        HEWN_TRY(hewn_reserve(&items, &to->room, to->label_count + 1, sizeof *to->labels, error));
        to->labels = items;
        to->labels[to->label_count++] = label;
        if (label == last)
            return HEWN_OK;
    }
}

/* "all", or numbers and ranges with commas between. */
static hewn_result read_labels(const char *text, request *out, hewn_error *error)
{
    if (strcmp(text, "all") == 0)
        return HEWN_OK;
    for (const char *at = text;;) {
        int64_t first, last;
        bool right = read_label(&at, &first);
        last = first;
        if (right && *at == '-') {
            at++;
            right = read_label(&at, &last);
        }
        if (!right || (*at != ',' && *at != '\0'))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "--labels takes `all`, or numbers as 1,2,5 or 10-19, not '%s'", text);
        HEWN_TRY(add_labels(out, first, last, error));
        if (*at++ == '\0')
            break;
    }
    out->desc.labels = out->labels;
    out->desc.label_count = out->label_count;
    return HEWN_OK;
}

static hewn_result read_volume(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    hewn_volume_arguments volume;
    const char *from = hewn_arguments_value(arguments, "from");
    HEWN_TRY(hewn_volume_arguments_read(arguments, &volume, error));
    if (volume.has_iso)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--iso makes one surface of values; it does not go with --labels");
    if (hewn_arguments_has(arguments, "max-memory"))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "meshes of labels are made at once; --max-memory does not go "
                         "with --labels");
    out->desc.read = volume.read;
    out->desc.frame = volume.frame;
    if (from && !hewn_volume_format_find(from, &out->desc.read.format))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--from is, of volumes, nifti, nrrd, metaimage, raw, npy, inr, tiff, vdb or dicom, not '%s'",
                         from);
    if (!from && hewn_arguments_has(arguments, "dims") &&
        hewn_volume_format_of_file(out->desc.input) == HEWN_VOLUME_UNKNOWN)
        out->desc.read.format = HEWN_VOLUME_RAW;
    if (out->desc.read.format == HEWN_VOLUME_UNKNOWN && strcmp(out->desc.input, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "standard input has no extension: name its format with --from");
    if (out->desc.read.format == HEWN_VOLUME_UNKNOWN && access(out->desc.input, F_OK) == 0 &&
        hewn_volume_format_of_file(out->desc.input) == HEWN_VOLUME_UNKNOWN)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--labels is for volumes, and %s is none that Hewn knows",
                         out->desc.input);
    return HEWN_OK;
}

/* Mesh formats have --from of their own, so that is taken out before the rest is read. */
static hewn_result read_files(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    hewn_arguments others = *arguments;
    others.given = hewn_alloc(arguments->given_count, sizeof *others.given);
    if (!others.given)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    others.given_count = 0;
    for (size_t i = 0; i < arguments->given_count; i++)
        if (!arguments->given[i].option->name || strcmp(arguments->given[i].option->name, "from") != 0)
            others.given[others.given_count++] = arguments->given[i];
    hewn_result result = hewn_file_arguments_read(&others, &out->file, error);
    hewn_free(others.given);
    return result;
}

/* What is for surfaces of values is refused, so that nobody believes it was done. */
static hewn_result read_steps(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    static const char *const others[] = {"smooth-volume", "method", "inside", "open"};
    bool simplify;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (hewn_arguments_has(arguments, others[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "--%s is for surfaces of values; it does not go with --labels", others[i]);
    HEWN_TRY(hewn_body_arguments_read(arguments, &out->keep, error));
    if (out->keep.largest > 0 || out->keep.least_volume > 0 || out->keep.fill_cavities)
        out->desc.keep = &out->keep;
    HEWN_TRY(hewn_simplify_target_read(arguments, &out->simplify, &simplify, error));
    out->simplify.measure = out->desc.report != NULL;
    out->desc.simplify = simplify ? &out->simplify : NULL;
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, request *out, hewn_error *error)
{
    const char *labels = hewn_arguments_value(arguments, "labels"), *method = hewn_arguments_value(arguments, "smooth");
    const char *passes = hewn_arguments_value(arguments, "smooth-labels");
    const char *space = hewn_arguments_value(arguments, "space");
    hewn_label_job_desc *desc = &out->desc;
    const hewn_file_job_desc *file = &out->file.desc;
    if (!labels)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--names, --smooth-labels and --complex go with --labels");
    HEWN_TRY(read_labels(labels, out, error));
    HEWN_TRY(read_files(arguments, out, error));
    if (file->up)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--up is for meshes; volumes know their axes");
    desc->input = file->input;
    desc->output = file->output;
    desc->to = file->to;
    desc->report = file->report;
    desc->unit = file->unit;
    desc->to_unit = file->to_unit;
    desc->to_up = file->to_up;
    if (space && !hewn_space_find(space, &desc->space))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--space is ras, lps, gltf, world or voxel, not '%s'", space);
    if (space && desc->to_up)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--space says where the axes are, so it does not go with --to-up");
    desc->names = hewn_arguments_value(arguments, "names");
    desc->complex = hewn_arguments_has(arguments, "complex");
    desc->relaxations = DEFAULT_RELAXATIONS;
    if (passes)
        HEWN_TRY(hewn_count_parse(passes, "--smooth-labels", 0, &desc->relaxations, error));
    if (desc->relaxations > 10000)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--smooth-labels takes 0 to 10000, not '%s'", passes);
    HEWN_TRY(read_steps(arguments, out, error));
    if (method) {
        HEWN_TRY(hewn_smooth_spec_parse(method, "--smooth", &out->smooth, error));
        if (out->smooth.lock_labels)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "--smooth lock=labels is for meshes: between labels, vertices "
                             "always move along the curves where these meet");
        desc->smooth = &out->smooth;
    }
    return read_volume(arguments, out, error);
}

/* --- telling what was done ------------------------------------------------------------------------------------------
 */

static void print_notes(const hewn_label_report *report)
{
    const hewn_conversion *done = &report->conversion;
    if (report->unit_assumed)
        fprintf(stderr, "hewn: note: the volume does not say its unit; millimetres were taken (--unit says another)\n");
    else if (done->unit_assumed)
        fprintf(stderr, "hewn: note: the volume does not say its unit; it was taken for %s (--unit says another)\n",
                done->unit_after->name);
    if (report->missing_count > 0) {
        fprintf(stderr, "hewn: note: no voxel has label %" PRId64, report->missing[0]);
        for (uint32_t i = 1; i < report->missing_count && i < 8; i++)
            fprintf(stderr, ", %" PRId64, report->missing[i]);
        fprintf(stderr, "%s\n", report->missing_count > 8 ? " and others" : "");
    }
    if (report->unnamed_count > 0)
        fprintf(stderr, "hewn: note: the table has no name for %" PRIu32 " of the labels\n", report->unnamed_count);
}

static void print(const hewn_label_job_desc *desc, const hewn_label_report *report)
{
    const hewn_conversion *done = &report->conversion;
    fprintf(stderr, "%s -> %s: %" PRIu32 " %s, which share %" PRIu64 " vertices, %" PRIu64 " faces; ",
            strcmp(desc->input, "-") == 0 ? "standard input" : desc->input,
            strcmp(desc->output, "-") == 0 ? "standard output" : desc->output, report->label_count,
            report->label_count == 1 ? "label" : "labels", report->vertices, report->faces);
    if (!done->unit_after)
        fprintf(stderr, "unit unknown");
    else if (!done->unit_before || done->unit_before == done->unit_after)
        fprintf(stderr, "unit %s", done->unit_after->name);
    else
        fprintf(stderr, "unit %s -> %s", done->unit_before->name, done->unit_after->name);
    if (report->up_known)
        fprintf(stderr, "; up %s", hewn_axis_name(done->up_after));
    fprintf(stderr, "; space %s\n", hewn_space_name(report->space));
    if (report->smoothed)
        fprintf(stderr, "  %s, vertices moved by %.4g in the mean, %.4g at most\n",
                hewn_smooth_method_name(report->smooth_method), report->smooth.mean_move, report->smooth.largest_move);
    if (report->islands.bodies > 0)
        fprintf(stderr, "  %" PRIu64 " of %" PRIu64 " islands of labels and %" PRIu64 " of %" PRIu64 " hollows kept\n",
                report->islands.kept_bodies, report->islands.bodies, report->islands.kept_cavities,
                report->islands.cavities);
    if (report->simplified)
        hewn_simplify_print(&report->simplify);
    print_notes(report);
}

int hewn_label_command_run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    request wanted = {0};
    hewn_label_report report = {0};
    hewn_result result = read_request(arguments, &wanted, &error);
    if (result == HEWN_OK) {
        hewn_signals_catch();
        hewn_progress progress = hewn_progress_begin(wanted.file.quiet);
        wanted.desc.progress = &progress;
        wanted.desc.began = hewn_started();
        result = hewn_labels_convert(&wanted.desc, &report, &error);
        hewn_progress_end();
    }
    if (result == HEWN_OK && !wanted.file.quiet)
        print(&wanted.desc, &report);
    hewn_label_report_destroy(&report);
    hewn_free(wanted.labels);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}
