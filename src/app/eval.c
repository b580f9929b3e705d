#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/number.h"
#include "app/number_lines.h"
#include "app/rows.h"
#include "app/scene_arguments.h"
#include "app/validation.h"
#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/json.h"
#include "base/progress.h"
#include "pipeline/domain.h"
#include "pipeline/paths.h"

enum { BATCH = 1 << 14, DEVICE_BATCH = 1 << 16, PIECE = 1 << 10, MOST_SIDE = 1 << 16 };

typedef struct eval_request {
    hewn_scene_arguments scene;
    const hewn_arguments *arguments;
    const char *points, *output, *report, *device;
    uint32_t grid[3]; /* 0: no grid */
    hewn_box bounds;
    bool bounded, gradient, inside, quiet;
} eval_request;

/* What an evaluation over a grid cost. */
typedef struct grid_report {
    hewn_plane_stats plane; /* means over all planes */
    double seconds;
    hewn_box box;
} grid_report;

static const hewn_option options[] = {
    {0, "points", "FILE",
     "Evaluate at the points of FILE, one a line: three numbers with blanks or commas between; `-` is standard input. "
     "Any number of lines; empty ones and what follows a # are passed over."},
    {0, "at", "X,Y,Z", "Evaluate at this point. May be repeated."},
    {0, "grid", "SIZE",
     "NXxNYxNZ: evaluate in the middles of so many cells of the bounds, x fastest, y and z rising. NXxNY: on the plane "
     "z = 0."},
    {0, "gradient", NULL, "Print the gradient behind the value: VALUE DX DY DZ. Not with --grid."},
    {0, "inside", NULL, "With --grid print 1 where the value is below 0, else 0; what bounds decide is not computed."},
    {'o', "output", "FILE", "Write to FILE, which appears when it is complete. Default: `-`, standard output."},
    {0, "report", "FILE", "With --grid: write what it cost as JSON to FILE (`-`: standard output, then with -o FILE)."},
    {0, "bounds", "BOX",
     "The grid's box, x0,y0,z0,x1,y1,z1 in scene units; for a plane x0,y0,x1,y1 or, at z, x0,y0,z,x1,y1,z. Default: "
     "the scene's own, or found from its field; for a plane of a .vm file -1 to 1."},
    {'D', NULL, "NAME=VALUE", "Set a parameter of the scene. May be repeated."},
    {0, "from", "FORMAT", "Read the scene as lua or vm. Default: by its extension; needed where it is `-`."},
    {0, "allow-path", NULL, "Let the scene read files outside its own folder."},
    {0, "device", "DEVICE",
     "Let the device of this index, or whose name contains this, compute, in single precision; not with --report. "
     "Default: `host`, the host's processors. Very large fields are always theirs."},
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

/* --- the command line -----------------------------------------------------------------------------------------------
 */

static hewn_result read_grid(const char *text, eval_request *request, hewn_error *error)
{
    char *end;
    int count = 0;
    bool good = text[0] >= '0' && text[0] <= '9';
    for (const char *at = text; good; at = end + 1) {
        unsigned long long side = strtoull(at, &end, 10);
        good = *at >= '0' && *at <= '9' && count < 3 && side >= 1 && side <= MOST_SIDE;
        if (good)
            request->grid[count++] = (uint32_t)side;
        good = good && (*end == 'x' || *end == '\0');
        if (*end == '\0')
            break;
    }
    if (good && count >= 2)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--grid is NXxNY or NXxNYxNZ, each from 1 to %d, not '%s'",
                     MOST_SIDE, text);
}

