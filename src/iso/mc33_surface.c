/* The stages that marching cubes needs in addition for the trilinear interpolant's topology: ask the values of the
 * cells that signs alone do not decide, count again, and emit with vertices in cells. */
#include <string.h>

#include "base/error.h"
#include "iso/extractor.h"
#include "iso/fixed_kernel.h"
#include "iso/host_mc33.h"
#include "iso/mc33.h"

extern const char hewn_text_iso_head[], hewn_text_mc33_decide[], hewn_text_mc33_centres[];

HEWN_SHADER(mc33_ask);
HEWN_SHADER(mc33_count);
HEWN_SHADER(mc33_spread);
HEWN_SHADER(mc33_triangles);

/* --- programs ----------------------------------------------------------------------------------------------------- */

static hewn_result create_table(hewn_extractor *extractor, hewn_error *error)
{
    hewn_mc33_table table;
    HEWN_TRY(hewn_mc33_table_derive(&table, error));
    uint64_t bytes = table.count * sizeof *table.words;
    hewn_result result = hewn_buffer_create(extractor->device, "table of configurations", bytes, HEWN_BUFFER_UPLOAD,
                                            &extractor->mc33.table, error);
    if (result == HEWN_OK)
        memcpy(extractor->mc33.table.mapped, table.words, bytes);
    hewn_mc33_table_destroy(&table);
    return result;
}

/* Where the host does what they do they are not made, and not compiled. */
static hewn_result create_fixed(hewn_extractor *extractor, hewn_error *error)
{
    hewn_mc33_programs *own = &extractor->mc33;
    const hewn_fixed_kernel kernels[] = {
        HEWN_FIXED_KERNEL(mc33_ask, mc33_ask_push, false, true, &own->ask),
        HEWN_FIXED_KERNEL(mc33_count, mc33_count_push, false, true, &own->count),
        HEWN_FIXED_KERNEL(mc33_spread, mc33_spread_push, false, true, &own->spread),
        HEWN_FIXED_KERNEL(mc33_triangles, triangle_push, false, true, &own->triangles),
    };
    return hewn_fixed_kernels_create(extractor->device, kernels, sizeof kernels / sizeof *kernels, error);
}

static hewn_result create_all(hewn_extractor *extractor, hewn_error *error)
{
    HEWN_TRY(create_table(extractor, error));
    const uint32_t near = hewn_extractor_flavour(extractor);
    hewn_kernel_desc decide = {"mc33_decide",
                               hewn_text_iso_head,
                               hewn_text_mc33_decide,
                               HEWN_FLAVOUR_POINT | near,
                               sizeof(struct hewn_mc33_decide_push),
                               .soon = true};
    /* Most meshes have no vertices in cells. */
    hewn_kernel_desc centres = {"mc33_centres",
                                hewn_text_iso_head,
                                hewn_text_mc33_centres,
                                HEWN_FLAVOUR_GRADIENT | near,
                                sizeof(struct hewn_mc33_centre_push),
                                .soon = false};
    HEWN_TRY(hewn_code_program(extractor->device, extractor->code, &decide, &extractor->mc33.decide, error));
    return hewn_code_program(extractor->device, extractor->code, &centres, &extractor->mc33.centres, error);
}

hewn_result hewn_mc33_prepare(hewn_extractor *extractor, hewn_error *error)
{
    hewn_result result = extractor->mc33.centres ? HEWN_OK : create_all(extractor, error);
    if (result == HEWN_OK && !extractor->on_host && !extractor->mc33.triangles)
        result = create_fixed(extractor, error);
    if (result != HEWN_OK)
        hewn_mc33_clear(extractor);
    return result;
}

void hewn_mc33_clear(hewn_extractor *extractor)
{
    hewn_mc33_programs *own = &extractor->mc33;
    hewn_program **programs[] = {&own->ask, &own->decide, &own->count, &own->spread, &own->triangles, &own->centres};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        hewn_program_destroy(extractor->device, programs[i]);
    hewn_buffer_destroy(extractor->device, &own->table);
}

/* --- counting ----------------------------------------------------------------------------------------------------- */

typedef struct refinement {
    const hewn_extractor *extractor;
    const struct hewn_grid *grid;
    const hewn_bricks *bricks;
    hewn_surface *surface;
    hewn_buffer *ranks, *triangles, *centres;
    hewn_buffer *totals, *results, *scratch; /* not on the host */
    uint32_t sums[6];                        /* asked cells, triangles and vertices in cells, each in two words */
} refinement;

