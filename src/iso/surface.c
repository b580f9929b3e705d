/* From active bricks to triangles: signs, counts, prefix sums, then every vertex and triangle at its place. */
#include <string.h>

#include "base/error.h"
#include "eval/lists.h"
#include "iso/extractor.h"
#include "iso/host_surface.h"
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

static void record_signs(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                         const hewn_surface *surface, hewn_commands *commands)
{
    struct hewn_sign_push push = {
        .grid = *grid, .count = bricks->count, .bricks = bricks->list->address, .signs = surface->signs->address};
    hewn_commands_dispatch(commands, extractor->signs, &push, hewn_code_uniforms(extractor->code),
                           hewn_groups_for((uint64_t)bricks->count * HEWN_BRICK_WORDS, 64));
}

static void record_links(const hewn_extractor *extractor, const hewn_bricks *bricks, const hewn_surface *surface,
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

hewn_result hewn_surface_begin(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               const hewn_surface *surface, hewn_commands **out, hewn_error *error)
{
    HEWN_TRY(hewn_commands_begin(extractor->device, out, error));
    hewn_commands_mark(*out);
    record_signs(extractor, grid, bricks, surface, *out);
    hewn_commands_mark(*out);
    record_links(extractor, bricks, surface, *out);
    return HEWN_OK;
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

static hewn_host_surface view_on_host(const struct hewn_grid *grid, const hewn_bricks *bricks,
                                      const hewn_surface *surface)
{
    hewn_host_surface view = {.count = bricks->count,
                              .bricks = bricks->list->mapped,
                              .links = surface->links->mapped,
                              .signs = surface->signs->mapped,
                              .edges = surface->edges->mapped,
                              .vertex_bases = surface->vertex_bases->mapped,
                              .triangle_bases = surface->triangle_bases->mapped};
    memcpy(view.cells, grid->cells, sizeof view.cells);
    return view;
}

/* Counts on the device, as part of the commands that made the signs. */
static hewn_result count_on_device(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   const hewn_bricks *bricks, const hewn_surface *surface, hewn_workspace *workspace,
                                   hewn_commands *commands, hewn_buffer **results, hewn_error *error)
{
    hewn_buffer *totals, *scratch;
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 16, HEWN_BUFFER_DEVICE, &totals, error));
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 16, HEWN_BUFFER_READBACK, results, error));
    HEWN_TRY(hewn_workspace_take(workspace, "scratch of sums", hewn_scan_scratch_bytes(bricks->count),
                                 HEWN_BUFFER_DEVICE, &scratch, error));
    record_classify(extractor, grid, bricks, surface, commands);
    hewn_scan_record(extractor->scan, commands, surface->vertex_bases->address, bricks->count, totals->address,
                     scratch->address);
    hewn_scan_record(extractor->scan, commands, surface->triangle_bases->address, bricks->count, totals->address + 8,
                     scratch->address);
    hewn_commands_copy(commands, totals, 0, *results, 0, 16);
    return HEWN_OK;
}

hewn_result hewn_surface_classify(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                  const hewn_bricks *bricks, hewn_workspace *workspace, hewn_surface *out,
                                  hewn_error *error)
{
    hewn_buffer *results = NULL;
    HEWN_TRY(take_surface(bricks, workspace, out, error));
    hewn_commands *commands;
    double times[2] = {0};
    HEWN_TRY(hewn_surface_begin(extractor, grid, bricks, out, &commands, error));
    hewn_result result = HEWN_OK;
    if (!extractor->on_host)
        result = count_on_device(extractor, grid, bricks, out, workspace, commands, &results, error);
    if (result != HEWN_OK) {
        hewn_commands_destroy(&commands);
        return result;
    }
    HEWN_TRY(hewn_commands_submit(&commands, times, error));
    uint32_t total[4]; /* vertices and triangles, each in two words */
    if (extractor->on_host) {
        const hewn_host_surface view = view_on_host(grid, bricks, out);
        hewn_host_surface_count(&view, total);
    } else {
        memcpy(total, results->mapped, sizeof total);
    }
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

/* Turns of 32 vertices that an invocation may take of each brick, so that it gets by with the iterations that CPU
 * drivers give it: a turn walks the list about twelve times. */
static uint32_t turns_at_once(const hewn_bricks *bricks)
{
    enum { MOST_TURNS = 3 * 512 / 32, ITERATIONS = 40000, WALKS = 12 };
    uint64_t a_turn = (uint64_t)WALKS * bricks->longest;
    return a_turn * MOST_TURNS <= ITERATIONS ? MOST_TURNS : a_turn < ITERATIONS ? (uint32_t)(ITERATIONS / a_turn) : 1;
}

static void record_listed(const hewn_extractor *extractor, const hewn_bricks *bricks,
                          struct hewn_listed_vertex_push *push, hewn_commands *commands)
{
    push->turns = turns_at_once(bricks);
    for (; push->first_turn < 3 * 512 / 32; push->first_turn += push->turns)
        hewn_commands_dispatch(commands, extractor->vertices, push, hewn_code_uniforms(extractor->code),
                               hewn_groups_for((uint64_t)bricks->count * 8, 64));
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
        record_listed(extractor, bricks, &push, commands);
        return;
    }
    struct hewn_vertex_push push = {.grid = *grid,
                                    .count = (uint32_t)count,
                                    .dual = crossings->dual,
                                    .positions = crossings->positions->address + 12 * crossings->first,
                                    .normals = crossings->normals->address + 12 * crossings->first,
                                    .summary = crossings->summary};
    hewn_commands_dispatch(commands, extractor->vertices, &push, uniforms,
                           hewn_groups_for(count, 64 * HEWN_VERTICES_EACH));
}

