#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/number.h"
#include "app/number_lines.h"
#include "app/rows.h"
#include "app/scene_arguments.h"
#include "app/validation.h"
#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/domain.h"
#include "pipeline/paths.h"

enum { BATCH = 1 << 14 };

typedef struct query_request {
    hewn_scene_arguments scene;
    const char *points, *rays, *other, *output, *device;
    hewn_box bounds;
    bool bounded, quiet;
    double radius;
    hewn_query_desc desc;
} query_request;

static const hewn_option options[] = {
    {0, "nearest", "FILE",
     "Find the point of the surface nearest to each point of FILE, one a line: x y z; `-` is standard input."},
    {0, "rays", "FILE",
     "Find where each ray of FILE first enters the solid, one a line: x y z dx dy dz; `-` is standard input."},
    {0, "radius", "R", "With --rays: move balls of this radius along them, until they touch the surface."},
    {0, "clearance", "B", "Find how far the solid is from that of another scene, and where they are nearest."},
    {0, "tolerance", "T",
     "How far LOW and HIGH may be apart, in scene units. Default: 1e-4 of the box's diagonal, of clearances 1e-3."},
    {'o', "output", "FILE", "Write to FILE, which appears when it is complete. Default: `-`, standard output."},
    {0, "bounds", "BOX",
     "Look in this box, x0,y0,z0,x1,y1,z1 in scene units. Default: the scene's own, or found from its field. With "
     "--clearance of both scenes."},
    {'D', NULL, "NAME=VALUE", "Set a parameter of the scene (not of the other). May be repeated."},
    {0, "from", "FORMAT", "Read the scene as lua or vm. Default: by its extension; needed where it is `-`."},
    {0, "allow-path", NULL, "Let scenes read files outside their own folders."},
    {0, "device", "DEVICE",
     "Let the device of this index, or whose name contains this, answer, many questions at once. Default: `host`, "
     "the host's processors; --clearance is always theirs."},
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

/* --- the command line -----------------------------------------------------------------------------------------------
 */

static hewn_result check_request(const query_request *request, bool radius, hewn_error *error)
{
    int ways = (request->points != NULL) + (request->rays != NULL) + (request->other != NULL);
    const char *lines = request->points ? request->points : request->rays;
    if (ways != 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         ways ? "--nearest, --rays and --clearance exclude each other"
                              : "what is the question? Give --nearest FILE, --rays FILE or --clearance SCENE");
    if (radius && !request->rays)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--radius goes with --rays");
    if (!(request->radius >= 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--radius is 0 or more, not %g", request->radius);
    if (request->other && request->device)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--clearance is found by the host, without --device");
    if (lines && strcmp(lines, "-") == 0 && strcmp(request->scene.desc.path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the scene and the lines cannot both come from standard input");
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, query_request *request, hewn_error *error)
{
    const char *tolerance = hewn_arguments_value(arguments, "tolerance"),
               *radius = hewn_arguments_value(arguments, "radius"), *bounds = hewn_arguments_value(arguments, "bounds");
    HEWN_TRY(hewn_scene_arguments_read(arguments, &request->scene, error));
    request->points = hewn_arguments_value(arguments, "nearest");
    request->rays = hewn_arguments_value(arguments, "rays");
    request->other = hewn_arguments_value(arguments, "clearance");
    request->output = hewn_arguments_value(arguments, "output");
    request->device = hewn_arguments_value(arguments, "device");
    request->quiet = hewn_arguments_has(arguments, "quiet");
    request->bounded = bounds != NULL;
    if (request->device && strcmp(request->device, "host") == 0)
        request->device = NULL;
    if (request->output && !request->output[0])
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
    if (tolerance)
        HEWN_TRY(hewn_number_parse(tolerance, "--tolerance", &request->desc.tolerance, error));
    if (tolerance && !(request->desc.tolerance > 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--tolerance is above 0, not %s", tolerance);
    if (radius)
        HEWN_TRY(hewn_number_parse(radius, "--radius", &request->radius, error));
    if (bounds)
        HEWN_TRY(hewn_bounds_parse(bounds, "--bounds", &request->bounds, error));
    return check_request(request, radius != NULL, error);
}

/* --- asking ---------------------------------------------------------------------------------------------------------
 */

static hewn_result open_query(const query_request *request, const hewn_scene *scene, hewn_device *device,
                              hewn_query **out, hewn_error *error)
{
    const hewn_mesh_job_desc like = {.bounds = request->bounded ? &request->bounds : NULL, .resolution = 256};
    const hewn_field *field = hewn_scene_field(scene);
    hewn_bounds_source source;
    hewn_box box;
    *out = NULL;
    HEWN_TRY(hewn_domain_choose(&like, scene, &box, &source, error));
    return hewn_query_create(device, field, hewn_field_root(field), &box, out, error);
}

static void print_triple(hewn_rows *rows, const double *v)
{
    for (int axis = 0; axis < 3; axis++)
        hewn_rows_number(rows, v[axis], true);
}

static void print_answer(hewn_rows *rows, const hewn_answer *answer)
{
    const char *state = !answer->found ? "nothing" : answer->inside ? "inside" : "outside";
    hewn_rows_word(rows, state);
    hewn_rows_word(rows, answer->complete ? "sure" : "rough");
    hewn_rows_number(rows, answer->low, true);
    hewn_rows_number(rows, answer->high, true);
    print_triple(rows, answer->point);
    print_triple(rows, answer->normal);
    hewn_rows_end(rows);
}

static hewn_result ask(const query_request *request, hewn_query *query, const double *rows, size_t count,
                       hewn_ray_desc *rays, hewn_answer *answers, hewn_error *error)
{
    if (request->points)
        return hewn_query_nearest(query, rows, count, &request->desc, answers, error);
    for (size_t i = 0; i < count; i++) {
        rays[i] = (hewn_ray_desc){.radius = request->radius};
        memcpy(rays[i].from, rows + 6 * i, sizeof rays[i].from);
        memcpy(rays[i].along, rows + 6 * i + 3, sizeof rays[i].along);
    }
    return hewn_query_rays(query, rays, count, &request->desc, answers, error);
}

/* Directions of length 0 and points too far out are refused where they stand, before anything is asked. */
static hewn_result check_rows(const query_request *request, const hewn_number_lines *lines, const double *rows,
                              size_t count, hewn_error *error)
{
    for (size_t i = 0; i < count; i++) {
        const double *row = rows + i * (request->rays ? 6 : 3);
        const double *d = row + 3;
        if (fmax(fmax(fabs(row[0]), fabs(row[1])), fabs(row[2])) > HEWN_QUERY_FAR)
            return hewn_number_lines_refuse(lines, i, "a point is more than 2^30 away", error);
        if (request->rays && d[0] == 0 && d[1] == 0 && d[2] == 0)
            return hewn_number_lines_refuse(lines, i, "a ray has no direction", error);
    }
    return HEWN_OK;
}

static hewn_result ask_all(const query_request *request, hewn_query *query, hewn_number_lines *lines, hewn_rows *out,
                           hewn_error *error)
{
    double *rows = hewn_alloc(BATCH, 6 * sizeof *rows);
    hewn_ray_desc *rays = hewn_alloc(BATCH, sizeof *rays);
    hewn_answer *answers = hewn_alloc(BATCH, sizeof *answers);
    hewn_result result =
        rows && rays && answers ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for questions");
    size_t count = BATCH;
    hewn_rows_word(out, "# state sure low high x y z nx ny nz");
    hewn_rows_end(out);
    while (result == HEWN_OK && count == BATCH) {
        result = hewn_number_lines_read(lines, rows, BATCH, &count, error);
        if (result == HEWN_OK)
            result = check_rows(request, lines, rows, count, error);
        if (result == HEWN_OK)
            result = ask(request, query, rows, count, rays, answers, error);
        for (size_t i = 0; result == HEWN_OK && i < count; i++)
            print_answer(out, &answers[i]);
        if (result == HEWN_OK)
            result = hewn_rows_flush(out, error);
    }
    hewn_free(rows);
    hewn_free(rays);
    hewn_free(answers);
    return result;
}

/* Everything that takes its time and writes nothing is done: the file is opened. */
static hewn_result open_rows(const query_request *request, hewn_rows *rows, hewn_error *error)
{
    hewn_signals_end_at_once(false, NULL);
    return hewn_rows_open(request->output, rows, error);
}

static hewn_result ask_lines(const query_request *request, const hewn_scene *scene, hewn_error *error)
{
    hewn_rows rows;
    hewn_device *device = NULL;
    hewn_query *query = NULL;
    hewn_number_lines *lines = NULL;
    const hewn_device_desc desc = {.choice = request->device, .validation = hewn_validation_wanted()};
    bool points = request->points != NULL;
    hewn_result result = hewn_number_lines_open(
        points ? request->points : request->rays, points ? 3 : 6,
        points ? "a point is three numbers, x y z" : "a ray is six numbers, x y z dx dy dz", &lines, error);
    if (result == HEWN_OK && request->device)
        result = hewn_device_create(&desc, &device, error);
    if (result == HEWN_OK)
        result = open_query(request, scene, device, &query, error);
    if (result == HEWN_OK)
        result = open_rows(request, &rows, error);
    if (result == HEWN_OK) {
        hewn_signals_end_at_once(true, hewn_output_temporary(rows.output));
        result = ask_all(request, query, lines, &rows, error);
        hewn_signals_end_at_once(false, NULL);
        if (result == HEWN_OK && device && hewn_device_message_count(device) > 0)
            result = hewn_fail(error, HEWN_DEVICE_LOST, "the validation layer gave messages");
        result = hewn_rows_close(&rows, result, error);
    }
    hewn_query_destroy(&query);
    hewn_device_destroy(&device);
    hewn_number_lines_close(&lines);
    return result;
}

static hewn_result measure(const query_request *request, const hewn_scene *scenes[2], hewn_clearance *out,
                           hewn_error *error)
{
    hewn_query *queries[2] = {NULL, NULL};
    hewn_result result = open_query(request, scenes[0], NULL, &queries[0], error);
    if (result == HEWN_OK) {
        result = open_query(request, scenes[1], NULL, &queries[1], error);
        if (result == HEWN_BAD_INPUT && error && !error->file[0])
            snprintf(error->file, sizeof error->file, "%s", request->other);
    }
    if (result == HEWN_OK)
        result = hewn_query_clearance(queries[0], queries[1], &request->desc, out, error);
    hewn_query_destroy(&queries[0]);
    hewn_query_destroy(&queries[1]);
    return result;
}

static hewn_result ask_clearance(const query_request *request, const hewn_scene *scene, hewn_error *error)
{
    hewn_rows own, *rows = &own;
    const hewn_scene_desc desc = {.path = request->other, .allow_path = request->scene.desc.allow_path};
    hewn_scene *other;
    hewn_clearance found;
    HEWN_TRY(hewn_blame_input(hewn_scene_load(&desc, &other, error), desc.path, error));
    hewn_result result = HEWN_OK;
    if (fabs(hewn_scene_metres_per_unit(other) / hewn_scene_metres_per_unit(scene) - 1) > 1e-9)
        result = hewn_fail_at(error, HEWN_BAD_INPUT, request->other, 0, "it is in another unit than the first scene");
    if (result == HEWN_OK)
        result = measure(request, (const hewn_scene *[2]){scene, other}, &found, error);
    hewn_scene_destroy(&other);
    HEWN_TRY(result);
    HEWN_TRY(open_rows(request, rows, error));
    hewn_rows_word(rows, "# state sure low high ax ay az bx by bz");
    hewn_rows_end(rows);
    hewn_rows_word(rows, !found.found ? "nothing" : found.overlap ? "overlap" : "apart");
    hewn_rows_word(rows, found.complete ? "sure" : "rough");
    hewn_rows_number(rows, found.low, true);
    hewn_rows_number(rows, found.high, true);
    print_triple(rows, found.points[0]);
    print_triple(rows, found.points[1]);
    hewn_rows_end(rows);
    return hewn_rows_close(rows, HEWN_OK, error);
}

/* --- running --------------------------------------------------------------------------------------------------------
 */

static hewn_result answer(query_request *request, const hewn_scene *scene, hewn_error *error)
{
    hewn_signals_catch();
    hewn_signals_end_at_once(true, NULL);
    hewn_progress progress = hewn_progress_begin(request->quiet);
    request->desc.progress = &progress;
    hewn_result result = request->other ? ask_clearance(request, scene, error) : ask_lines(request, scene, error);
    hewn_progress_end();
    request->desc.progress = NULL;
    return result;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    query_request request = {0};
    hewn_error error = {0};
    hewn_scene *scene = NULL;
    hewn_result result = read_request(arguments, &request, &error);
    if (result == HEWN_OK)
        result = hewn_output_check(request.output ? request.output : "-", &error);
    if (result == HEWN_OK)
        result =
            hewn_blame_input(hewn_scene_load(&request.scene.desc, &scene, &error), request.scene.desc.path, &error);
    if (result == HEWN_OK)
        result = answer(&request, scene, &error);
    if (result == HEWN_BAD_INPUT && !error.file[0])
        snprintf(error.file, sizeof error.file, "%s", request.scene.desc.path);
    hewn_scene_destroy(&scene);
    hewn_scene_arguments_destroy(&request.scene);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}

const hewn_command hewn_command_query = {
    .name = "query",
    .summary = "find nearest points, what rays and balls meet, and clearances",
    .usage = "SCENE --nearest FILE | --rays FILE | --clearance B [OPTION]...",
    .about = "Asks where the surface of a scene's field (.lua, .vm) is. Each answer is a line:\n"
             "outside, inside or nothing (of clearances apart, overlap or nothing), sure where\n"
             "LOW and HIGH are as near as asked for, else rough; the two lengths between which\n"
             "the true one lies; where HIGH was found, and the normal there. Fields need not\n"
             "be distances: bounds prove that nothing is nearer than LOW.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  echo 30 0 0 | hewn query assets/scenes/csg.lua --nearest -\n"
             "  echo 0 0 50 0 0 -1 | hewn query assets/scenes/bracket.lua --rays - --radius 2\n"
             "  hewn query bolt.lua --clearance plate.lua --tolerance 0.001\n",
    .run = run,
};