static hewn_result take_buffers(refinement *run, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t a_brick = (uint64_t)4 * run->bricks->count;
    const struct {
        const char *what;
        uint64_t bytes;
        hewn_buffer_use use;
        hewn_buffer **place;
    } wanted[] = {
        {"asked cells a brick", a_brick, HEWN_BUFFER_DEVICE, &run->ranks},
        {"triangles a brick", a_brick, HEWN_BUFFER_DEVICE, &run->triangles},
        {"vertices in cells a brick", a_brick, HEWN_BUFFER_DEVICE, &run->centres},
        {"totals", 24, HEWN_BUFFER_DEVICE, &run->totals},
        {"totals", 24, HEWN_BUFFER_READBACK, &run->results},
        {"scratch of sums", hewn_scan_scratch_bytes(run->bricks->count), HEWN_BUFFER_DEVICE, &run->scratch},
    };
    const size_t count = run->extractor->on_host ? 3 : sizeof wanted / sizeof *wanted;
    for (size_t i = 0; i < count; i++)
        HEWN_TRY(
            hewn_workspace_take(workspace, wanted[i].what, wanted[i].bytes, wanted[i].use, wanted[i].place, error));
    return HEWN_OK;
}

static void record_ask(const refinement *run, uint64_t asked, hewn_commands *commands)
{
    struct hewn_mc33_ask_push push = {.count = run->bricks->count,
                                      .lists = asked != 0,
                                      .bricks = run->bricks->list->address,
                                      .links = run->surface->links->address,
                                      .signs = run->surface->signs->address,
                                      .table = run->extractor->mc33.table.address,
                                      .ranks = run->ranks->address,
                                      .asked = asked};
    memcpy(push.cells, run->grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, run->extractor->mc33.ask, &push, NULL, hewn_groups_for(run->bricks->count, 32));
}

static void record_sum(const refinement *run, const hewn_buffer *counts, uint32_t total, hewn_commands *commands)
{
    hewn_scan_record(run->extractor->scan, commands, counts->address, run->bricks->count,
                     run->totals->address + (uint64_t)8 * total, run->scratch->address);
}

static void record_count(const refinement *run, uint64_t asked, hewn_commands *commands)
{
    struct hewn_mc33_count_push push = {.count = run->bricks->count,
                                        .bricks = run->bricks->list->address,
                                        .links = run->surface->links->address,
                                        .signs = run->surface->signs->address,
                                        .table = run->extractor->mc33.table.address,
                                        .ranks = run->ranks->address,
                                        .asked = asked,
                                        .triangle_counts = run->triangles->address,
                                        .centre_counts = run->centres->address};
    memcpy(push.cells, run->grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, run->extractor->mc33.count, &push, NULL, hewn_groups_for(run->bricks->count, 32));
}

/* Views of what the host needs before emission. */
static hewn_host_mc33 view_on_host(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   const hewn_bricks *bricks, const hewn_surface *surface)
{
    hewn_host_mc33 view = {.surface = {.count = bricks->count,
                                       .bricks = bricks->list->mapped,
                                       .links = surface->links->mapped,
                                       .signs = surface->signs->mapped,
                                       .edges = surface->edges->mapped,
                                       .vertex_bases = surface->vertex_bases->mapped},
                           .table = extractor->mc33.table.mapped};
    memcpy(view.surface.cells, grid->cells, sizeof view.surface.cells);
    return view;
}

static hewn_host_mc33 view_of(const refinement *run, const hewn_buffer *asked)
{
    hewn_host_mc33 view = view_on_host(run->extractor, run->grid, run->bricks, run->surface);
    view.surface.triangle_bases = run->triangles->mapped;
    view.ranks = run->ranks->mapped;
    view.centre_bases = run->centres->mapped;
    view.asked = asked ? asked->mapped : NULL;
    return view;
}

static hewn_result find_asked(refinement *run, hewn_error *error)
{
    if (run->extractor->on_host) {
        const hewn_host_mc33 view = view_of(run, NULL);
        hewn_host_mc33_rank(&view, run->sums);
    } else {
        hewn_commands *commands;
        HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
        record_ask(run, 0, commands);
        record_sum(run, run->ranks, 0, commands);
        hewn_commands_copy(commands, run->totals, 0, run->results, 0, 8);
        HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
        memcpy(run->sums, run->results->mapped, 8);
    }
    return hewn_scan_check(run->sums, "cells that values decide", error);
}

static void record_decide(const refinement *run, const hewn_buffer *asked, hewn_commands *commands)
{
    struct hewn_mc33_decide_push push = {.grid = *run->grid,
                                         .count = run->sums[0],
                                         .bricks = run->bricks->list->address,
                                         .table = run->extractor->mc33.table.address,
                                         .asked = asked->address};
    hewn_commands_dispatch(commands, run->extractor->mc33.decide, &push, hewn_code_uniforms(run->extractor->code),
                           hewn_groups_for(run->sums[0], 64));
}

static hewn_result decide_and_count(refinement *run, const hewn_buffer *asked, hewn_error *error)
{
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
    if (run->sums[0] > 0) {
        record_ask(run, asked->address, commands);
        record_decide(run, asked, commands);
    }
    record_count(run, asked->address, commands);
    record_sum(run, run->triangles, 1, commands);
    record_sum(run, run->centres, 2, commands);
    hewn_commands_copy(commands, run->totals, 0, run->results, 0, 24);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    memcpy(run->sums, run->results->mapped, sizeof run->sums);
    return HEWN_OK;
}

