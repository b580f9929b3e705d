#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/number.h"
#include "app/path_arguments.h"
#include "app/scene_arguments.h"
#include "app/simplify_arguments.h"
#include "app/smooth_arguments.h"
#include "app/sweep.h"
#include "app/validation.h"
#include "base/alloc.h"
#include "base/error.h"

static const hewn_option options[] = {
    {'o', "output", "FILE",
     "Write the mesh to FILE; its extension (.glb, .obj, .ply, .stl, .off, .3mf) names the format. `-` is standard "
     "output, with --to. Required."},
    {0, "res", "N", "Use N cells on the longest side of the bounds. Default: 128."},
    {0, "cell", "H", "Use cells of side H, in the scene's units, instead of --res."},
    {0, "method", "NAME",
     "Extract the surface by this method: mc (marching cubes), mc33 (the same, connected as the samples' trilinear "
     "interpolant is), nets (a vertex in each cell, at the mean of the crossings) or dc (dual contouring: the same "
     "with "
     "sharp edges and corners). Default: dc."},
    {0, "quads", NULL, "Write the quads of nets or dc, two triangles each, as faces of four corners (OBJ, OFF, PLY)."},
    {0, "adaptive", "ERROR",
     "Merge the triangles of dc to fewer and larger ones, as far as the surface moves by no more than ERROR, a length "
     "in "
     "the scene's units."},
    HEWN_OPTION_SMOOTH,
    HEWN_OPTION_SIMPLIFY,
    {0, "bounds", "BOX",
     "Look for the surface in BOX = x0,y0,z0,x1,y1,z1. Default: the scene's own bounds, else found from the field."},
    {0, "open", NULL, "Leave the surface open where it leaves the bounds. Default: close it there with a flat cap."},
    {'D', NULL, "NAME=VALUE", "Set a parameter of the scene; `hewn info SCENE` lists them. May be repeated."},
    HEWN_OPTION_SWEEP,
    {0, "from", "FORMAT", "Read the scene as lua or vm. Default: by its extension; needed where SCENE is `-`."},
    HEWN_OPTION_TO,
    {0, "allow-path", NULL, "Let the scene read files outside its own folder."},
    {0, "device", "DEVICE",
     "Compute on this device, an index or a part of a name as `hewn devices` lists them. Default: $HEWN_DEVICE, else "
     "the best."},
    {0, "threads", "N", "Use N threads. Default: one for each processor."},
    {0, "max-memory", "SIZE",
     "Make the mesh in parts that take at most SIZE bytes of memory, of the device and the host together; K, M and G "
     "stand for 2^10, 2^20 and 2^30. The parts wait on disk beside FILE, and the mesh is the same. Default: no limit."},
    {0, "report", "FILE", "Write a report as JSON to FILE; `-` is standard output (not together with -o -)."},
    {'q', "quiet", NULL, "Print errors only: no progress, no summary."},
    {0, "watch", NULL, "Mesh again whenever the scene or a file that it imports changes, until Ctrl-C."},
    {'h', "help", NULL, "Print this help."},
};

/* The command line as a job. */
typedef struct mesh_request {
    hewn_mesh_job_desc desc;
    hewn_scene_arguments scene;
    hewn_box bounds;
    hewn_file_smooth smooth;
    hewn_simplify_desc simplify;
    hewn_sweep sweep;
    bool quiet;
    bool watch;
} mesh_request;

static bool is_dash(const char *path)
{
    return strcmp(path, "-") == 0;
}

static hewn_result parse_method(const char *name, hewn_method *out, hewn_error *error)
{
    char names[64] = "";
    if (hewn_method_named(name, out))
        return HEWN_OK;
    for (hewn_method method = HEWN_METHOD_DEFAULT + 1; hewn_method_name(method); method++) {
        size_t length = strlen(names);
        const char *between = length == 0 ? "" : hewn_method_name(method + 1) ? ", " : " or ";
        snprintf(names + length, sizeof names - length, "%s%s", between, hewn_method_name(method));
    }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--method is %s, not '%s'", names, name);
}

