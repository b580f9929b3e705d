#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "render/light.h"

enum { TILE = 32, BATCH = 1 << 17, MOST_SAMPLES = 64, USUAL_SAMPLES = 4 };

struct hewn_renderer {
    hewn_tracer tracer;
    hewn_box box;
    bool of_triangles;
    double prepare_seconds;
};

/* A picture under way. */
typedef struct rendering {
    hewn_renderer *renderer;
    const hewn_render_desc *desc;
    hewn_lens lens;
    hewn_stage stage;
    hewn_picture *picture;
    hewn_render_stats *stats;
    uint32_t samples;
    float surface[3];
    hewn_met *first; /* what each pixel's middle met; only where more samples may be wanted */
    struct batch {
        hewn_ray *rays;
        hewn_met *met;
        uint32_t *pixels;
        double *points; /* of the surface, and its colours there; only where it is painted */
        float *colours;
        size_t count;
    } batch;
    uint64_t done, wanted; /* pixels */
} rendering;

/* --- renderers ------------------------------------------------------------------------------------------------------
 */

static hewn_result check_box(const hewn_box *box, hewn_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!(box->lo[i] < box->hi[i]) || !isfinite(box->lo[i]) || !isfinite(box->hi[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the box has no inside along %c (%g to %g)", "xyz"[i],
                             box -> lo[i], box -> hi[i]);
    return HEWN_OK;
}

static hewn_result create(hewn_renderer **out, hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    return *out ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a renderer");
}

hewn_result hewn_renderer_of_field(hewn_device *device, const hewn_field *field, hewn_node root, const hewn_box *box,
                                   hewn_renderer **out, hewn_error *error)
{
    *out = NULL;
    HEWN_TRY(check_box(box, error));
    double began = hewn_clock_now();
    HEWN_TRY(create(out, error));
    (*out)->box = *box;
    bool listed = true;
    hewn_result result = HEWN_OK;
    if (device)
        result = hewn_tracer_on_device(device, field, root, box, &(*out)->tracer, &listed, error);
    if (result == HEWN_OK && listed)
        result = hewn_tracer_on_host(field, root, box, &(*out)->tracer, error);
    if (result != HEWN_OK)
        hewn_renderer_destroy(out);
    else
        (*out)->prepare_seconds = hewn_clock_now() - began;
    return result;
}

hewn_result hewn_renderer_of_triangles(const hewn_triangles *triangles, hewn_renderer **out, hewn_error *error)
{
    *out = NULL;
    double began = hewn_clock_now();
    HEWN_TRY(create(out, error));
    (*out)->of_triangles = true;
    hewn_result result = hewn_tracer_of_triangles(triangles, &(*out)->tracer, &(*out)->box, error);
    if (result != HEWN_OK)
        hewn_renderer_destroy(out);
    else
        (*out)->prepare_seconds = hewn_clock_now() - began;
    return result;
}

void hewn_renderer_destroy(hewn_renderer **renderer)
{
    if (*renderer && (*renderer)->tracer.destroy)
        (*renderer)->tracer.destroy((*renderer)->tracer.self);
    hewn_free(*renderer);
    *renderer = NULL;
}

hewn_box hewn_renderer_box(const hewn_renderer *renderer)
{
    return renderer->box;
}

/* --- ground ---------------------------------------------------------------------------------------------------------
 */

/* The ground touches the lowest point that rays from below meet. */
static hewn_result find_ground(rendering *r, hewn_error *error)
{
    enum { SIDE = 96 };
    const hewn_box *box = &r->renderer->box;
    uint32_t up = r->stage.up, u = (up + 1) % 3, v = (up + 2) % 3;
    double length = box->hi[up] - box->lo[up], lowest = box->hi[up];
    hewn_stage plain = r->stage;
    plain.flags = 0;
    plain.corner_colors = NULL;
    plain.nearness = fmaxf(plain.nearness, (float)(1e-4 * length));
    plain.spread = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        hewn_ray *ray = &r->batch.rays[i];
        *ray = (hewn_ray){.end = (float)(4 * length), .along = {1e-12F, 1e-12F, 1e-12F}};
        ray->along[up] = 1;
        ray->from[up] = (float)(box->lo[up] - length);
        ray->from[u] = (float)(box->lo[u] + (box->hi[u] - box->lo[u]) * (i % SIDE + 0.5) / SIDE);
        ray->from[v] = (float)(box->lo[v] + (box->hi[v] - box->lo[v]) * (i / SIDE + 0.5) / SIDE);
    }
    hewn_tracer *tracer = &r->renderer->tracer;
    HEWN_TRY(tracer->trace(tracer->self, &plain, r->batch.rays, (size_t)SIDE * SIDE, r->batch.met, error));
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++)
        if (r->batch.met[i].what == HEWN_MET_SURFACE)
            lowest = fmin(lowest, box->lo[up] - length + (double)r->batch.met[i].t);
    r->stage.ground = (float)(lowest - 1e-4 * length);
    if (lowest < box->hi[up] && r->lens.eye[up] > lowest)
        r->stage.flags |= HEWN_TRACE_GROUND;
    return HEWN_OK;
}