static hewn_result check_request(const eval_request *request, bool at, hewn_error *error)
{
    int ways = at + (request->points != NULL) + (request->grid[0] > 0);
    if (ways != 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         ways ? "--points, --at and --grid exclude each other"
                              : "where? Give --points FILE, --at X,Y,Z or --grid NXxNY");
    if (request->device && request->report)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--report tells what bounds save the host; a device takes none");
    if (request->grid[0] > 0 && request->gradient)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--grid prints values, without --gradient");
    if (request->grid[0] == 0 && (request->inside || request->report || request->bounded))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--inside, --bounds and --report go with --grid");
    if (request->report && strcmp(request->report, "-") == 0 && (!request->output || strcmp(request->output, "-") == 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the values and the report cannot both go to standard output");
    if (request->report && request->output && strcmp(request->report, request->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the values and the report cannot both go to %s",
                         request->output);
    if (request->points && strcmp(request->points, "-") == 0 && strcmp(request->scene.desc.path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the scene and the points cannot both come from standard input");
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, eval_request *request, hewn_error *error)
{
    const char *grid = hewn_arguments_value(arguments, "grid"), *bounds = hewn_arguments_value(arguments, "bounds");
    request->arguments = arguments;
    HEWN_TRY(hewn_scene_arguments_read(arguments, &request->scene, error));
    request->points = hewn_arguments_value(arguments, "points");
    request->output = hewn_arguments_value(arguments, "output");
    request->report = hewn_arguments_value(arguments, "report");
    request->device = hewn_arguments_value(arguments, "device");
    if (request->device && strcmp(request->device, "host") == 0)
        request->device = NULL;
    request->gradient = hewn_arguments_has(arguments, "gradient");
    request->inside = hewn_arguments_has(arguments, "inside");
    request->quiet = hewn_arguments_has(arguments, "quiet");
    request->bounded = bounds != NULL;
    if ((request->output && !request->output[0]) || (request->report && !request->report[0]))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
    if (grid)
        HEWN_TRY(read_grid(grid, request, error));
    if (bounds && request->grid[2] > 0)
        HEWN_TRY(hewn_bounds_parse(bounds, "--bounds", &request->bounds, error));
    else if (bounds)
        HEWN_TRY(hewn_plane_bounds_parse(bounds, "--bounds", &request->bounds, error));
    return check_request(request, hewn_arguments_has(arguments, "at"), error);
}

/* --- points ---------------------------------------------------------------------------------------------------------
 */

/* Who computes. */
typedef struct computing {
    const hewn_field *field;
    hewn_device *device;
    hewn_evaluator *evaluator; /* NULL: the host */
} computing;

static hewn_result begin_computing(const eval_request *request, const hewn_field *field, computing *out,
                                   hewn_error *error)
{
    const hewn_device_desc desc = {.choice = request->device, .validation = hewn_validation_wanted()};
    *out = (computing){.field = field};
    if (!request->device)
        return HEWN_OK;
    HEWN_TRY(hewn_device_create(&desc, &out->device, error));
    return hewn_evaluator_create(out->device, field, hewn_field_root(field), &out->evaluator, error);
}

static hewn_result end_computing(computing *on, hewn_result result, hewn_error *error)
{
    if (result == HEWN_OK && on->device && hewn_device_message_count(on->device) > 0)
        result = hewn_fail(error, HEWN_DEVICE_LOST, "the validation layer gave messages");
    hewn_evaluator_destroy(&on->evaluator);
    hewn_device_destroy(&on->device);
    return result;
}

/* On the host all threads, each on pieces of its own. */
static hewn_result eval_points(const computing *on, bool gradient, const double *points, size_t count, double *values,
                               hewn_error *error)
{
    const hewn_field *field = on->field;
    if (on->evaluator && gradient)
        return hewn_evaluator_gradients(on->evaluator, points, count, values, error);
    if (on->evaluator)
        return hewn_evaluator_values(on->evaluator, points, count, values, error);
    hewn_result all = HEWN_OK;
    hewn_error reason = {0};
#pragma omp parallel for schedule(dynamic) if (count > PIECE)
    for (size_t first = 0; first < count; first += PIECE) {
        hewn_error own = {0};
        size_t taken = count - first < PIECE ? count - first : PIECE;
        hewn_node root = hewn_field_root(field);
        hewn_result result = gradient
                                 ? hewn_field_gradient(field, root, points + 3 * first, taken, values + 4 * first, &own)
                                 : hewn_field_eval(field, root, points + 3 * first, taken, values + first, &own);
#pragma omp critical(hewn_eval)
        if (result != HEWN_OK && all == HEWN_OK) {
            all = result;
            reason = own;
        }
    }
    if (all != HEWN_OK && error)
        *error = reason;
    return all;
}

static void print_values(hewn_rows *rows, bool gradient, const double *values, size_t count)
{
    size_t width = gradient ? 4 : 1;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < width; k++)
            hewn_rows_number(rows, values[i * width + k], false);
        hewn_rows_end(rows);
    }
}

static hewn_result eval_given(const eval_request *request, const computing *on, hewn_rows *rows, hewn_error *error)
{
    for (size_t i = 0; i < request->arguments->given_count; i++) {
        const hewn_given *given = &request->arguments->given[i];
        double p[3], values[4];
        if (!given->option->name || strcmp(given->option->name, "at") != 0)
            continue;
        const char *text = given->value;
        HEWN_TRY(hewn_triple_parse(&text, "--at", p, error));
        if (*text)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--at is X,Y,Z, not '%s'", given->value);
        HEWN_TRY(eval_points(on, request->gradient, p, 1, values, error));
        print_values(rows, request->gradient, values, 1);
    }
    return HEWN_OK;
}

static hewn_result eval_lines(const eval_request *request, const computing *on, hewn_number_lines *lines,
                              hewn_rows *rows, hewn_error *error)
{
    double *points = hewn_alloc(BATCH, 3 * sizeof *points), *values = hewn_alloc(BATCH, 4 * sizeof *values);
    hewn_result result = points && values ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for points");
    size_t count = BATCH;
    while (result == HEWN_OK && count == BATCH) {
        result = hewn_number_lines_read(lines, points, BATCH, &count, error);
        if (result == HEWN_OK && hewn_signals_cancelled())
            result = hewn_fail(error, HEWN_CANCELLED, "cancelled during evaluate");
        if (result == HEWN_OK)
            result = eval_points(on, request->gradient, points, count, values, error);
        if (result != HEWN_OK)
            break;
        print_values(rows, request->gradient, values, count);
        result = hewn_rows_flush(rows, error);
    }
    hewn_free(points);
    hewn_free(values);
    return result;
}

/* --- grids ----------------------------------------------------------------------------------------------------------
 */

static bool is_vm(const eval_request *request)
{
    const char *dot = strrchr(request->scene.desc.path, '.');
    return request->scene.desc.format == HEWN_SCENE_VM || (dot && strcmp(dot, ".vm") == 0);
}

static hewn_result choose_box(const eval_request *request, const hewn_scene *scene, hewn_box *out, hewn_error *error)
{
    const hewn_mesh_job_desc like = {.bounds = request->bounded ? &request->bounds : NULL, .resolution = 256};
    hewn_bounds_source source;
    if (request->grid[2] > 0)
        return hewn_domain_choose(&like, scene, out, &source, error);
    *out = (hewn_box){{-1, -1, 0}, {1, 1, 0}};
    if (request->bounded)
        *out = request->bounds;
    else if (!hewn_scene_bounds(scene, out) && !is_vm(request))
        return hewn_fail(error, HEWN_BAD_INPUT, "the scene has no bounds: set them there, or use --bounds x0,y0,x1,y1");
    if (!request->bounded)
        out->lo[2] = 0;
    return HEWN_OK;
}

static hewn_result print_plane(const eval_request *request, const hewn_picture *picture, hewn_rows *rows,
                               hewn_error *error)
{
    bool colour = picture->kind == HEWN_PICTURE_COLOUR;
    for (uint32_t y = picture->height; y-- > 0;) { /* a picture has the highest row first */
        if (hewn_signals_cancelled())
            return hewn_fail(error, HEWN_CANCELLED, "cancelled during evaluate");
        for (uint32_t x = 0; x < picture->width; x++) {
            size_t at = (size_t)y * picture->width + x;
            if (request->inside)
                hewn_rows_word(rows, picture->values[colour ? 3 * at : at] > 0 ? "1" : "0");
            else
                hewn_rows_number(rows, (double)picture->values[at], true);
            hewn_rows_end(rows);
        }
        HEWN_TRY(hewn_rows_flush(rows, error));
    }
    return HEWN_OK;
}

/* Progress of one of many planes as a part of the whole. */
typedef struct plane_progress {
    const hewn_progress *whole;
    uint32_t plane, planes;
} plane_progress;

static bool report_plane(void *user, const char *stage, double fraction)
{
    const plane_progress *own = user;
    return !own->whole->report || own->whole->report(own->whole->user, stage, (own->plane + fraction) / own->planes);
}

static hewn_result eval_grid(const eval_request *request, const hewn_field *field, const hewn_progress *progress,
                             hewn_rows *rows, grid_report *report, hewn_error *error)
{
    uint32_t planes = request->grid[2] ? request->grid[2] : 1;
    hewn_plane_desc desc = {.width = request->grid[0], .height = request->grid[1], .values = !request->inside};
    plane_progress part = {.whole = progress, .planes = planes};
    const hewn_progress parts = {report_plane, &part};
    desc.progress = &parts;
    memcpy(desc.lo, report->box.lo, sizeof desc.lo);
    memcpy(desc.hi, report->box.hi, sizeof desc.hi);
    for (uint32_t k = 0; k < planes; k++) {
        hewn_picture picture;
        hewn_plane_stats stats;
        part.plane = k;
        double side = report->box.hi[2] - report->box.lo[2], began = hewn_clock_now();
        desc.z = request->grid[2] ? report->box.lo[2] + side * (k + 0.5) / planes : report->box.lo[2];
        HEWN_TRY(hewn_render_plane(field, hewn_field_root(field), &desc, &picture, &stats, error));
        report->seconds += hewn_clock_now() - began;
        report->plane.operations = stats.operations;
        report->plane.operations_a_pixel += stats.operations_a_pixel / planes;
        report->plane.bounds_a_pixel += stats.bounds_a_pixel / planes;
        report->plane.filled += stats.filled / planes;
        hewn_result result = print_plane(request, &picture, rows, error);
        hewn_picture_destroy(&picture);
        HEWN_TRY(result);
    }
    return HEWN_OK;
}

/* Row after row, as many points as fit into a batch. */
static hewn_result eval_grid_on_device(const eval_request *request, const computing *on, const hewn_progress *progress,
                                       hewn_rows *rows, grid_report *report, hewn_error *error)
{
    const uint32_t n[3] = {request->grid[0], request->grid[1], request->grid[2] ? request->grid[2] : 1};
    const uint64_t all = (uint64_t)n[0] * n[1] * n[2];
    double *points = hewn_alloc(DEVICE_BATCH, 3 * sizeof *points), *values = hewn_alloc(DEVICE_BATCH, sizeof *values);
    hewn_result result = points && values ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for points");
    double began = hewn_clock_now();
    for (uint64_t first = 0; first < all && result == HEWN_OK; first += DEVICE_BATCH) {
        size_t count = all - first < DEVICE_BATCH ? (size_t)(all - first) : DEVICE_BATCH;
        result = hewn_progress_report(progress, "evaluate", (double)first / (double)all, error);
        for (size_t i = 0; i < count && result == HEWN_OK; i++) {
            const uint64_t at[3] = {(first + i) % n[0], (first + i) / n[0] % n[1], (first + i) / n[0] / n[1]};
            for (int axis = 0; axis < 3; axis++) {
                double lo = report->box.lo[axis], side = report->box.hi[axis] - lo;
                bool flat = axis == 2 && request->grid[2] == 0;
                points[3 * i + (size_t)axis] = flat ? lo : lo + side * (((double)at[axis] + 0.5) / n[axis]);
            }
        }
        if (result == HEWN_OK)
            result = hewn_evaluator_values(on->evaluator, points, count, values, error);
        for (size_t i = 0; i < count && result == HEWN_OK; i++) {
            if (request->inside)
                hewn_rows_word(rows, values[i] < 0 ? "1" : "0");
            else
                hewn_rows_number(rows, values[i], true);
            hewn_rows_end(rows);
        }
        if (result == HEWN_OK)
            result = hewn_rows_flush(rows, error);
    }
    report->seconds = hewn_clock_now() - began;
    hewn_free(points);
    hewn_free(values);
    return result;
}

static hewn_result write_report(const eval_request *request, const grid_report *report, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    const hewn_plane_stats *plane = &report->plane;
    double all = (double)plane->operations;
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "input", request->scene.desc.path);
    hewn_json_array(&json, "grid");
    for (int i = 0; i < 3; i++)
        hewn_json_unsigned(&json, NULL, request->grid[i] ? request->grid[i] : 1);
    hewn_json_end_array(&json);
    hewn_json_unsigned(&json, "operations", plane->operations);
    hewn_json_number(&json, "operations_a_sample", plane->operations_a_pixel);
    hewn_json_number(&json, "bounds_a_sample", plane->bounds_a_pixel);
    hewn_json_number(&json, "share_of_operations", plane->operations_a_pixel / all);
    hewn_json_number(&json, "share_with_bounds", (plane->operations_a_pixel + plane->bounds_a_pixel) / all);
    hewn_json_number(&json, "share_decided_by_bounds", plane->filled);
    hewn_json_number(&json, "seconds", report->seconds);
    hewn_json_end_object(&json);
    hewn_output *output;
    hewn_result result = hewn_text_status(&text, error);
    if (result == HEWN_OK)
        result = hewn_output_create(request->report, &output, error);
    if (result == HEWN_OK) {
        result = hewn_output_write(output, text.bytes, text.length, error);
        if (result == HEWN_OK)
            result = hewn_output_finish(&output, error);
        hewn_output_destroy(&output);
    }
    hewn_text_clear(&text);
    return result;
}

static void print_summary(const grid_report *report)
{
    const hewn_plane_stats *plane = &report->plane;
    if (plane->operations == 0) { /* a device does not tell */
        fprintf(stderr, "%.3f s\n", report->seconds);
        return;
    }
    double all = (double)plane->operations, both = plane->operations_a_pixel + plane->bounds_a_pixel;
    fprintf(stderr,
            "%.1f of %llu operations a sample (%.2f %%), with those of bounds %.1f (%.2f %%); bounds decided %.0f %%; "
            "%.3f s\n",
            plane->operations_a_pixel, (unsigned long long)plane->operations, 100 * plane->operations_a_pixel / all,
            both, 100 * both / all, 100 * plane->filled, report->seconds);
}

/* --- running --------------------------------------------------------------------------------------------------------
 */

static hewn_result evaluate(const eval_request *request, const hewn_scene *scene, const hewn_progress *progress,
                            hewn_error *error)
{
    const hewn_field *field = hewn_scene_field(scene);
    grid_report report = {0};
    hewn_rows rows;
    hewn_number_lines *lines = NULL;
    computing on;
    hewn_signals_end_at_once(true, NULL);
    if (request->grid[0])
        HEWN_TRY(choose_box(request, scene, &report.box, error));
    if (request->points)
        HEWN_TRY(hewn_number_lines_open(request->points, 3, "a point is three numbers, x y z", &lines, error));
    hewn_result result = begin_computing(request, field, &on, error);
    hewn_signals_end_at_once(false, NULL);
    if (result == HEWN_OK)
        result = hewn_rows_open(request->output, &rows, error);
    if (result == HEWN_OK) {
        hewn_signals_end_at_once(true, hewn_output_temporary(rows.output));
        if (on.evaluator && request->grid[0])
            result = eval_grid_on_device(request, &on, progress, &rows, &report, error);
        else if (request->grid[0])
            result = eval_grid(request, field, progress, &rows, &report, error);
        else if (request->points)
            result = eval_lines(request, &on, lines, &rows, error);
        else
            result = eval_given(request, &on, &rows, error);
        result = end_computing(&on, result, error);
        hewn_signals_end_at_once(false, NULL);
        result = hewn_rows_close(&rows, result, error);
    } else {
        end_computing(&on, result, error);
    }
    hewn_number_lines_close(&lines);
    if (result == HEWN_OK && request->report)
        result = write_report(request, &report, error);
    hewn_progress_end();
    if (result == HEWN_OK && request->grid[0] && !request->quiet)
        print_summary(&report);
    return result;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    eval_request request = {0};
    hewn_error error = {0};
    hewn_scene *scene = NULL;
    hewn_result result = read_request(arguments, &request, &error);
    if (result == HEWN_OK)
        result = hewn_output_check(request.output ? request.output : "-", &error);
    if (result == HEWN_OK && request.report)
        result = hewn_output_check(request.report, &error);
    if (result == HEWN_OK)
        result =
            hewn_blame_input(hewn_scene_load(&request.scene.desc, &scene, &error), request.scene.desc.path, &error);
    if (result == HEWN_OK) {
        hewn_signals_catch();
        hewn_progress progress = hewn_progress_begin(request.quiet);
        result = evaluate(&request, scene, &progress, &error);
        hewn_progress_end();
    }
    if (result == HEWN_BAD_INPUT && !error.file[0])
        snprintf(error.file, sizeof error.file, "%s", request.scene.desc.path);
    hewn_scene_destroy(&scene);
    hewn_scene_arguments_destroy(&request.scene);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}

const hewn_command hewn_command_eval = {
    .name = "eval",
    .summary = "print a field's values at points or on a grid",
    .usage = "SCENE (--points FILE | --at X,Y,Z | --grid SIZE) [OPTION]...",
    .about = "Prints the value of a scene's field (.lua, .vm) at points, a line each in their\n"
             "order: for shapes the distance from the surface, below 0 inside (docs/scene.md\n"
             "tells how exact). At points values are computed in double precision, on grids\n"
             "in single, by as few operations as bounds leave; with --device in single.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  echo 0 0 0 | hewn eval assets/scenes/csg.lua --points - --gradient\n"
             "  hewn eval assets/scenes/bracket.lua --at 10,0,0 --at 0,10,0\n"
             "  hewn eval prospero.vm --grid 1024x1024 --inside --report - -o /dev/null\n",
    .run = run,
};