static hewn_result read_grid(const hewn_arguments *arguments, mesh_request *request, hewn_error *error)
{
    const char *resolution = hewn_arguments_value(arguments, "res");
    const char *cell = hewn_arguments_value(arguments, "cell");
    const char *bounds = hewn_arguments_value(arguments, "bounds");
    const char *method = hewn_arguments_value(arguments, "method");
    const char *adaptive = hewn_arguments_value(arguments, "adaptive");
    if (resolution && cell)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--res and --cell exclude each other");
    if (resolution)
        HEWN_TRY(hewn_count_parse(resolution, "--res", 1, &request->desc.resolution, error));
    if (cell) {
        HEWN_TRY(hewn_number_parse(cell, "--cell", &request->desc.cell, error));
        if (!(request->desc.cell > 0))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--cell must be greater than 0, not %s", cell);
    }
    if (adaptive) {
        HEWN_TRY(hewn_number_parse(adaptive, "--adaptive", &request->desc.adaptive, error));
        if (!(request->desc.adaptive > 0))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--adaptive must be greater than 0, not %s", adaptive);
    }
    if (bounds) {
        HEWN_TRY(hewn_bounds_parse(bounds, "--bounds", &request->bounds, error));
        request->desc.bounds = &request->bounds;
    }
    if (method)
        HEWN_TRY(parse_method(method, &request->desc.method, error));
    request->desc.quads = hewn_arguments_has(arguments, "quads");
    request->desc.open = hewn_arguments_has(arguments, "open");
    return HEWN_OK;
}