/* --- pixels ---------------------------------------------------------------------------------------------------------
 */

/* What the surface is painted with at the batch's hits, one after another. */
static hewn_result find_colours(rendering *r, hewn_error *error)
{
    struct batch *batch = &r->batch;
    size_t count = 0;
    if (!batch->colours)
        return HEWN_OK;
    for (size_t i = 0; i < batch->count; i++) {
        const hewn_ray *ray = &batch->rays[i];
        if (batch->met[i].what != HEWN_MET_SURFACE)
            continue;
        if (!batch->points) { /* the tracer of triangles told them, a ray's at its place */
            memmove(batch->colours + 3 * count++, batch->colours + 3 * i, 3 * sizeof *batch->colours);
            continue;
        }
        for (int k = 0; k < 3; k++)
            batch->points[3 * count + (size_t)k] =
                (double)ray->from[k] + (double)batch->met[i].t * (double)ray->along[k];
        count++;
    }
    if (!batch->points)
        return HEWN_OK;
    return hewn_field_paint(r->desc->painted, r->desc->painted_root, batch->points, count, batch->colours, NULL, error);
}

static void take_pixel(rendering *r, const hewn_met *met, const float surface[3], uint32_t pixel, bool first)
{
    float *values = r->picture->values;
    uint32_t x = pixel % r->lens.width, y = pixel / r->lens.width;
    bool seen = met->what == HEWN_MET_SURFACE;
    if (r->desc->method == HEWN_RENDER_NORMALS) {
        for (int i = 0; i < 3; i++)
            values[3 * (size_t)pixel + (size_t)i] = seen ? met->normal[i] : 0;
    } else if (r->desc->method == HEWN_RENDER_DEPTH) {
        hewn_ray ray = hewn_lens_ray(&r->lens, x, y, 0);
        double facing = 0;
        for (int i = 0; i < 3; i++)
            facing += (double)ray.along[i] * r->lens.forward[i];
        values[pixel] = seen ? (float)((double)met->t * facing) : NAN;
    } else {
        float colour[3];
        hewn_met_colour(met, &r->stage, surface, colour);
        for (int i = 0; i < 3; i++)
            values[3 * (size_t)pixel + (size_t)i] = (first ? 0 : values[3 * (size_t)pixel + (size_t)i]) + colour[i];
        if (first && r->first)
            r->first[pixel] = *met;
    }
}

/* Follows the rays that were gathered. */
static hewn_result flush(rendering *r, bool first, hewn_error *error)
{
    struct batch *batch = &r->batch;
    hewn_tracer *tracer = &r->renderer->tracer;
    HEWN_TRY(hewn_progress_report(r->desc->progress, "render", (double)r->done / (double)r->wanted, error));
    double began = hewn_clock_now();
    HEWN_TRY(tracer->trace(tracer->self, &r->stage, batch->rays, batch->count, batch->met, error));
    double traced = hewn_clock_now();
    HEWN_TRY(find_colours(r, error));
    const float *colour = batch->colours;
    for (size_t i = 0; i < batch->count; i++) {
        bool hit = batch->met[i].what == HEWN_MET_SURFACE;
        take_pixel(r, &batch->met[i], hit && colour ? colour : r->surface, batch->pixels[i], first);
        colour += hit && colour ? 3 : 0;
        r->stats->hits += hit;
        r->stats->ran_out += batch->met[i].ran_out;
    }
    r->stats->rays += batch->count;
    r->done += batch->count;
    batch->count = 0;
    r->stats->trace_seconds += traced - began;
    r->stats->shade_seconds += hewn_clock_now() - traced;
    return HEWN_OK;
}

