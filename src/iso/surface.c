/* From active bricks to triangles: signs, counts, prefix sums, then every vertex and triangle at its place. */
#include <string.h>

#include "base/error.h"
#include "eval/lists.h"
#include "iso/extractor.h"
#include "shared/lists.h"

static hewn_result take_surface(const hewn_bricks *bricks, hewn_workspace *workspace, hewn_surface *out,
                                hewn_error *error)
{
    const struct {
        const char *what;
        uint32_t words;
        const hewn_buffer **place;
    } wanted[] = {
        {"neighbours of bricks", HEWN_BRICK_LINKS, &out->links},
        {"signs of samples", HEWN_BRICK_WORDS, &out->signs},
        {"crossed edges", 2 * HEWN_BRICK_EDGE_WORDS, &out->edges},
        {"vertices a brick", 1, &out->vertex_bases},
        {"triangles a brick", 1, &out->triangle_bases},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        hewn_buffer *taken;
        HEWN_TRY(hewn_workspace_take(workspace, wanted[i].what, (uint64_t)4 * wanted[i].words * bricks->count,
                                     HEWN_BUFFER_DEVICE, &taken, error));
        *wanted[i].place = taken;
    }
    return HEWN_OK;
}

void hewn_surface_record_signs(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               const hewn_surface *surface, hewn_commands *commands)
{
    struct hewn_sign_push push = {
        .grid = *grid, .count = bricks->count, .bricks = bricks->list->address, .signs = surface->signs->address};
    hewn_commands_dispatch(commands, extractor->signs, &push, hewn_code_uniforms(extractor->code),
                           hewn_groups_for((uint64_t)bricks->count * HEWN_BRICK_WORDS, 64));
}

void hewn_surface_record_links(const hewn_extractor *extractor, const hewn_bricks *bricks, const hewn_surface *surface,
                               hewn_commands *commands)
{
    struct hewn_link_push push = {.levels = bricks->levels,
                                  .count = bricks->count,
                                  .bricks = bricks->list->address,
                                  .links = surface->links->address};
    memcpy(push.top, bricks->top, sizeof push.top);
    for (uint32_t i = 0; i < bricks->levels; i++)
        push.states[i] = bricks->states[i]->address;
    hewn_commands_dispatch(commands, extractor->link, &push, NULL,
                           hewn_groups_for((uint64_t)bricks->count * HEWN_BRICK_LINKS, 64));
}

static void record_classify(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                            const hewn_surface *surface, hewn_commands *commands)
{
    struct hewn_classify_push push = {.count = bricks->count,
                                      .bricks = bricks->list->address,
                                      .links = surface->links->address,
                                      .signs = surface->signs->address,
                                      .edges = surface->edges->address,
                                      .vertex_counts = surface->vertex_bases->address,
                                      .triangle_counts = surface->triangle_bases->address};
    memcpy(push.cells, grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, extractor->classify, &push, &extractor->table, hewn_groups_for(bricks->count, 32));
}

hewn_result hewn_surface_classify(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                  const hewn_bricks *bricks, hewn_workspace *workspace, hewn_surface *out,
                                  hewn_error *error)
{
    hewn_buffer *totals, *results, *scratch;
    HEWN_TRY(take_surface(bricks, workspace, out, error));
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 16, HEWN_BUFFER_DEVICE, &totals, error));
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 16, HEWN_BUFFER_READBACK, &results, error));
    HEWN_TRY(hewn_workspace_take(workspace, "scratch of sums", hewn_scan_scratch_bytes(bricks->count),
                                 HEWN_BUFFER_DEVICE, &scratch, error));
    hewn_commands *commands;
    double times[2] = {0};
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    hewn_commands_mark(commands);
    hewn_surface_record_signs(extractor, grid, bricks, out, commands);
    hewn_commands_mark(commands);
    hewn_surface_record_links(extractor, bricks, out, commands);
    record_classify(extractor, grid, bricks, out, commands);
    hewn_scan_record(extractor->scan, commands, out->vertex_bases->address, bricks->count, totals->address,
                     scratch->address);
    hewn_scan_record(extractor->scan, commands, out->triangle_bases->address, bricks->count, totals->address + 8,
                     scratch->address);
    hewn_commands_copy(commands, totals, 0, results, 0, 16);
    HEWN_TRY(hewn_commands_submit(&commands, times, error));
    const uint32_t *total = results->mapped;
    HEWN_TRY(hewn_scan_check(total, "vertices", error));
    HEWN_TRY(hewn_scan_check(total + 2, "triangles", error));
    out->sign_seconds = times[1];
    out->crossing_count = total[0];
    out->vertex_count = total[0];
    out->triangle_count = total[2];
    return HEWN_OK;
}