static hewn_result read_output(const hewn_arguments *arguments, mesh_request *request, hewn_error *error)
{
    hewn_mesh_job_desc *desc = &request->desc;
    HEWN_TRY(hewn_mesh_output_read(arguments, &desc->output, &desc->report, &desc->format, error));
    request->quiet = hewn_arguments_has(arguments, "quiet");
    request->watch = hewn_arguments_has(arguments, "watch");
    if (request->watch && (is_dash(desc->output) || is_dash(desc->scene.path)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--watch needs files, not standard input or output");
    HEWN_TRY(hewn_sweep_read(arguments, &request->scene, &request->sweep, error));
    if (request->sweep.count > 0 && (is_dash(desc->output) || (desc->report && is_dash(desc->report))))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep needs files, not standard output");
    if (request->sweep.count > 0 && request->watch)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep and --watch exclude each other");
    return HEWN_OK;
}

static hewn_result read_device(const hewn_arguments *arguments, mesh_request *request, hewn_error *error)
{
    const char *threads = hewn_arguments_value(arguments, "threads");
    const char *memory = hewn_arguments_value(arguments, "max-memory");
    request->desc.device = hewn_arguments_value(arguments, "device");
    request->desc.validation = hewn_validation_wanted();
    if (memory)
        HEWN_TRY(hewn_bytes_parse(memory, "--max-memory", &request->desc.max_memory, error));
    if (!threads)
        return HEWN_OK;
    HEWN_TRY(hewn_count_parse(threads, "--threads", 1, &request->desc.threads, error));
    if (request->desc.threads > 4096)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--threads is at most 4096, not %s", threads);
    return HEWN_OK;
}

static hewn_result read_smooth(const hewn_arguments *arguments, mesh_request *request, hewn_error *error)
{
    const char *smooth = hewn_arguments_value(arguments, "smooth");
    if (!smooth)
        return HEWN_OK;
    HEWN_TRY(hewn_smooth_spec_parse(smooth, "--smooth", &request->smooth, error));
    if (request->smooth.lock_labels)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--smooth: labels of a scene cannot be locked");
    request->desc.smooth = &request->smooth.desc;
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, mesh_request *request, hewn_error *error)
{
    HEWN_TRY(hewn_scene_arguments_read(arguments, &request->scene, error));
    request->desc.scene = request->scene.desc;
    HEWN_TRY(read_grid(arguments, request, error));
    HEWN_TRY(read_output(arguments, request, error));
    bool simplify;
    HEWN_TRY(hewn_simplify_target_read(arguments, &request->simplify, &simplify, error));
    request->simplify.measure = request->desc.report != NULL;
    request->desc.simplify = simplify ? &request->simplify : NULL;
    HEWN_TRY(read_smooth(arguments, request, error));
    return read_device(arguments, request, error);
}

/* --- what people see --------------------------------------------------------------------------------------------- */

/* " m³" for metres; nothing for a scene whose units have no name. */
static void print_measure(const char *name, double value, const char *units, const char *power)
{
    fprintf(stderr, "%s %.6g%s%s%s", name, value, units[0] ? " " : "", units, units[0] ? power : "");
}

static const char *plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

/* What dual contouring found and what it lost. */
static void print_features(const hewn_extract_stats *stats)
{
    if (stats->edge_vertices + stats->corner_vertices > 0)
        fprintf(stderr, "\n  sharp edges through %llu vert%s, %llu corner%s", (unsigned long long)stats->edge_vertices,
                stats->edge_vertices == 1 ? "ex" : "ices", (unsigned long long)stats->corner_vertices,
                plural(stats->corner_vertices));
    if (stats->features_lost > 0)
        fprintf(stderr, "; %llu feature%s too fine for the cells", (unsigned long long)stats->features_lost,
                plural(stats->features_lost));
}

static void print_summary(const hewn_report *report)
{
    const hewn_certificate *certificate = &report->certificate;
    fprintf(stderr, "%s: %llu vertices, %llu faces; %s, manifold, oriented; %llu component%s",
            is_dash(report->output) ? "standard output" : report->output, (unsigned long long)report->vertices,
            (unsigned long long)report->faces, certificate->closed ? "closed" : "open",
            (unsigned long long)certificate->components, plural(certificate->components));
    if (certificate->genus >= 0)
        fprintf(stderr, ", genus %lld", (long long)certificate->genus);
    fputs("\n  ", stderr);
    if (certificate->closed) {
        print_measure("volume", certificate->volume, report->units, "³");
        fputs(", ", stderr);
    }
    print_measure("area", certificate->area, report->units, "²");
    if (certificate->max_residual == certificate->max_residual)
        fprintf(stderr, ", vertices within %.2g of a cell of the surface", certificate->max_residual);
    const hewn_extract_stats *grid = &report->extraction;
    print_features(grid);
    fprintf(stderr, "\n  %llu x %llu x %llu cells of %.6g%s%s, %.2f s on %s\n", (unsigned long long)grid->cells[0],
            (unsigned long long)grid->cells[1], (unsigned long long)grid->cells[2], grid->cell,
            report->units[0] ? " " : "", report->units, report->seconds, report->device.name);
    if (report->smoothed)
        hewn_smooth_print(&report->smooth, report->smooth_method);
    if (report->simplified)
        hewn_simplify_print(&report->simplify);
    for (size_t i = 0; i < report->sampled_count; i++)
        if (report->sampled[i].is_mesh && report->sampled[i].doubtful > 0.01)
            fprintf(stderr,
                    "hewn: note: of %.1f %% of the samples at the surface of %s it is in doubt whether they are inside "
                    "(confidence %.3f)\n",
                    100 * report->sampled[i].doubtful, report->sampled[i].path, report->sampled[i].confidence);
    if (grid->left_bounds)
        fprintf(stderr, "hewn: note: the surface reaches the bounds and was %s there; wider --bounds keep it whole\n",
                report->open ? "left open" : "closed with a flat cap");
}

/* Half of the cell that was used, as the option that was given. */
static void print_finer(const hewn_report *report)
{
    const hewn_extract_stats *grid = &report->extraction;
    if (report->resolution == 0)
        fprintf(stderr, "--cell %.6g", grid->cell / 2);
    else if (report->resolution <= HEWN_MAX_RESOLUTION / 2)
        fprintf(stderr, "--res %u", 2 * report->resolution);
    else
        fputs("narrower --bounds", stderr);
}

/* What the mesh may lack, though nothing about it is wrong. */
static void print_warnings(const hewn_report *report)
{
    const hewn_extract_stats *grid = &report->extraction;
    const hewn_box *first = &grid->first_suspect;
    if (grid->suspect_cells > 0) {
        fprintf(
            stderr,
            "hewn: warning: %llu cell%s away from the surface may hold features thinner than a cell, which the mesh "
            "lacks; the first is at (%.6g, %.6g, %.6g); ",
            (unsigned long long)grid->suspect_cells, grid->suspect_cells == 1 ? "" : "s",
            (first->lo[0] + first->hi[0]) / 2, (first->lo[1] + first->hi[1]) / 2, (first->lo[2] + first->hi[2]) / 2);
        print_finer(report);
        fputs(" may show them\n", stderr);
    }
    if (grid->undefined_cells > 0)
        fprintf(
            stderr,
            "hewn: note: in %llu cell%s away from the surface the field has no bounds (it may divide by zero or not "
            "be a number), so nothing is known of thin features there\n",
            (unsigned long long)grid->undefined_cells, grid->undefined_cells == 1 ? "" : "s");
}

static void print_outcome(const hewn_report *report)
{
    print_summary(report);
    print_warnings(report);
}

/* --- running ----------------------------------------------------------------------------------------------------- */

/* Meshes once. Where `watch` is not NULL it learns of every file that was read. */
static hewn_result mesh_once(const mesh_request *request, double began, hewn_watch *watch, hewn_mesh_kept *kept,
                             hewn_error *error)
{
    hewn_progress progress = hewn_progress_begin(request->quiet);
    hewn_mesh_job_desc desc = request->desc;
    desc.progress = &progress;
    desc.kept = kept;
    desc.began = began;
    hewn_report report;
    hewn_result result = hewn_mesh_scene(&desc, &report, error);
    hewn_progress_end();
    if (result == HEWN_OK && !request->quiet)
        print_outcome(&report);
    if (result == HEWN_OK && report.validation_messages > 0) /* what the device was told was wrong: a device error */
        result = hewn_fail(error, HEWN_DEVICE_LOST, "the validation layer gave %llu messages",
                           (unsigned long long)report.validation_messages);
    for (size_t i = 0; watch && i < report.file_count; ++i)
        (void)hewn_watch_add(watch, report.files[i], NULL);
    hewn_report_destroy(&report);
    return result;
}

/* Meshes once for each value of the parameter; the device and what was compiled for it are kept between them. */
static hewn_result mesh_sweep(mesh_request *request, hewn_error *error)
{
    hewn_sweep *sweep = &request->sweep;
    const char *output = request->desc.output, *report = request->desc.report;
    hewn_mesh_kept *kept = NULL;
    hewn_result result = hewn_mesh_kept_create(&kept, error);
    for (uint32_t step = 0; result == HEWN_OK && step < sweep->count; step++) {
        char *mesh = hewn_sweep_path(sweep, output, step);
        char *json = report ? hewn_sweep_path(sweep, report, step) : NULL;
        hewn_sweep_set(sweep, step, &request->desc.scene);
        request->desc.output = mesh;
        request->desc.report = json;
        result = mesh && (json || !report) ? mesh_once(request, step == 0 ? hewn_started() : 0, NULL, kept, error)
                                           : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory");
        hewn_free(mesh);
        hewn_free(json);
        result = hewn_sweep_blame(sweep, step, result, error);
    }
    hewn_mesh_kept_destroy(&kept);
    return result;
}

/* Whether it makes sense to wait for a better scene after this. */
static bool is_end(hewn_result result)
{
    return result == HEWN_CANCELLED || result == HEWN_INVALID_ARGUMENT || result == HEWN_NO_LOADER ||
           result == HEWN_NO_DEVICE || result == HEWN_MISSING_FEATURE;
}

static hewn_result watch_scene(const mesh_request *request, hewn_watch *watch, hewn_mesh_kept *kept, hewn_error *error)
{
    HEWN_TRY(hewn_watch_add(watch, request->desc.scene.path, error));
    double began = hewn_started();
    for (;;) {
        hewn_watch_mark(watch);
        hewn_result result = mesh_once(request, began, watch, kept, error);
        if (is_end(result))
            return result;
        if (result != HEWN_OK)
            hewn_report_failure(error);
        if (result == HEWN_BAD_INPUT && error->file[0]) /* the fault may be in an import */
            (void)hewn_watch_add(watch, error->file, NULL);
        if (!request->quiet)
            fprintf(stderr, "hewn: watching %s\n", request->desc.scene.path);
        HEWN_TRY(hewn_watch_wait(watch, error));
        *error = (hewn_error){0};
        began = 0;
    }
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    mesh_request request = {0};
    hewn_error error = {0};
    hewn_result result = read_request(arguments, &request, &error);
    int code = 0;
    if (result != HEWN_OK) {
        code = hewn_report_misuse(command, &error);
    } else {
        hewn_signals_catch();
        hewn_watch *watch = NULL;
        hewn_mesh_kept *kept = NULL;
        if (request.watch)
            result = hewn_watch_create(&watch, &error);
        if (result == HEWN_OK && request.watch)
            result = hewn_mesh_kept_create(&kept, &error);
        if (result == HEWN_OK && request.sweep.count > 0)
            result = mesh_sweep(&request, &error);
        else if (result == HEWN_OK)
            result = watch ? watch_scene(&request, watch, kept, &error)
                           : mesh_once(&request, hewn_started(), NULL, NULL, &error);
        hewn_mesh_kept_destroy(&kept);
        hewn_watch_destroy(&watch);
        if (result != HEWN_OK)
            code = hewn_report_misuse(command, &error);
    }
    hewn_sweep_destroy(&request.sweep);
    hewn_scene_arguments_destroy(&request.scene);
    return code;
}

const hewn_command hewn_command_mesh = {
    .name = "mesh",
    .summary = "turn a scene into a mesh file",
    .usage = "SCENE -o FILE [OPTION]...",
    .about = "Runs SCENE (.lua, .vm; `-` reads standard input) and writes the surface of its\n"
             "field as triangles, proven to be a closed, oriented 2-manifold. GLB is in metres\n"
             "with +Y up, 3MF has +Z up; other formats keep the scene's coordinates. A file\n"
             "appears under its name only when complete. A summary goes to standard error.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn mesh assets/scenes/bracket.lua -o bracket.glb --res 256\n"
             "  hewn mesh assets/scenes/menger.lua -D L=4 -o sponge.stl --report sponge.json\n"
             "  hewn mesh assets/scenes/vase.lua --sweep twist=0:120:30 -o vase.ply\n"
             "  hewn mesh - --from vm -o - --to ply < model.vm > model.ply\n",
    .run = run,
};