static hewn_result add_ray(rendering *r, uint32_t x, uint32_t y, uint32_t sample, hewn_error *error)
{
    struct batch *batch = &r->batch;
    batch->rays[batch->count] = hewn_lens_ray(&r->lens, x, y, sample);
    batch->pixels[batch->count++] = y * r->lens.width + x;
    return batch->count == BATCH ? flush(r, sample == 0, error) : HEWN_OK;
}

/* Whether something changes between two pixels. */
static bool differ(const rendering *r, size_t a, size_t b)
{
    const hewn_met *p = &r->first[a], *q = &r->first[b];
    if (p->what != q->what)
        return true;
    float apart = 0;
    for (int i = 0; i < 3; i++) {
        float shade = sqrtf(r->picture->values[3 * a + (size_t)i]) - sqrtf(r->picture->values[3 * b + (size_t)i]);
        apart = fmaxf(apart, fabsf(shade));
    }
    return apart > 0.03F;
}

static bool is_edge(const rendering *r, uint32_t x, uint32_t y)
{
    size_t at = (size_t)y * r->lens.width + x, width = r->lens.width;
    return (x > 0 && differ(r, at, at - 1)) || (x + 1 < r->lens.width && differ(r, at, at + 1)) ||
           (y > 0 && differ(r, at, at - width)) || (y + 1 < r->lens.height && differ(r, at, at + width));
}

/* Pixels tile by tile: neighbours in a batch are neighbours in the picture. With `edges` (one a pixel) only those, and
 * all samples but the first. */
static hewn_result cast(rendering *r, const uint8_t *edges, hewn_error *error)
{
    uint32_t width = r->lens.width, height = r->lens.height;
    for (uint32_t top = 0; top < height; top += TILE)
        for (uint32_t left = 0; left < width; left += TILE)
            for (uint32_t i = 0; i < TILE * TILE; i++) {
                uint32_t x = left + i % TILE, y = top + i / TILE;
                if (x >= width || y >= height || (edges && !edges[(size_t)y * width + x]))
                    continue;
                for (uint32_t k = edges ? 1 : 0; k < (edges ? r->samples : 1); k++)
                    HEWN_TRY(add_ray(r, x, y, k, error));
            }
    return r->batch.count > 0 ? flush(r, !edges, error) : HEWN_OK;
}

static hewn_result refine(rendering *r, hewn_error *error)
{
    uint32_t width = r->lens.width, height = r->lens.height;
    uint8_t *edges = hewn_alloc((size_t)width * height, 1);
    if (!edges)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a picture");
    uint64_t count = 0;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            count += edges[(size_t)y * width + x] = is_edge(r, x, y);
    r->wanted += count * (r->samples - 1);
    hewn_result result = cast(r, edges, error);
    for (size_t i = 0; i < (size_t)width * height; i++)
        for (size_t k = 0; k < 3 && edges[i]; k++)
            r->picture->values[3 * i + k] /= (float)r->samples;
    hewn_free(edges);
    return result;
}

/* --- the whole ------------------------------------------------------------------------------------------------------
 */

