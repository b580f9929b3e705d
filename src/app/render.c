#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/number.h"
#include "app/path_arguments.h"
#include "app/scene_arguments.h"
#include "app/sweep.h"
#include "app/validation.h"
#include "base/alloc.h"
#include "base/error.h"

typedef struct render_request {
    hewn_scene_arguments scene;
    hewn_render_job_desc desc;
    hewn_camera camera;
    hewn_box bounds;
    hewn_axis up;
    hewn_sweep sweep;
    bool quiet;
} render_request;

static const hewn_option options[] = {
    {'o', "output", "FILE", "Write the picture to FILE as PNG; `-` is standard output. Required."},
    {0, "size", "WxH", "Width and height in pixels. Default: 1280x720, with --2d 1024x1024."},
    {0, "view", "NAME", "Look from iso, front, back, left, right, top or bottom, so that all is seen. Default: iso."},
    {0, "camera", "EYE:TARGET[:UP][/FOV]",
     "Look from EYE to TARGET (each x,y,z), UP being upward in the picture (default: the scene's), with FOV degrees "
     "from the bottom to the top of the picture (default: 30)."},
    {0, "method", "NAME",
     "trace: lit, with soft shadows, ambient occlusion and a ground. depth: 16-bit grey, the distance from the "
     "camera's plane between the text chunks lo and hi, white where nothing is. normals: x, y and z as red, green and "
     "blue. Default: trace."},
    {0, "samples", "N", "Samples of a pixel where the picture changes, 1 to 64. Default: 4."},
    {0, "no-ground", NULL, "Show the shape alone, without a ground and its shadow there."},
    {0, "2d", NULL,
     "Fill the plane z = 0: white where the field is below 0, black elsewhere; with --method depth its values as "
     "16-bit grey."},
    {0, "bounds", "BOX",
     "The part of space to show, x0,y0,z0,x1,y1,z1 in scene units; with --2d x0,y0,x1,y1 or, for the plane at z, "
     "x0,y0,z,x1,y1,z. Default: the scene's own, or found from its field."},
    {'D', NULL, "NAME=VALUE", "Set a parameter of the scene. May be repeated."},
    HEWN_OPTION_SWEEP,
    {0, "from", "FORMAT",
     "Read the file as lua or vm, or as a mesh in glb, gltf, obj, ply, stl or off. Default: by its "
     "extension; needed where it is `-`."},
    {0, "up", "AXIS", "This axis is up: +X, +Y or +Z. Default: what the file says, +Z for a mesh that does not."},
    {0, "allow-path", NULL, "Let the scene read files outside its own folder."},
    {0, "device", "DEVICE",
     "Use the device of this index, or whose name contains this; `host` follows rays by the host's processors. "
     "Default: HEWN_DEVICE, else the best. Meshes and planes need none."},
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

/* --- the command line -----------------------------------------------------------------------------------------------
 */

static hewn_result read_camera(const char *text, render_request *request, hewn_error *error)
{
    hewn_camera *camera = &request->camera;
    const char *rest = text;
    char number[64];
    camera->fov = 30;
    HEWN_TRY(hewn_triple_parse(&rest, "--camera", camera->eye, error));
    if (*rest != ':')
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--camera is EYE:TARGET[:UP][/FOV], not '%s'", text);
    rest++;
    HEWN_TRY(hewn_triple_parse(&rest, "--camera", camera->target, error));
    if (*rest == ':') {
        rest++;
        HEWN_TRY(hewn_triple_parse(&rest, "--camera", camera->up, error));
    }
    if (*rest == '/') {
        snprintf(number, sizeof number, "%s", rest + 1);
        HEWN_TRY(hewn_number_parse(number, "--camera's FOV", &camera->fov, error));
        if (!(camera->fov > 0 && camera->fov < 180))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--camera's FOV is more than 0 and less than 180 degrees");
        rest = "";
    }
    if (*rest)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--camera is EYE:TARGET[:UP][/FOV], not '%s'", text);
    request->desc.camera = camera;
    return HEWN_OK;
}

static hewn_result read_look(const hewn_arguments *arguments, render_request *request, hewn_error *error)
{
    const char *size = hewn_arguments_value(arguments, "size"), *view = hewn_arguments_value(arguments, "view");
    const char *camera = hewn_arguments_value(arguments, "camera"), *up = hewn_arguments_value(arguments, "up");
    const char *method = hewn_arguments_value(arguments, "method"),
               *samples = hewn_arguments_value(arguments, "samples");
    hewn_render_desc *render = &request->desc.render;
    if (size)
        HEWN_TRY(hewn_size_parse(size, "--size", &render->width, &render->height, error));
    if (view && camera)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--view and --camera exclude each other");
    if (view && !hewn_view_named(view, &request->desc.view))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--view is iso, front, back, left, right, top or bottom, not '%s'", view);
    if (camera)
        HEWN_TRY(read_camera(camera, request, error));
    if (up) {
        if (!hewn_axis_find(up, &request->up))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--up is +X, +Y or +Z, not '%s'", up);
        request->desc.up = &request->up;
    }
    if (method && strcmp(method, "depth") == 0)
        render->method = HEWN_RENDER_DEPTH;
    else if (method && strcmp(method, "normals") == 0)
        render->method = HEWN_RENDER_NORMALS;
    else if (method && strcmp(method, "trace") != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--method is trace, depth or normals, not '%s'", method);
    if (samples)
        HEWN_TRY(hewn_count_parse(samples, "--samples", 1, &render->samples, error));
    if (render->samples > 64)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--samples is at most 64, not %s", samples);
    render->no_ground = hewn_arguments_has(arguments, "no-ground");
    return HEWN_OK;
}

static hewn_result read_part(const hewn_arguments *arguments, render_request *request, hewn_error *error)
{
    const char *bounds = hewn_arguments_value(arguments, "bounds");
    request->desc.plane = hewn_arguments_has(arguments, "2d");
    if (request->desc.plane && (request->desc.camera || hewn_arguments_has(arguments, "view")))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--2d shows a plane as it is, without a camera");
    if (request->desc.plane && request->desc.render.method == HEWN_RENDER_NORMALS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--2d has no normals");
    if (!bounds)
        return HEWN_OK;
    request->desc.bounds = &request->bounds;
    if (request->desc.plane)
        return hewn_plane_bounds_parse(bounds, "--bounds", &request->bounds, error);
    return hewn_bounds_parse(bounds, "--bounds", &request->bounds, error);
}

static hewn_result read_input(const hewn_arguments *arguments, render_request *request, hewn_error *error)
{
    HEWN_TRY(hewn_scene_arguments_read_mesh_too(arguments, &request->scene, &request->desc.mesh, error));
    request->desc.scene = request->scene.desc;
    request->desc.device = hewn_arguments_value(arguments, "device");
    request->desc.validation = hewn_validation_wanted();
    request->quiet = hewn_arguments_has(arguments, "quiet");
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, render_request *request, hewn_error *error)
{
    HEWN_TRY(read_input(arguments, request, error));
    HEWN_TRY(read_look(arguments, request, error));
    HEWN_TRY(read_part(arguments, request, error));
    HEWN_TRY(hewn_output_argument_read(arguments, "picture", "FILE", &request->desc.output, error));
    HEWN_TRY(hewn_sweep_read(arguments, &request->scene, &request->sweep, error));
    bool mesh =
        request->desc.mesh != HEWN_MESH_UNKNOWN ||
        (!hewn_arguments_has(arguments, "from") && hewn_mesh_format_of(request->scene.desc.path) != HEWN_MESH_UNKNOWN);
    if (request->sweep.count > 0 && mesh)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep sets a parameter of a scene; a mesh has none");
    if (request->sweep.count > 0 && strcmp(request->desc.output, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--sweep needs files, not standard output");
    return hewn_output_spare_terminal(request->desc.output, "PNG", error);
}

/* --- running --------------------------------------------------------------------------------------------------------
 */

static void print_summary(const render_request *request, const hewn_render_report *report)
{
    const char *output = request->desc.output;
    fprintf(stderr, "%s: %u x %u pixels", strcmp(output, "-") == 0 ? "standard output" : output, report->width,
            report->height);
    if (request->desc.plane) {
        const hewn_plane_stats *plane = &report->plane;
        double all = (double)plane->operations;
        fprintf(stderr,
                "; %.1f of %llu operations a pixel (%.2f %%), with those of bounds %.1f (%.2f %%); bounds filled %.0f "
                "%%\n  %.3f s, of which %.3f s evaluating\n",
                plane->operations_a_pixel, (unsigned long long)plane->operations, 100 * plane->operations_a_pixel / all,
                plane->operations_a_pixel + plane->bounds_a_pixel,
                100 * (plane->operations_a_pixel + plane->bounds_a_pixel) / all, 100 * plane->filled, report->seconds,
                report->stats.trace_seconds);
        return;
    }
    const hewn_render_stats *stats = &report->stats;
    if (request->desc.render.method == HEWN_RENDER_DEPTH)
        fprintf(stderr, "; depths from %.6g to %.6g", report->lo, report->hi);
    fprintf(stderr, "; %llu rays, %.2f s on %s: %.2f preparing, %.2f tracing, %.2f shading\n",
            (unsigned long long)stats->rays, report->seconds, report->where, stats->prepare_seconds,
            stats->trace_seconds, stats->shade_seconds);
    if (stats->ran_out > 0)
        fprintf(stderr,
                "hewn: note: %llu rays took too many steps and count as hits where they stood; the field has no good "
                "bounds there\n",
                (unsigned long long)stats->ran_out);
}

static hewn_result render_once(const render_request *request, double began, hewn_error *error)
{
    hewn_render_report report = {0};
    hewn_render_job_desc desc = request->desc;
    hewn_progress progress = hewn_progress_begin(request->quiet);
    desc.progress = &progress;
    desc.began = began;
    hewn_result result = hewn_render_file(&desc, &report, error);
    hewn_progress_end();
    if (result == HEWN_OK && !request->quiet)
        print_summary(request, &report);
    if (result == HEWN_OK && report.validation_messages > 0)
        result = hewn_fail(error, HEWN_DEVICE_LOST, "the validation layer gave %llu messages",
                           (unsigned long long)report.validation_messages);
    return result;
}

static hewn_result render_sweep(render_request *request, hewn_error *error)
{
    hewn_sweep *sweep = &request->sweep;
    const char *output = request->desc.output;
    hewn_result result = HEWN_OK;
    for (uint32_t step = 0; result == HEWN_OK && step < sweep->count; step++) {
        char *picture = hewn_sweep_path(sweep, output, step);
        hewn_sweep_set(sweep, step, &request->desc.scene);
        request->desc.output = picture;
        result = picture ? render_once(request, step == 0 ? hewn_started() : 0, error)
                         : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory");
        hewn_free(picture);
        result = hewn_sweep_blame(sweep, step, result, error);
    }
    return result;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    render_request request = {0};
    hewn_error error = {0};
    hewn_result result = read_request(arguments, &request, &error);
    if (result == HEWN_OK) {
        hewn_signals_catch();
        hewn_signals_end_at_once(true, NULL);
        result =
            request.sweep.count > 0 ? render_sweep(&request, &error) : render_once(&request, hewn_started(), &error);
    }
    hewn_sweep_destroy(&request.sweep);
    hewn_scene_arguments_destroy(&request.scene);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}

const hewn_command hewn_command_render = {
    .name = "render",
    .summary = "make a picture of a scene or a mesh",
    .usage = "SCENE|MESH -o FILE.png [OPTION]...",
    .about = "Follows rays to the surface of a scene's field (.lua, .vm), or of a mesh (.glb,\n"
             ".gltf, .obj, .ply, .stl, .off), and lights it. Nothing of a field is meshed, and\n"
             "no surface is stepped over, however steep the field is.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn render assets/scenes/bracket.lua -o bracket.png\n"
             "  hewn render bracket.glb -o bracket.png --view front --size 800x600\n"
             "  hewn render prospero.vm --2d --size 1024x1024 -o prospero.png\n"
             "  hewn render assets/scenes/csg.lua --camera 3,-4,2:0,0,0/35 -o csg.png\n",
    .run = run,
};