/* Vertices on edges, and those in cells of the trilinear interpolant's topology, which are means of those around, also
 * of later bricks. */
static void record_vertices(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                            const hewn_surface *surface, const hewn_buffer buffers[3], const hewn_buffer *summary,
                            hewn_commands *commands)
{
    const hewn_own own = hewn_surface_own(surface);
    hewn_crossings crossings = {.first = own.crossings[0],
                                .end = own.crossings[1],
                                .bases = own.bases[0],
                                .positions = &buffers[0],
                                .normals = &buffers[1],
                                .summary = summary->address};
    hewn_crossings_record(extractor, grid, bricks, &crossings, commands);
    if (own.centres[1] > own.centres[0]) {
        crossings.first = own.crossings[1];
        crossings.end = surface->crossing_count;
        crossings.bases = own.bases[1];
        crossings.summary += (uint64_t)4 * HEWN_SUMMARY_WORDS;
        hewn_crossings_record(extractor, grid, bricks, &crossings, commands);
    }
    hewn_mc33_record_centres(extractor, grid, bricks, surface, buffers, summary, commands);
}

static void record_triangles(const hewn_extractor *extractor, const hewn_surface *surface, const hewn_buffer *indices,
                             hewn_commands *commands)
{
    const hewn_own own = hewn_surface_own(surface);
    uint64_t count = own.triangles[1] - own.triangles[0];
    struct hewn_triangle_push triangles = {.count = (uint32_t)count,
                                           .links = surface->links->address,
                                           .edges = surface->edges->address,
                                           .indices = indices->address + 12 * own.triangles[0]};
    bool refined = surface->asked;
    if (count > 0)
        hewn_commands_dispatch(commands, refined ? extractor->mc33.triangles : extractor->triangles, &triangles,
                               refined ? NULL : &extractor->table, hewn_groups_for(count, 64));
}

/* Records of vertices, and what triangles there are to emit, before any command runs. */
static void emit_on_host(const struct hewn_grid *grid, const hewn_bricks *bricks, const hewn_surface *surface,
                         const hewn_buffer buffers[3])
{
    hewn_host_surface view = view_on_host(grid, bricks, surface);
    const hewn_own own = hewn_surface_own(surface);
    view.vertices = buffers[0].mapped;
    view.indices = buffers[2].mapped;
    hewn_host_surface_spread(&view);
    uint32_t first = own.part ? (uint32_t)own.bricks[0] : 0, end = own.part ? (uint32_t)own.bricks[1] : bricks->count;
    hewn_host_surface_triangulate(&view, first, end, surface->triangle_count);
}

hewn_result hewn_emission_fail_cut(hewn_error *error)
{
    return hewn_fail(
        error, HEWN_LIMIT,
        "so many shapes matter in one place that this device gives up on it; smaller cells have fewer, and "
        "the method mc takes more than the others");
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
    bool refined = surface->asked, on_host = extractor->on_host;
    if (on_host && refined)
        hewn_mc33_emit_on_host(extractor, grid, bricks, surface, buffers);
    else if (on_host)
        emit_on_host(grid, bricks, surface, buffers);
    else if (refined)
        hewn_mc33_record_spread(extractor, grid, bricks, surface, buffers, commands);
    else
        record_spread(extractor, grid, bricks, surface, buffers, commands);
    record_vertices(extractor, grid, bricks, surface, buffers, summary, commands);
    if (!on_host)
        record_triangles(extractor, surface, &buffers[2], commands);
    hewn_commands_copy(commands, summary, 0, results, 0, summary->size);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    const uint32_t *words = results->mapped;
    *out = (hewn_emission){.caps = words[HEWN_SUMMARY_CAPS],
                           .capped_crossings = words[HEWN_SUMMARY_CAPS],
                           .cut = words[HEWN_SUMMARY_CUT] + words[HEWN_SUMMARY_WORDS + HEWN_SUMMARY_CUT] > 0};
    memcpy(&out->max_residual, &words[HEWN_SUMMARY_RESIDUAL], sizeof out->max_residual);
    return HEWN_OK;
}