static hewn_result begin(rendering *r, hewn_error *error)
{
    const hewn_render_desc *desc = r->desc;
    uint32_t width = desc->width ? desc->width : 1280, height = desc->height ? desc->height : 720;
    if (desc->samples > MOST_SAMPLES)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "at most %d samples a pixel, not %u", MOST_SAMPLES,
                         desc->samples);
    HEWN_TRY(hewn_lens_create(&desc->camera, width, height, &r->lens, error));
    r->stage = hewn_stage_of(&r->lens, desc, &r->renderer->box);
    bool lit = desc->method == HEWN_RENDER_TRACE, given = false;
    r->samples = lit ? (desc->samples ? desc->samples : USUAL_SAMPLES) : 1;
    for (int i = 0; i < 3; i++) {
        given = given || desc->colour[i] > 0;
        r->surface[i] = desc->colour[i];
    }
    if (!given)
        memcpy(r->surface, (const float[3]){0.62F, 0.64F, 0.67F}, sizeof r->surface);
    size_t pixels = (size_t)width * height;
    r->wanted = pixels;
    *r->picture = (hewn_picture){.width = width, .height = height};
    r->picture->kind = lit                                   ? HEWN_PICTURE_COLOUR
                       : desc->method == HEWN_RENDER_NORMALS ? HEWN_PICTURE_VECTOR
                                                             : HEWN_PICTURE_SCALAR;
    r->picture->values = hewn_alloc(pixels * (r->picture->kind == HEWN_PICTURE_SCALAR ? 1 : 3), sizeof(float));
    r->batch.rays = hewn_alloc(BATCH, sizeof *r->batch.rays);
    r->batch.met = hewn_alloc(BATCH, sizeof *r->batch.met);
    r->batch.pixels = hewn_alloc(BATCH, sizeof *r->batch.pixels);
    bool painted = lit && !given && desc->painted && !r->renderer->of_triangles &&
                   hewn_field_has_colors(desc->painted, desc->painted_root);
    bool coloured = lit && !given && desc->corner_colors && r->renderer->of_triangles;
    r->batch.points = painted ? hewn_alloc(BATCH, 3 * sizeof *r->batch.points) : NULL;
    r->batch.colours = painted || coloured ? hewn_alloc(BATCH, 3 * sizeof *r->batch.colours) : NULL;
    r->first = r->samples > 1 ? hewn_alloc(pixels, sizeof *r->first) : NULL;
    if (!r->picture->values || !r->batch.rays || !r->batch.met || !r->batch.pixels || (painted && !r->batch.points) ||
        ((painted || coloured) && !r->batch.colours) || (r->samples > 1 && !r->first))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a picture of %u x %u pixels", width, height);
    r->stage.corner_colors = coloured ? desc->corner_colors : NULL;
    r->stage.colors = r->batch.colours;
    return HEWN_OK;
}

static hewn_result run(rendering *r, hewn_error *error)
{
    HEWN_TRY(begin(r, error));
    bool lit = r->desc->method == HEWN_RENDER_TRACE;
    if (lit && !r->desc->no_ground)
        HEWN_TRY(find_ground(r, error));
    if (lit)
        r->stage.flags |= HEWN_TRACE_SHADE;
    HEWN_TRY(cast(r, NULL, error));
    if (r->samples > 1)
        HEWN_TRY(refine(r, error));
    return HEWN_OK;
}

static void find_range(hewn_picture *picture)
{
    bool found = false;
    for (size_t i = 0; i < (size_t)picture->width * picture->height; i++) {
        double value = (double)picture->values[i];
        if (isnan(value))
            continue;
        picture->lo = found ? fmin(picture->lo, value) : value;
        picture->hi = found ? fmax(picture->hi, value) : value;
        found = true;
    }
}

hewn_result hewn_render(hewn_renderer *renderer, const hewn_render_desc *desc, hewn_picture *out,
                        hewn_render_stats *stats, hewn_error *error)
{
    hewn_render_stats own;
    stats = stats ? stats : &own;
    *stats = (hewn_render_stats){.on_host = renderer->tracer.on_host, .prepare_seconds = renderer->prepare_seconds};
    *out = (hewn_picture){0};
    rendering r = {.renderer = renderer, .desc = desc, .picture = out, .stats = stats};
    hewn_result result = run(&r, error);
    hewn_free(r.batch.rays);
    hewn_free(r.batch.met);
    hewn_free(r.batch.pixels);
    hewn_free(r.batch.points);
    hewn_free(r.batch.colours);
    hewn_free(r.first);
    if (result != HEWN_OK)
        hewn_picture_destroy(out);
    else if (out->kind == HEWN_PICTURE_SCALAR)
        find_range(out);
    return result;
}

void hewn_picture_destroy(hewn_picture *picture)
{
    hewn_free(picture->values);
    *picture = (hewn_picture){0};
}
