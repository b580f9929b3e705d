#include "app/voxelize_arguments.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/file_arguments.h"
#include "app/number.h"
#include "app/path_arguments.h"
#include "app/scene_arguments.h"
#include "base/error.h"

static const char *const own[] = {"cell", "band", "dense", "bounds", "D", "allow-path"};

static bool is_scene(const char *path)
{
    const char *slash = path ? strrchr(path, '/') : NULL, *dot = path ? strrchr(slash ? slash : path, '.') : NULL;
    return dot && (strcmp(dot, ".lua") == 0 || strcmp(dot, ".vm") == 0);
}

static bool is_volume(const char *path)
{
    hewn_volume_format format = hewn_volume_format_of(path);
    return path && strcmp(path, "-") != 0 && (format == HEWN_VOLUME_VDB || format == HEWN_VOLUME_NRRD);
}

bool hewn_voxelize_wanted(const hewn_arguments *arguments)
{
    const char *from = hewn_arguments_value(arguments, "from"), *to = hewn_arguments_value(arguments, "to");
    const char *input = arguments->operand_count == 1 ? arguments->operands[0] : NULL;
    const char *output = hewn_arguments_value(arguments, "output");
    bool scene = from ? strcmp(from, "lua") == 0 || strcmp(from, "vm") == 0 : is_scene(input);
    bool volume = to ? strcmp(to, "vdb") == 0 || strcmp(to, "nrrd") == 0 : output && is_volume(output);
    hewn_volume_format unused;
    bool from_volume = from ? hewn_volume_format_find(from, &unused) : input && is_volume(input);
    return scene || (volume && !from_volume);
}

hewn_result hewn_voxelize_refuse(const hewn_arguments *arguments, hewn_error *error)
{
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (hewn_arguments_has(arguments, own[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s%s is for what becomes a volume (-o FILE.vdb or .nrrd)",
                             strlen(own[i]) == 1 ? "-" : "--", own[i]);
    return HEWN_OK;
}

/* --- arguments ------------------------------------------------------------------------------------------------------
 */

typedef struct request {
    hewn_scene_arguments scene;
    hewn_voxelize_job_desc desc;
    hewn_box bounds;
    bool quiet;
} request;

static hewn_result read_sizes(const hewn_arguments *arguments, request *wanted, hewn_error *error)
{
    const char *cell = hewn_arguments_value(arguments, "cell"), *band = hewn_arguments_value(arguments, "band");
    const char *memory = hewn_arguments_value(arguments, "max-memory"),
               *bounds = hewn_arguments_value(arguments, "bounds");
    hewn_voxelize_job_desc *desc = &wanted->desc;
    if (cell)
        HEWN_TRY(hewn_number_parse(cell, "--cell", &desc->cell, error));
    if (cell && !(desc->cell > 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--cell must be above 0, not %s", cell);
    if (band)
        HEWN_TRY(hewn_number_parse(band, "--band", &desc->band, error));
    if (band && !(desc->band >= 1 && desc->band <= 100))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--band is from 1 to 100 cells, not %s", band);
    if (memory)
        HEWN_TRY(hewn_bytes_parse(memory, "--max-memory", &desc->memory_limit, error));
    desc->dense = hewn_arguments_has(arguments, "dense");
    if (bounds)
        HEWN_TRY(hewn_bounds_parse(bounds, "--bounds", &wanted->bounds, error));
    desc->bounds = bounds ? &wanted->bounds : NULL;
    return HEWN_OK;
}

static hewn_result read_output(const hewn_arguments *arguments, hewn_voxelize_job_desc *desc, hewn_error *error)
{
    const char *to = hewn_arguments_value(arguments, "to"), *unit = hewn_arguments_value(arguments, "unit");
    HEWN_TRY(hewn_output_argument_read(arguments, "volume", "FILE.vdb or FILE.nrrd", &desc->output, error));
    if (to && strcmp(to, "vdb") != 0 && strcmp(to, "nrrd") != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--to of a volume is vdb or nrrd, not '%s'", to);
    if (to)
        desc->format = strcmp(to, "vdb") == 0 ? HEWN_VOLUME_VDB : HEWN_VOLUME_NRRD;
    HEWN_TRY(hewn_output_spare_terminal(desc->output, "a volume", error));
    desc->unit = unit ? hewn_unit_find(unit) : NULL;
    if (unit && !desc->unit)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--unit is one of %s, not '%s'", hewn_unit_names(), unit);
    desc->report = hewn_arguments_value(arguments, "report");
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, request *wanted, hewn_error *error)
{
    HEWN_TRY(hewn_scene_arguments_read_mesh_too(arguments, &wanted->scene, &wanted->desc.mesh, error));
    wanted->desc.scene = wanted->scene.desc;
    wanted->quiet = hewn_arguments_has(arguments, "quiet");
    HEWN_TRY(read_sizes(arguments, wanted, error));
    return read_output(arguments, &wanted->desc, error);
}

/* --- running --------------------------------------------------------------------------------------------------------
 */

static void print_summary(const hewn_voxelize_job_desc *desc, const hewn_voxelize_report *report)
{
    const hewn_sampling_written *written = &report->written;
    const char *output = strcmp(desc->output, "-") == 0 ? "standard output" : desc->output;
    fprintf(stderr, "%s -> %s: %u x %u x %u samples, cell %.6g%s%s", desc->scene.path, output, written->dims[0],
            written->dims[1], written->dims[2], report->cell, report->unit ? " " : "",
            report->unit ? report->unit->name : "");
    if (written->format == HEWN_VOLUME_VDB)
        fprintf(stderr, "; %" PRIu64 " active in %" PRIu64 " leaves", written->active, written->leaves);
    fprintf(stderr, ", %.2f MB\n  ", 1e-6 * (double)written->length);
    if (desc->dense)
        fputs("all distances", stderr);
    else
        fprintf(stderr, "distances within %.3g cells", report->band);
    if (report->is_mesh)
        fprintf(stderr, "; %" PRIu64 " faces, confidence %.4f", report->faces, report->mesh.confidence);
    fprintf(stderr, "; %.2f s\n", report->seconds);
    if (report->is_mesh && report->mesh.doubtful > 0.01)
        fprintf(stderr,
                "hewn: note: of %.1f %% of the samples at the surface it is in doubt whether they are inside; the mesh "
                "has holes, or faces that look the wrong way (hewn check)\n",
                100 * report->mesh.doubtful);
}

int hewn_voxelize_run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    request wanted = {0};
    hewn_voxelize_report report = {0};
    hewn_result result = read_request(arguments, &wanted, &error);
    if (result == HEWN_OK) {
        hewn_signals_catch();
        hewn_progress progress = hewn_progress_begin(wanted.quiet);
        wanted.desc.progress = &progress;
        wanted.desc.began = hewn_started();
        result = hewn_voxelize_file(&wanted.desc, &report, &error);
        hewn_progress_end();
    }
    if (result == HEWN_OK && !wanted.quiet)
        print_summary(&wanted.desc, &report);
    hewn_scene_arguments_destroy(&wanted.scene);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}
