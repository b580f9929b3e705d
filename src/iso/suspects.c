/* Features thinner than a cell: cells far from all sign changes whose intervals do not exclude surface. */
#include <string.h>

#include "base/error.h"
#include "iso/extractor.h"
#include "iso/host_remote.h"
#include "iso/host_surface.h"

/* A search and its buffers. */
typedef struct search {
    const hewn_extractor *extractor;
    const struct hewn_grid *grid;
    const hewn_bricks *bricks;
    const hewn_surface *surface;
    hewn_buffer *cuts, *remote, *marks, *counts, *results;
} search;

static hewn_result take_buffers(search *run, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t words = (uint64_t)4 * run->bricks->count, counts = 4 * HEWN_SUSPECT_WORDS;
    const struct {
        const char *what;
        uint64_t bytes;
        hewn_buffer_use use;
        hewn_buffer **place;
    } wanted[] = {
        {"blocks with surface", 2 * words, HEWN_BUFFER_DEVICE, &run->cuts},
        {"blocks without", 2 * words, HEWN_BUFFER_DEVICE, &run->remote},
        {"marks of suspects", HEWN_BRICK_WORDS * words, HEWN_BUFFER_DEVICE, &run->marks},
        {"counts of suspects", counts, HEWN_BUFFER_DEVICE, &run->counts},
        {"counts of suspects", counts, HEWN_BUFFER_READBACK, &run->results},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        HEWN_TRY(
            hewn_workspace_take(workspace, wanted[i].what, wanted[i].bytes, wanted[i].use, wanted[i].place, error));
    return HEWN_OK;
}

static void record_cuts(const search *run, hewn_commands *commands)
{
    struct hewn_cut_push push = {.count = run->bricks->count,
                                 .bricks = run->bricks->list->address,
                                 .links = run->surface->links->address,
                                 .signs = run->surface->signs->address,
                                 .cuts = run->cuts->address};
    memcpy(push.cells, run->grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, run->extractor->suspects.cuts, &push, NULL,
                           hewn_groups_for(run->bricks->count, 32));
}

static void record_remote(const search *run, hewn_commands *commands)
{
    struct hewn_remote_push push = {.levels = run->bricks->levels,
                                    .count = run->bricks->count,
                                    .bricks = run->bricks->list->address,
                                    .cuts = run->cuts->address,
                                    .remote = run->remote->address};
    memcpy(push.top, run->bricks->top, sizeof push.top);
    for (uint32_t i = 0; i < run->bricks->levels; i++)
        push.states[i] = run->bricks->states[i]->address;
    hewn_commands_dispatch(commands, run->extractor->suspects.remote, &push, NULL,
                           hewn_groups_for(run->bricks->count, 32));
    const hewn_own *own = &run->surface->own;
    if (own->part && own->bricks[0] > 0) /* others' bricks are not asked */
        hewn_commands_fill(commands, run->remote, 0, 8 * own->bricks[0], 0);
    if (own->part && own->bricks[1] < run->bricks->count)
        hewn_commands_fill(commands, run->remote, 8 * own->bricks[1], 8 * (run->bricks->count - own->bricks[1]), 0);
}

/* Both on the host, before any command runs. */
static void find_remote_on_host(const search *run)
{
    hewn_host_surface surface = {.count = run->bricks->count,
                                 .bricks = run->bricks->list->mapped,
                                 .links = run->surface->links->mapped,
                                 .signs = run->surface->signs->mapped};
    memcpy(surface.cells, run->grid->cells, sizeof surface.cells);
    hewn_host_surface_cut(&surface, run->cuts->mapped);
    hewn_host_remote view = {.levels = run->bricks->levels,
                             .count = run->bricks->count,
                             .bricks = surface.bricks,
                             .cuts = run->cuts->mapped};
    memcpy(view.top, run->bricks->top, sizeof view.top);
    for (uint32_t i = 0; i < run->bricks->levels; i++)
        view.states[i] = run->bricks->states[i]->mapped;
    hewn_host_remote_find(&view, run->remote->mapped);
    const hewn_own *own = &run->surface->own;
    for (uint32_t i = 0; i < run->bricks->count && own->part; i++) /* others' bricks are not asked */
        if (i < own->bricks[0] || i >= own->bricks[1])
            memset((uint32_t *)run->remote->mapped + (uint64_t)2 * i, 0, 8);
}

static void record_find(const search *run, hewn_commands *commands)
{
    struct hewn_suspect_push push = {.grid = *run->grid,
                                     .count = run->bricks->count,
                                     .bricks = run->bricks->list->address,
                                     .signs = run->surface->signs->address,
                                     .remote = run->remote->address,
                                     .marks = run->marks->address,
                                     .counts = run->counts->address};
    hewn_commands_fill(commands, run->counts, 0, run->counts->size, 0);
    hewn_commands_dispatch(commands, run->extractor->suspects.find, &push, hewn_code_uniforms(run->extractor->code),
                           hewn_groups_for((uint64_t)8 * run->bricks->count, 64));
}

/* --- the first ---------------------------------------------------------------------------------------------------- */

static bool comes_before(const uint32_t a[3], const uint32_t b[3])
{
    for (int axis = 2; axis >= 0; axis--)
        if (a[axis] != b[axis])
            return a[axis] < b[axis];
    return false;
}

/* Takes the cells that a word marks into account; struct hewn_suspect_push has their order. */
static void look_in_word(uint32_t packed, uint32_t word, uint32_t mark, uint32_t first[3])
{
    for (uint32_t bit = 0; bit < 32; bit++) {
        uint32_t number = bit + 32 * (word % 2), block = word / 2, cell[3];
        if (!(mark >> bit & 1u))
            continue;
        for (uint32_t axis = 0; axis < 3; axis++) {
            uint32_t in_block = (number >> axis & 1u) + 2 * (number >> (axis + 3) & 1u);
            cell[axis] = 8 * (packed >> 10 * axis & 1023u) + 4 * (block >> axis & 1u) + in_block;
        }
        if (comes_before(cell, first))
            memcpy(first, cell, sizeof cell);
    }
}

/* Seldom needed, so the host looks: only where there are any do the marks come home. */
static hewn_result find_first(const hewn_bricks *bricks, hewn_workspace *workspace, hewn_suspects *out,
                              hewn_error *error)
{
    hewn_buffer *list, *marks;
    uint64_t list_bytes = (uint64_t)4 * bricks->count, mark_bytes = HEWN_BRICK_WORDS * list_bytes;
    HEWN_TRY(hewn_workspace_take(workspace, "bricks on the host", list_bytes, HEWN_BUFFER_READBACK, &list, error));
    HEWN_TRY(hewn_workspace_take(workspace, "suspects on the host", mark_bytes, HEWN_BUFFER_READBACK, &marks, error));
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(workspace->device, &commands, error));
    hewn_commands_copy(commands, bricks->list, 0, list, 0, list_bytes);
    hewn_commands_copy(commands, out->marks, 0, marks, 0, mark_bytes);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    const uint32_t *packed = list->mapped, *words = marks->mapped;
    memset(out->first, 0xFF, sizeof out->first);
    for (uint64_t i = 0; i < (uint64_t)HEWN_BRICK_WORDS * bricks->count; i++)
        if (words[i] != 0)
            look_in_word(packed[i / HEWN_BRICK_WORDS], (uint32_t)(i % HEWN_BRICK_WORDS), words[i], out->first);
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

hewn_result hewn_suspects_find(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               const hewn_surface *surface, hewn_workspace *workspace, hewn_suspects *out,
                               hewn_error *error)
{
    search run = {.extractor = extractor, .grid = grid, .bricks = bricks, .surface = surface};
    *out = (hewn_suspects){0};
    HEWN_TRY(take_buffers(&run, workspace, error));
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    if (extractor->on_host) {
        find_remote_on_host(&run);
    } else {
        record_cuts(&run, commands);
        record_remote(&run, commands);
    }
    record_find(&run, commands);
    hewn_commands_copy(commands, run.counts, 0, run.results, 0, run.results->size);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    const uint32_t *words = run.results->mapped;
    out->marks = run.marks;
    out->cells = words[HEWN_SUSPECT_CELLS] | (uint64_t)words[HEWN_SUSPECT_CELLS + 1] << 32;
    out->undefined = words[HEWN_SUSPECT_UNDEFINED] | (uint64_t)words[HEWN_SUSPECT_UNDEFINED + 1] << 32;
    if (out->cells > 0)
        HEWN_TRY(find_first(bricks, workspace, out, error));
    for (int axis = 0; axis < 3 && out->cells > 0; axis++)
        out->first[axis] -= grid->rim;
    return HEWN_OK;
}