/* The host asks and counts, and the device decides in between. */
static hewn_result decide_and_count_on_host(refinement *run, const hewn_buffer *asked, hewn_error *error)
{
    const hewn_host_mc33 view = view_of(run, asked);
    if (run->sums[0] > 0) {
        hewn_host_mc33_ask(&view);
        hewn_commands *commands;
        HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
        record_decide(run, asked, commands);
        HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    }
    hewn_host_mc33_count(&view, run->sums + 2);
    return HEWN_OK;
}

hewn_result hewn_mc33_refine(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                             hewn_workspace *workspace, hewn_surface *surface, hewn_error *error)
{
    refinement run = {.extractor = extractor, .grid = grid, .bricks = bricks, .surface = surface};
    hewn_buffer *asked;
    HEWN_TRY(take_buffers(&run, workspace, error));
    HEWN_TRY(find_asked(&run, error));
    HEWN_TRY(
        hewn_workspace_take(workspace, "asked cells", (uint64_t)8 * run.sums[0], HEWN_BUFFER_DEVICE, &asked, error));
    HEWN_TRY(extractor->on_host ? decide_and_count_on_host(&run, asked, error) : decide_and_count(&run, asked, error));
    const uint32_t *triangles = run.sums + 2, *centres = run.sums + 4;
    HEWN_TRY(hewn_scan_check(triangles, "triangles", error));
    HEWN_TRY(hewn_scan_check(centres, "vertices in cells", error));
    uint32_t sum[2] = {(uint32_t)(surface->vertex_count + centres[0]),
                       (uint32_t)((surface->vertex_count + centres[0]) >> 32)};
    HEWN_TRY(hewn_scan_check(sum, "vertices", error));
    surface->triangle_count = triangles[0];
    surface->centre_count = centres[0];
    surface->vertex_count += centres[0];
    surface->triangle_bases = run.triangles;
    surface->centre_bases = run.centres;
    surface->ranks = run.ranks;
    surface->asked = asked;
    return HEWN_OK;
}

/* --- emission ----------------------------------------------------------------------------------------------------- */

void hewn_mc33_record_spread(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                             const hewn_surface *surface, const hewn_buffer buffers[3], hewn_commands *commands)
{
    struct hewn_mc33_spread_push push = {.count = bricks->count,
                                         .bricks = bricks->list->address,
                                         .links = surface->links->address,
                                         .signs = surface->signs->address,
                                         .edges = surface->edges->address,
                                         .table = extractor->mc33.table.address,
                                         .ranks = surface->ranks->address,
                                         .asked = surface->asked->address,
                                         .vertex_bases = surface->vertex_bases->address,
                                         .triangle_bases = surface->triangle_bases->address,
                                         .centre_bases = surface->centre_bases->address,
                                         .vertices = buffers[0].address,
                                         .indices = buffers[2].address,
                                         .first = (uint32_t)(surface->vertex_count - surface->centre_count)};
    memcpy(push.cells, grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, extractor->mc33.spread, &push, NULL, hewn_groups_for(bricks->count, 32));
}

void hewn_mc33_emit_on_host(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                            const hewn_surface *surface, const hewn_buffer buffers[3])
{
    hewn_host_mc33 view = view_on_host(extractor, grid, bricks, surface);
    view.surface.triangle_bases = surface->triangle_bases->mapped;
    view.surface.vertices = buffers[0].mapped;
    view.surface.indices = buffers[2].mapped;
    view.ranks = surface->ranks->mapped;
    view.asked = surface->asked->mapped;
    view.centre_bases = surface->centre_bases->mapped;
    view.first_centre = surface->vertex_count - surface->centre_count;
    const hewn_own own = hewn_surface_own(surface);
    hewn_host_mc33_emit(&view, own.part ? (uint32_t)own.bricks[0] : 0,
                        own.part ? (uint32_t)own.bricks[1] : bricks->count);
}

void hewn_mc33_record_centres(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                              const hewn_surface *surface, const hewn_buffer buffers[3], const hewn_buffer *summary,
                              hewn_commands *commands)
{
    hewn_own own = hewn_surface_own(surface);
    uint64_t count = own.centres[1] - own.centres[0];
    uint64_t first = surface->vertex_count - surface->centre_count + own.centres[0];
    if (count == 0)
        return;
    struct hewn_mc33_centre_push push = {.grid = *grid,
                                         .count = (uint32_t)count,
                                         .first = (uint32_t)first,
                                         .bricks = bricks->list->address,
                                         .links = surface->links->address,
                                         .edges = surface->edges->address,
                                         .positions = buffers[0].address,
                                         .normals = buffers[1].address,
                                         .summary = summary->address};
    hewn_commands_dispatch(commands, extractor->mc33.centres, &push, hewn_code_uniforms(extractor->code),
                           hewn_groups_for(count, 64));
}
