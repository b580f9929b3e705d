#include "iso/part.h"

#include <string.h>

#include "base/error.h"
#include "eval/lists.h"

uint64_t hewn_part_own_bricks(const hewn_part *part)
{
    return part->surface.own.bricks[1] - part->surface.own.bricks[0];
}

uint32_t hewn_part_base(const hewn_part *part, uint64_t at)
{
    return at < part->bricks.count ? part->bases[at] : (uint32_t)part->named_vertices;
}

/* --- what is a part's own ----------------------------------------------------------------------------------------- */

/* The first of the ascending numbers that is not below `bound`. */
static uint64_t lower_bound(const uint32_t *numbers, uint64_t count, uint32_t bound)
{
    uint64_t low = 0;
    while (count > 0) {
        uint64_t half = count / 2;
        bool below = numbers[low + half] < bound;
        low += below ? half + 1 : 0;
        count = below ? count - half - 1 : half;
    }
    return low;
}

static hewn_result find_bricks(hewn_extraction *run, hewn_part *part, hewn_error *error)
{
    uint64_t count = part->bricks.count;
    const void *packed;
    hewn_buffer *home;
    HEWN_TRY(hewn_workspace_read(&run->workspace, part->bricks.list, 0, 4 * count, &packed, error));
    HEWN_TRY(hewn_workspace_take(&run->workspace, "numbers of bricks", 4 * count, HEWN_BUFFER_READBACK, &home, error));
    uint32_t *numbers = home->mapped;
    part->packed = packed;
    part->numbers = numbers;
    for (uint64_t i = 0; i < count; i++)
        numbers[i] = hewn_region_number(&part->region, part->packed[i]);
    uint64_t *own = part->surface.own.bricks;
    own[0] = lower_bound(part->numbers, count, part->region.begin);
    own[1] = lower_bound(part->numbers, count, part->region.end);
    return HEWN_OK;
}

/* The numbers at which a part's own things begin and end; `times` each. */
static hewn_result find_range(hewn_extraction *run, const hewn_part *part, const hewn_buffer *bases, uint64_t total,
                              uint64_t times, uint64_t range[2], hewn_error *error)
{
    const void *words;
    HEWN_TRY(hewn_workspace_read(&run->workspace, bases, 0, 4 * (uint64_t)part->bricks.count, &words, error));
    for (int i = 0; i < 2; i++) {
        uint64_t at = part->surface.own.bricks[i];
        range[i] = at < part->bricks.count ? times * ((const uint32_t *)words)[at] : total;
    }
    return HEWN_OK;
}

/* Bases that leave every brick without crossings but those whose crossings lie between the two numbers. */
static hewn_result narrow_bases(hewn_extraction *run, const hewn_part *part, const hewn_buffer *bases, uint64_t first,
                                uint64_t end, const hewn_buffer **out, hewn_error *error)
{
    uint64_t count = part->bricks.count;
    hewn_buffer *narrow;
    const void *words;
    HEWN_TRY(hewn_workspace_read(&run->workspace, bases, 0, 4 * count, &words, error));
    HEWN_TRY(
        hewn_workspace_take(&run->workspace, "crossings of a part", 4 * count, HEWN_BUFFER_UPLOAD, &narrow, error));
    const uint32_t *from = words;
    uint32_t *to = narrow->mapped;
    for (uint64_t i = 0; i < count; i++)
        to[i] = from[i] < first ? (uint32_t)first : from[i] > end ? (uint32_t)end : from[i];
    *out = narrow;
    return HEWN_OK;
}

static hewn_result find_own(hewn_extraction *run, hewn_part *part, bool counts_only, hewn_error *error)
{
    hewn_surface *surface = &part->surface;
    hewn_own *own = &surface->own;
    bool dual = hewn_method_is_dual(run->method);
    const hewn_buffer *crossings = dual ? surface->crossing_bases : surface->vertex_bases;
    const void *words;
    HEWN_TRY(hewn_workspace_read(&run->workspace, surface->vertex_bases, 0, 4 * (uint64_t)part->bricks.count, &words,
                                 error));
    part->bases = words;
    part->named_vertices = surface->vertex_count - surface->centre_count;
    HEWN_TRY(find_range(run, part, crossings, surface->crossing_count, 1, own->crossings, error));
    HEWN_TRY(find_range(run, part, surface->vertex_bases, part->named_vertices, 1, own->vertices, error));
    HEWN_TRY(
        find_range(run, part, surface->triangle_bases, surface->triangle_count, dual ? 2 : 1, own->triangles, error));
    if (surface->centre_bases)
        HEWN_TRY(find_range(run, part, surface->centre_bases, surface->centre_count, 1, own->centres, error));
    const uint64_t ends[3] = {own->crossings[0], own->crossings[1], surface->crossing_count};
    bool listed = hewn_code_is_listed(run->extractor->code);
    for (int i = 0; i < 2 && listed && !counts_only; i++)
        HEWN_TRY(narrow_bases(run, part, crossings, ends[i], ends[i + 1], &own->bases[i], error));
    own->part = true;
    return HEWN_OK;
}

hewn_result hewn_part_open(hewn_extraction *run, const hewn_region *region, bool counts_only, hewn_part *out,
                           hewn_error *error)
{
    hewn_part *part = out;
    const hewn_extractor *extractor = run->extractor;
    *part = (hewn_part){.region = *region};
    part->bricks.beyond = run->method == HEWN_METHOD_DC ? HEWN_DUAL_BEYOND : 0;
    HEWN_TRY(hewn_bricks_cull_part(extractor, &run->grid, region, &run->workspace, &part->bricks, error));
    if (part->bricks.count == 0)
        return HEWN_OK;
    HEWN_TRY(find_bricks(run, part, error));
    if (hewn_part_own_bricks(part) == 0)
        return HEWN_OK;
    HEWN_TRY((hewn_method_is_dual(run->method) ? hewn_dual_classify : hewn_surface_classify)(
        extractor, &run->grid, &part->bricks, &run->workspace, &part->surface, error));
    if (run->method == HEWN_METHOD_MC33 && !counts_only)
        HEWN_TRY(hewn_mc33_refine(extractor, &run->grid, &part->bricks, &run->workspace, &part->surface, error));
    return find_own(run, part, counts_only, error);
}

/* --- emission ----------------------------------------------------------------------------------------------------- */

hewn_result hewn_part_emit(hewn_extraction *run, hewn_part *part, hewn_buffer buffers[3], hewn_emission *out,
                           hewn_error *error)
{
    static const char *const what[3] = {"positions", "normals", "indices"};
    hewn_surface *surface = &part->surface;
    const uint64_t items[3] = {surface->vertex_count, surface->vertex_count, surface->triangle_count};
    for (int i = 0; i < 3; i++)
        HEWN_TRY(
            hewn_buffer_create(run->extractor->device, what[i], 12 * items[i], HEWN_BUFFER_DEVICE, &buffers[i], error));
    if (!hewn_method_is_dual(run->method))
        return hewn_surface_emit(run->extractor, &run->grid, &part->bricks, surface, buffers, &run->workspace, out,
                                 error);
    hewn_dual_hermite kept;
    uint32_t keep = run->desc->quads ? HEWN_KEEP_NONE : HEWN_KEEP_FANS;
    HEWN_TRY(hewn_dual_emit(run->extractor, &run->grid, &part->bricks, surface, run->method, buffers, &run->workspace,
                            keep, &kept, out, error));
    return keep == HEWN_KEEP_FANS ? hewn_dual_add_fans(run->extractor, &kept, surface, buffers, &run->workspace, error)
                                  : HEWN_OK;
}
