#include "hewn/render_job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "mesh/corner_colors.h"
#include "pipeline/domain.h"
#include "pipeline/opening.h"
#include "pipeline/paths.h"

/* A job under way. */
typedef struct render_job {
    const hewn_render_job_desc *desc;
    hewn_render_report *report;
    hewn_mesh_format mesh; /* of the input; HEWN_MESH_UNKNOWN: it is a scene */
    hewn_axis up;
    hewn_scene *scene;
    hewn_triangles triangles;
    float *colors; /* of their corners; NULL: none */
    hewn_opening opening;
    bool opened;
    hewn_renderer *renderer;
    hewn_picture picture;
} render_job;

static bool on_host(const render_job *job)
{
    const char *device = job->desc->device;
    return job->mesh != HEWN_MESH_UNKNOWN || job->desc->plane || (device && strcmp(device, "host") == 0);
}

static hewn_result check(render_job *job, hewn_error *error)
{
    const hewn_render_job_desc *desc = job->desc;
    if (!desc->scene.path || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    job->mesh = desc->mesh != HEWN_MESH_UNKNOWN || desc->scene.format != HEWN_SCENE_BY_NAME
                    ? desc->mesh
                    : hewn_mesh_format_of(desc->scene.path);
    if (job->mesh != HEWN_MESH_UNKNOWN && desc->plane)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a mesh has no field to show a plane of");
    if (job->mesh != HEWN_MESH_UNKNOWN && desc->bounds)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a mesh is shown whole, without bounds");
    if (desc->bounds)
        HEWN_TRY(hewn_domain_check(desc->bounds, error));
    return hewn_output_check(desc->output, error);
}

/* --- input ----------------------------------------------------------------------------------------------------------
 */

static hewn_result load_mesh(render_job *job, hewn_error *error)
{
    const hewn_read_desc read = {.format = job->mesh, .progress = job->desc->progress, .base_colors = true};
    hewn_model model = {0};
    HEWN_TRY(hewn_model_read(job->desc->scene.path, &read, &model, error));
    if (!job->desc->up && model.up_known)
        job->up = model.up;
    bool linear = job->mesh == HEWN_MESH_GLB || job->mesh == HEWN_MESH_GLTF; /* elsewhere as on a screen */
    hewn_result result = hewn_triangles_from_model(&model, &job->triangles, error);
    if (result == HEWN_OK)
        result = hewn_corner_colors_of_model(&model, linear, &job->colors, error);
    hewn_model_destroy(&model);
    return result;
}

static hewn_result load(render_job *job, hewn_error *error)
{
    job->up = job->desc->up ? *job->desc->up : HEWN_AXIS_PLUS_Z;
    if (job->mesh != HEWN_MESH_UNKNOWN)
        return load_mesh(job, error);
    HEWN_TRY(hewn_scene_load(&job->desc->scene, &job->scene, error));
    if (!job->desc->up)
        job->up = hewn_scene_up(job->scene);
    return HEWN_OK;
}

/* --- a plane --------------------------------------------------------------------------------------------------------
 */

static bool ends_with(const char *text, const char *end)
{
    size_t length = strlen(text), tail = strlen(end);
    return length >= tail && strcmp(text + length - tail, end) == 0;
}

static hewn_result choose_plane(const render_job *job, hewn_plane_desc *plane, hewn_error *error)
{
    const hewn_render_job_desc *desc = job->desc;
    hewn_box box = {{-1, -1, 0}, {1, 1, 0}};
    bool vm = desc->scene.format == HEWN_SCENE_VM || ends_with(desc->scene.path, ".vm");
    if (desc->bounds)
        box = *desc->bounds;
    else if (!hewn_scene_bounds(job->scene, &box) && !vm)
        return hewn_fail(error, HEWN_BAD_INPUT, "the scene has no bounds: set them there, or use --bounds x0,y0,x1,y1");
    /* Pixels are square: the picture shows more of the shorter side. */
    double width = box.hi[0] - box.lo[0], height = box.hi[1] - box.lo[1];
    double pixel = fmax(width / plane->width, height / plane->height);
    const double more[2] = {0.5 * (pixel * plane->width - width), 0.5 * (pixel * plane->height - height)};
    for (int axis = 0; axis < 2; axis++) {
        plane->lo[axis] = box.lo[axis] - more[axis];
        plane->hi[axis] = box.hi[axis] + more[axis];
    }
    plane->z = desc->bounds ? box.lo[2] : 0;
    return HEWN_OK;
}

static hewn_result render_plane(render_job *job, hewn_error *error)
{
    hewn_plane_desc plane = {.width = job->report->width,
                             .height = job->report->height,
                             .values = job->desc->render.method == HEWN_RENDER_DEPTH,
                             .progress = job->desc->progress};
    const hewn_field *field = hewn_scene_field(job->scene);
    HEWN_TRY(choose_plane(job, &plane, error));
    double began = hewn_clock_now();
    HEWN_TRY(hewn_render_plane(field, hewn_field_root(field), &plane, &job->picture, &job->report->plane, error));
    job->report->stats.trace_seconds = hewn_clock_now() - began;
    return HEWN_OK;
}

/* --- the surface ----------------------------------------------------------------------------------------------------
 */

static hewn_result create_renderer(render_job *job, hewn_error *error)
{
    const hewn_render_job_desc *desc = job->desc;
    if (job->mesh != HEWN_MESH_UNKNOWN)
        return hewn_renderer_of_triangles(&job->triangles, &job->renderer, error);
    enum { FINE = 256 }; /* cells, of which the box gets a margin of two */
    const hewn_mesh_job_desc like = {.bounds = desc->bounds, .resolution = FINE};
    hewn_bounds_source source;
    hewn_box box;
    hewn_device *device = NULL;
    HEWN_TRY(hewn_domain_choose(&like, job->scene, &box, &source, error));
    if (job->opened)
        HEWN_TRY(hewn_opening_wait(&job->opening, &device, error));
    const hewn_field *field = hewn_scene_field(job->scene);
    return hewn_renderer_of_field(device, field, hewn_field_root(field), &box, &job->renderer, error);
}

static hewn_camera choose_camera(const render_job *job)
{
    const hewn_box box = hewn_renderer_box(job->renderer);
    hewn_camera camera = hewn_camera_of_view(job->desc->view, &box, job->up, job->report->width, job->report->height);
    if (!job->desc->camera)
        return camera;
    hewn_camera given = *job->desc->camera;
    if (given.up[0] == 0 && given.up[1] == 0 && given.up[2] == 0)
        given.up[job->up == HEWN_AXIS_PLUS_X ? 0 : job->up == HEWN_AXIS_PLUS_Y ? 1 : 2] = 1;
    return given;
}

static hewn_result render_surface(render_job *job, hewn_error *error)
{
    hewn_render_desc render = job->desc->render;
    HEWN_TRY(create_renderer(job, error));
    render.camera = choose_camera(job);
    render.up = job->up;
    render.width = job->report->width;
    render.height = job->report->height;
    render.progress = job->desc->progress;
    render.corner_colors = job->colors;
    if (job->scene) {
        render.painted = hewn_scene_field(job->scene);
        render.painted_root = hewn_field_root(render.painted);
    }
    HEWN_TRY(hewn_render(job->renderer, &render, &job->picture, &job->report->stats, error));
    job->report->lo = job->picture.lo;
    job->report->hi = job->picture.hi;
    return HEWN_OK;
}

/* --- the whole ------------------------------------------------------------------------------------------------------
 */

static hewn_result run(render_job *job, hewn_error *error)
{
    const hewn_render_job_desc *desc = job->desc;
    HEWN_TRY(check(job, error));
    job->report->width = desc->render.width ? desc->render.width : desc->plane ? 1024 : 1280;
    job->report->height = desc->render.height ? desc->render.height : desc->plane ? 1024 : 720;
    if (!on_host(job)) {
        hewn_opening_begin(&job->opening, desc->device, desc->validation);
        job->opened = true;
    }
    hewn_result result = load(job, error);
    if (result == HEWN_OK)
        result = desc->plane ? render_plane(job, error) : render_surface(job, error);
    if (result == HEWN_BAD_INPUT || (result == HEWN_IO && job->picture.values == NULL))
        return hewn_blame_input(result, desc->scene.path, error);
    HEWN_TRY(result);
    if (job->opened && job->opening.device)
        snprintf(job->report->where, sizeof job->report->where, "%s", hewn_device_get_info(job->opening.device)->name);
    if (!job->opened || job->report->stats.on_host)
        snprintf(job->report->where, sizeof job->report->where, "the host");
    HEWN_TRY(hewn_progress_report(desc->progress, "write", 0, error));
    return hewn_picture_write(&job->picture, desc->output, error);
}

hewn_result hewn_render_file(const hewn_render_job_desc *desc, hewn_render_report *out, hewn_error *error)
{
    *out = (hewn_render_report){0};
    render_job job = {.desc = desc, .report = out};
    double began = desc->began > 0 ? desc->began : hewn_clock_now();
    hewn_result result = run(&job, error);
    hewn_renderer_destroy(&job.renderer);
    if (job.opened) {
        hewn_opening_close(&job.opening);
        out->validation_messages = atomic_load(&job.opening.messages);
    }
    hewn_triangles_destroy(&job.triangles);
    hewn_free(job.colors);
    hewn_scene_destroy(&job.scene);
    hewn_picture_destroy(&job.picture);
    out->seconds = hewn_clock_now() - began;
    if (result != HEWN_OK)
        *out = (hewn_render_report){0};
    return result;
}
