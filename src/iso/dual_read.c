/* Brings a dual surface to the host, with the crossings and normals that its vertices were made of. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/extractor.h"

/* What is read, as the device has it. */
typedef struct raw_surface {
    const uint32_t *bricks, *records, *crossings, *indices;
    const float *points, *point_normals, *positions, *normals;
} raw_surface;

static hewn_result read_all(const hewn_bricks *bricks, const hewn_dual_hermite *kept, const hewn_buffer buffers[3],
                            hewn_workspace *workspace, raw_surface *raw, hewn_error *error)
{
    const hewn_buffer *from[] = {bricks->list, kept->records, kept->crossings, &buffers[2],
                                 kept->points, kept->normals, &buffers[0],     &buffers[1]};
    const void *at[8];
    for (int i = 0; i < 8; i++)
        HEWN_TRY(hewn_workspace_read(workspace, from[i], 0, from[i]->size, &at[i], error));
    *raw = (raw_surface){at[0], at[1], at[2], at[3], at[4], at[5], at[6], at[7]};
    return HEWN_OK;
}

/* |f| / |grad f| at each vertex; 0 where that is no number. */
static hewn_result find_residuals(const hewn_extractor *extractor, const hewn_dual_reading *reading, hewn_error *error)
{
    uint64_t count = reading->surface.vertex_count;
    float *values = hewn_alloc(count, 4 * sizeof *values);
    if (!values)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the surface");
    hewn_result result =
        hewn_code_eval_gradients(extractor->device, extractor->code, reading->surface.positions, count, values, error);
    for (uint64_t i = 0; result == HEWN_OK && i < count; i++) {
        const float *g = values + 4 * i;
        float residual = fabsf(g[0]) / sqrtf(g[1] * g[1] + g[2] * g[2] + g[3] * g[3]);
        reading->residuals[i] = isfinite(residual) ? residual : 0;
    }
    hewn_free(values);
    return result;
}

static hewn_result take_arrays(hewn_dual_reading *reading, hewn_error *error)
{
    uint64_t vertices = reading->surface.vertex_count, quads = reading->surface.quad_count;
    reading->cells = hewn_alloc(vertices, 3 * sizeof *reading->cells);
    reading->residuals = hewn_alloc(vertices, sizeof *reading->residuals);
    reading->quads = hewn_alloc(quads, 4 * sizeof *reading->quads);
    reading->points = hewn_alloc(quads, 3 * sizeof *reading->points);
    reading->gradients = hewn_alloc(quads, 3 * sizeof *reading->gradients);
    if (!reading->cells || !reading->residuals || !reading->quads || !reading->points || !reading->gradients)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the surface");
    return HEWN_OK;
}

static void fill_arrays(const hewn_dual_reading *reading, const raw_surface *raw)
{
    for (uint64_t i = 0; i < reading->surface.vertex_count; i++) {
        uint32_t brick = raw->bricks[raw->records[3 * i]], number = raw->records[3 * i + 1];
        for (uint32_t axis = 0; axis < 3; axis++)
            reading->cells[3 * i + axis] = 8 * (brick >> 10 * axis & 1023) + (number >> 3 * axis & 7);
    }
    for (uint64_t i = 0; i < reading->surface.quad_count; i++) {
        static const uint32_t corners[4] = {0, 1, 2, 5}; /* of (a, b, c), (a, c, d) */
        for (uint32_t k = 0; k < 4; k++)
            reading->quads[4 * i + k] = raw->indices[6 * i + corners[k]];
        memcpy(reading->points + 3 * i, raw->points + (size_t)3 * raw->crossings[i], 12);
        memcpy(reading->gradients + 3 * i, raw->point_normals + (size_t)3 * raw->crossings[i], 12);
    }
}

hewn_result hewn_dual_read(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                           const hewn_surface *surface, const hewn_dual_hermite *kept, const hewn_buffer buffers[3],
                           hewn_workspace *workspace, hewn_dual_reading *out, hewn_error *error)
{
    raw_surface raw;
    *out = (hewn_dual_reading){0};
    HEWN_TRY(read_all(bricks, kept, buffers, workspace, &raw, error));
    out->surface.vertex_count = surface->vertex_count;
    out->surface.quad_count = surface->triangle_count / 2;
    hewn_result result = take_arrays(out, error);
    if (result == HEWN_OK) {
        fill_arrays(out, &raw);
        out->surface = (hewn_dual_surface){.grid = *grid,
                                           .vertex_count = surface->vertex_count,
                                           .cells = out->cells,
                                           .positions = raw.positions,
                                           .normals = raw.normals,
                                           .residuals = out->residuals,
                                           .quad_count = surface->triangle_count / 2,
                                           .quads = out->quads,
                                           .points = out->points,
                                           .gradients = out->gradients};
        result = find_residuals(extractor, out, error);
    }
    if (result != HEWN_OK)
        hewn_dual_reading_clear(out);
    return result;
}

void hewn_dual_reading_clear(hewn_dual_reading *reading)
{
    hewn_free(reading->cells);
    hewn_free(reading->residuals);
    hewn_free(reading->quads);
    hewn_free(reading->points);
    hewn_free(reading->gradients);
    *reading = (hewn_dual_reading){0};
}
