#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/render.h"
#include "lanes/image.h"

enum { MOST_PIXELS = 1 << 20 };

static hewn_result check(const hewn_plane_desc *desc, hewn_error *error)
{
    for (int i = 0; i < 2; i++)
        if (!(desc->lo[i] < desc->hi[i]) || !isfinite(desc->lo[i]) || !isfinite(desc->hi[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the plane has no inside along %c (%g to %g)", "xy"[i],
                             desc -> lo[i], desc -> hi[i]);
    if (!isfinite(desc->z))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a plane at z = %g makes no sense", desc->z);
    if (desc->width < 1 || desc->height < 1 || desc->width > MOST_PIXELS || desc->height > MOST_PIXELS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a picture has 1 to %d pixels a side, not %u x %u", MOST_PIXELS,
                         desc->width, desc->height);
    return HEWN_OK;
}

/* The middles of pixels. */
static void place(float *out, uint32_t count, double from, double to)
{
    for (uint32_t i = 0; i < count; i++)
        out[i] = (float)(from + (to - from) * ((i + 0.5) / count));
}

static hewn_result sample(const hewn_field *field, hewn_node root, const hewn_plane_desc *desc, const float *x,
                          const float *y, uint8_t *inside, hewn_picture *out, hewn_lane_image_stats *stats,
                          hewn_error *error)
{
    hewn_lane_tape *tape;
    const hewn_lane_image_desc image = {
        .x = x, .y = y, .z = (float)desc->z, .width = desc->width, .height = desc->height, .progress = desc->progress};
    HEWN_TRY(hewn_lane_tape_create(field, root, &tape, error));
    hewn_result result = desc->values ? hewn_lanes_values(tape, &image, out->values, stats, error)
                                      : hewn_lanes_inside(tape, &image, inside, stats, error);
    hewn_lane_tape_destroy(&tape);
    return result;
}

static void take_pixels(hewn_picture *out, const uint8_t *inside)
{
    size_t count = (size_t)out->width * out->height;
    bool found = false;
    for (size_t i = 0; i < count; i++) {
        if (out->kind == HEWN_PICTURE_COLOUR) {
            for (size_t k = 0; k < 3; k++)
                out->values[3 * i + k] = inside[i];
        } else if (isfinite(out->values[i])) {
            double value = (double)out->values[i];
            out->lo = found ? fmin(out->lo, value) : value;
            out->hi = found ? fmax(out->hi, value) : value;
            found = true;
        }
    }
}

hewn_result hewn_render_plane(const hewn_field *field, hewn_node root, const hewn_plane_desc *desc, hewn_picture *out,
                              hewn_plane_stats *stats, hewn_error *error)
{
    *out = (hewn_picture){0};
    HEWN_TRY(check(desc, error));
    hewn_lane_image_stats counted = {0};
    double pixels = (double)desc->width * desc->height;
    *out = (hewn_picture){.width = desc->width, .height = desc->height};
    out->kind = desc->values ? HEWN_PICTURE_SCALAR : HEWN_PICTURE_COLOUR;
    out->values = hewn_alloc((size_t)desc->width * desc->height * (desc->values ? 1 : 3), sizeof(float));
    float *x = hewn_alloc(desc->width, sizeof *x), *y = hewn_alloc(desc->height, sizeof *y);
    uint8_t *inside = hewn_alloc((size_t)desc->width * desc->height, 1);
    hewn_result result = HEWN_OK;
    if (out->values && x && y && inside) {
        place(x, desc->width, desc->lo[0], desc->hi[0]);
        place(y, desc->height, desc->hi[1], desc->lo[1]);
        result = sample(field, root, desc, x, y, inside, out, &counted, error);
    } else {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a picture of %u x %u pixels", desc->width,
                           desc->height);
    }
    if (result == HEWN_OK)
        take_pixels(out, inside);
    else
        hewn_picture_destroy(out);
    hewn_free(x);
    hewn_free(y);
    hewn_free(inside);
    if (stats)
        *stats = (hewn_plane_stats){.operations = counted.whole_steps,
                                    .operations_a_pixel = (double)counted.value_steps / pixels,
                                    .bounds_a_pixel = (double)counted.bound_steps / pixels,
                                    .filled = (double)counted.filled / pixels};
    return result;
}
