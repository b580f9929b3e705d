#include "render/slopes.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/graph.h"
#include "render/tracer.h"

enum { ACROSS = HEWN_SLOPES_ACROSS, MOST_NODES = 1024 };

/* Parts whose slope is too much are too many where they are more than this share. */
#define WORTH 0.5

static hewn_result bound_part(const hewn_slopes *slopes, const hewn_field *field, hewn_node root, size_t part,
                              double *bound)
{
    const size_t at[3] = {part % ACROSS, part / ACROSS % ACROSS, part / ACROSS / ACROSS};
    hewn_box box;
    for (int axis = 0; axis < 3; axis++) {
        double lo = (double)slopes->lo[axis], size = (double)slopes->size[axis], margin = (double)slopes->margin;
        box.lo[axis] = lo + size * (double)at[axis] - margin;
        box.hi[axis] = lo + size * (double)(at[axis] + 1) + margin;
    }
    return hewn_steepness_bound(field, root, &box, bound, NULL);
}

static hewn_result fill(hewn_slopes *out, const hewn_field *field, hewn_node root, double most, hewn_error *error)
{
    enum { COUNT = ACROSS * ACROSS * ACROSS };
    hewn_result all = HEWN_OK;
    uint32_t steep = 0;
    float greatest = 0;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : steep) reduction(max : greatest)
    for (size_t i = 0; i < COUNT; i++) {
        double bound = INFINITY;
        hewn_result result = bound_part(out, field, root, i, &bound);
        out->bounds[i] = bound > 0 && bound <= most ? nextafterf((float)bound, INFINITY) : 0;
        greatest = fmaxf(greatest, out->bounds[i]);
        steep += !(bound <= most);
        if (result != HEWN_OK) {
#pragma omp critical(hewn_slopes)
            all = result;
        }
    }
    out->greatest = greatest;
    if (all != HEWN_OK)
        return hewn_fail(error, all, "out of memory for a field's slope");
    if (steep > WORTH * COUNT || greatest == 0)
        hewn_slopes_destroy(out);
    return HEWN_OK;
}

hewn_result hewn_slopes_create(const hewn_field *field, hewn_node root, const hewn_box *box, double margin, double most,
                               hewn_slopes *out, hewn_error *error)
{
    *out = (hewn_slopes){.margin = (float)margin};
    uint32_t *ids = NULL;
    size_t count = 0;
    HEWN_TRY(hewn_field_live_nodes(field, root, &ids, &count, error));
    hewn_free(ids);
    if (count > MOST_NODES)
        return HEWN_OK;
    for (int axis = 0; axis < 3; axis++) {
        out->lo[axis] = (float)box->lo[axis];
        out->size[axis] = (float)((box->hi[axis] - box->lo[axis]) / ACROSS);
        out->scale[axis] = 1 / out->size[axis];
    }
    out->bounds = hewn_alloc((size_t)ACROSS * ACROSS * ACROSS, sizeof *out->bounds);
    if (!out->bounds)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a field's slope");
    hewn_result result = fill(out, field, root, most, error);
    if (result != HEWN_OK)
        hewn_slopes_destroy(out);
    return result;
}

void hewn_slopes_destroy(hewn_slopes *slopes)
{
    hewn_free(slopes->bounds);
    *slopes = (hewn_slopes){0};
}

float hewn_slopes_at(const hewn_slopes *slopes, const float p[3], const float along[3], float *way)
{
    uint32_t at[3];
    *way = 3.0e38F;
    for (int axis = 0; axis < 3; axis++) {
        float place = (p[axis] - slopes->lo[axis]) * slopes->scale[axis];
        at[axis] = place > 0 ? place < ACROSS - 1 ? (uint32_t)place : ACROSS - 1U : 0;
        float side = slopes->lo[axis] + slopes->size[axis] * (float)(at[axis] + (along[axis] > 0));
        float left = (side - p[axis]) / along[axis];
        *way = left < *way ? left : *way;
    }
    *way = (*way > 0 ? *way : 0) + 0.5F * slopes->margin;
    return slopes->bounds[at[0] + ACROSS * (at[1] + (size_t)ACROSS * at[2])];
}