static void record_spread(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                          const hewn_surface *surface, const hewn_buffer buffers[3], hewn_commands *commands)
{
    struct hewn_spread_push push = {.count = bricks->count,
                                    .bricks = bricks->list->address,
                                    .links = surface->links->address,
                                    .signs = surface->signs->address,
                                    .edges = surface->edges->address,
                                    .vertex_bases = surface->vertex_bases->address,
                                    .triangle_bases = surface->triangle_bases->address,
                                    .vertices = buffers[0].address,
                                    .indices = buffers[2].address};
    memcpy(push.cells, grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, extractor->spread, &push, &extractor->table, hewn_groups_for(bricks->count, 32));
}

hewn_own hewn_surface_own(const hewn_surface *surface)
{
    if (surface->own.part)
        return surface->own;
    bool dual = surface->loops;
    return (hewn_own){.crossings = {0, surface->crossing_count},
                      .vertices = {0, surface->vertex_count},
                      .centres = {0, surface->centre_count},
                      .triangles = {0, surface->triangle_count},
                      .bases = {dual ? surface->crossing_bases : surface->vertex_bases}};
}

void hewn_crossings_record(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                           const hewn_crossings *crossings, hewn_commands *commands)
{
    const hewn_buffer *uniforms = hewn_code_uniforms(extractor->code);
    uint64_t count = crossings->end - crossings->first;
    if (count == 0)
        return;
    if (hewn_code_is_listed(extractor->code)) {
        struct hewn_listed_vertex_push push = {.grid = *grid,
                                               .count = bricks->count,
                                               .vertex_count = (uint32_t)crossings->end,
                                               .dual = crossings->dual,
                                               .bricks = bricks->list->address,
                                               .vertex_bases = crossings->bases->address,
                                               .positions = crossings->positions->address,
                                               .normals = crossings->normals->address,
                                               .summary = crossings->summary};
        hewn_commands_dispatch(commands, extractor->vertices, &push, uniforms,
                               hewn_groups_for((uint64_t)bricks->count * 16, 64));
        return;
    }
    struct hewn_vertex_push push = {.grid = *grid,
                                    .count = (uint32_t)count,
                                    .dual = crossings->dual,
                                    .bricks = bricks->list->address,
                                    .positions = crossings->positions->address + 12 * crossings->first,
                                    .normals = crossings->normals->address + 12 * crossings->first,
                                    .summary = crossings->summary};
    hewn_commands_dispatch(commands, extractor->vertices, &push, uniforms, hewn_groups_for(count, 64));
}

hewn_result hewn_surface_emit(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                              const hewn_surface *surface, const hewn_buffer buffers[3], hewn_workspace *workspace,
                              hewn_emission *out, hewn_error *error)
{
    hewn_buffer *summary, *results;
    uint64_t bytes = 2 * 4 * HEWN_SUMMARY_WORDS; /* what is not a part's own is not summed up with it */
    HEWN_TRY(hewn_workspace_take(workspace, "summary", bytes, HEWN_BUFFER_DEVICE, &summary, error));
    HEWN_TRY(hewn_workspace_take(workspace, "summary", bytes, HEWN_BUFFER_READBACK, &results, error));
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    hewn_commands_fill(commands, summary, 0, summary->size, 0);
    bool refined = surface->asked;
    if (refined)
        hewn_mc33_record_spread(extractor, grid, bricks, surface, buffers, commands);
    else
        record_spread(extractor, grid, bricks, surface, buffers, commands);
    hewn_own own = hewn_surface_own(surface);
    hewn_crossings crossings = {.first = own.crossings[0],
                                .end = own.crossings[1],
                                .bases = own.bases[0],
                                .positions = &buffers[0],
                                .normals = &buffers[1],
                                .summary = summary->address};
    hewn_crossings_record(extractor, grid, bricks, &crossings, commands);
    if (own.centres[1] > own.centres[0]) { /* vertices in cells are means of those around, also of later bricks */
        crossings.first = own.crossings[1];
        crossings.end = surface->crossing_count;
        crossings.bases = own.bases[1];
        crossings.summary += (uint64_t)4 * HEWN_SUMMARY_WORDS;
        hewn_crossings_record(extractor, grid, bricks, &crossings, commands);
    }
    hewn_mc33_record_centres(extractor, grid, bricks, surface, buffers, summary, commands);
    uint64_t count = own.triangles[1] - own.triangles[0];
    struct hewn_triangle_push triangles = {.count = (uint32_t)count,
                                           .links = surface->links->address,
                                           .edges = surface->edges->address,
                                           .indices = buffers[2].address + 12 * own.triangles[0]};
    hewn_commands_dispatch(commands, refined ? extractor->mc33.triangles : extractor->triangles, &triangles,
                           refined ? NULL : &extractor->table, hewn_groups_for(count, 64));
    hewn_commands_copy(commands, summary, 0, results, 0, summary->size);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    const uint32_t *words = results->mapped;
    *out = (hewn_emission){.caps = words[HEWN_SUMMARY_CAPS], .capped_crossings = words[HEWN_SUMMARY_CAPS]};
    memcpy(&out->max_residual, &words[HEWN_SUMMARY_RESIDUAL], sizeof out->max_residual);
    return HEWN_OK;
}
