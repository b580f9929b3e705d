/* The stages of the methods whose vertices lie in cells: loops and quads are counted, crossings are solved into scratch
 * memory, then every vertex and quad goes to its place. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/dual_cells.h"
#include "iso/extractor.h"
#include "iso/fixed_kernel.h"
#include "iso/host_place.h"

extern const char hewn_text_iso_head[], hewn_text_nets_vertices[], hewn_text_dual_vertices[], hewn_text_dual_asked[];

HEWN_SHADER(dual_link);
HEWN_SHADER(dual_classify);
HEWN_SHADER(dual_spread);
HEWN_SHADER(dual_quads);
HEWN_SHADER(dual_fans);

/* --- programs ----------------------------------------------------------------------------------------------------- */

static hewn_result create_table(hewn_extractor *extractor, hewn_error *error)
{
    hewn_dual_table table;
    hewn_dual_table_derive(&table);
    HEWN_TRY(hewn_buffer_create(extractor->device, "table of loops", sizeof table, HEWN_BUFFER_UPLOAD,
                                &extractor->dual.table, error));
    memcpy(extractor->dual.table.mapped, &table, sizeof table);
    return HEWN_OK;
}

static hewn_result create_fixed(hewn_extractor *extractor, hewn_error *error)
{
    hewn_dual_programs *own = &extractor->dual;
    const bool host = extractor->on_host;
    const hewn_fixed_kernel kernels[] = {
        HEWN_FIXED_KERNEL(dual_link, dual_link_push, false, !host, &own->link),
        HEWN_FIXED_KERNEL(dual_classify, dual_classify_push, true, !host, &own->classify),
        HEWN_FIXED_KERNEL(dual_spread, dual_spread_push, true, !host, &own->spread),
        HEWN_FIXED_KERNEL(dual_quads, dual_quad_push, false, !host, &own->quads),
        HEWN_FIXED_KERNEL(dual_fans, dual_fan_push, false, true, &own->fans),
    };
    return hewn_fixed_kernels_create(extractor->device, kernels, sizeof kernels / sizeof *kernels, error);
}

/* Where the host places vertices, the device only answers it. */
static hewn_program **vertex_program(hewn_extractor *extractor, hewn_method method)
{
    hewn_dual_programs *own = &extractor->dual;
    return extractor->on_host ? &own->asked : method == HEWN_METHOD_NETS ? &own->nets : &own->dc;
}

static hewn_result create_vertices(hewn_extractor *extractor, hewn_method method, hewn_error *error)
{
    hewn_kernel_desc desc = {.head = hewn_text_iso_head,
                             .flavours =
                                 HEWN_FLAVOUR_GRADIENT | HEWN_FLAVOUR_TOGETHER | hewn_extractor_flavour(extractor),
                             .push_bytes = sizeof(struct hewn_dual_vertex_push),
                             .soon = true};
    if (extractor->on_host) {
        desc.name = "dual_asked";
        desc.body = hewn_text_dual_asked;
        desc.push_bytes = sizeof(struct hewn_dual_asked_push);
    } else if (method == HEWN_METHOD_NETS) {
        desc.name = "nets_vertices";
        desc.body = hewn_text_nets_vertices;
    } else {
        desc.name = "dual_vertices";
        desc.body = hewn_text_dual_vertices;
    }
    return hewn_code_program(extractor->device, extractor->code, &desc, vertex_program(extractor, method), error);
}

hewn_result hewn_dual_prepare(hewn_extractor *extractor, hewn_method method, hewn_error *error)
{
    hewn_result result = HEWN_OK;
    if (!extractor->dual.fans) {
        result = create_table(extractor, error);
        if (result == HEWN_OK)
            result = create_fixed(extractor, error);
        if (result != HEWN_OK)
            hewn_dual_clear(extractor);
    }
    if (result == HEWN_OK && !*vertex_program(extractor, method))
        result = create_vertices(extractor, method, error);
    return result;
}

void hewn_dual_clear(hewn_extractor *extractor)
{
    hewn_dual_programs *own = &extractor->dual;
    hewn_program **programs[] = {&own->link, &own->classify, &own->spread, &own->quads,
                                 &own->fans, &own->nets,     &own->dc,     &own->asked};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        hewn_program_destroy(extractor->device, programs[i]);
    hewn_buffer_destroy(extractor->device, &own->table);
}

/* --- counting ----------------------------------------------------------------------------------------------------- */

static hewn_result take_surface(const hewn_bricks *bricks, hewn_workspace *workspace, hewn_surface *out,
                                hewn_error *error)
{
    const struct {
        const char *what;
        uint32_t words;
        const hewn_buffer **place;
    } wanted[] = {
        {"neighbours of bricks", HEWN_BRICK_LINKS, &out->links},
        {"lower neighbours of bricks", 3, &out->lower},
        {"signs of samples", HEWN_BRICK_WORDS, &out->signs},
        {"crossed edges", 2 * HEWN_BRICK_EDGE_WORDS, &out->edges},
        {"loops of cells", HEWN_BRICK_DUAL_WORDS, &out->loops},
        {"crossings a brick", 1, &out->crossing_bases},
        {"vertices a brick", 1, &out->vertex_bases},
        {"quads a brick", 1, &out->triangle_bases},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        hewn_buffer *taken;
        HEWN_TRY(hewn_workspace_take(workspace, wanted[i].what, (uint64_t)4 * wanted[i].words * bricks->count,
                                     HEWN_BUFFER_DEVICE, &taken, error));
        *wanted[i].place = taken;
    }
    return HEWN_OK;
}

static void record_classify(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                            const hewn_surface *surface, hewn_commands *commands)
{
    struct hewn_dual_link_push link = {
        .count = bricks->count, .links = surface->links->address, .lower = surface->lower->address};
    hewn_commands_fill(commands, surface->lower, 0, surface->lower->size, HEWN_ALL_OUTSIDE);
    hewn_commands_dispatch(commands, extractor->dual.link, &link, NULL,
                           hewn_groups_for((uint64_t)3 * bricks->count, 64));
    struct hewn_dual_classify_push classify = {.count = bricks->count,
                                               .bricks = bricks->list->address,
                                               .links = surface->links->address,
                                               .lower = surface->lower->address,
                                               .signs = surface->signs->address,
                                               .edges = surface->edges->address,
                                               .loops = surface->loops->address,
                                               .crossing_counts = surface->crossing_bases->address,
                                               .vertex_counts = surface->vertex_bases->address,
                                               .quad_counts = surface->triangle_bases->address};
    memcpy(classify.cells, grid->cells, sizeof classify.cells);
    hewn_commands_dispatch(commands, extractor->dual.classify, &classify, &extractor->dual.table,
                           hewn_groups_for(bricks->count, 32));
}

/* What the sums say; two triangles a quad. */
static hewn_result take_totals(const uint32_t totals[6], hewn_surface *out, hewn_error *error)
{
    uint64_t triangles = 2 * ((uint64_t)totals[5] << 32 | totals[4]);
    uint32_t pair[2] = {(uint32_t)triangles, (uint32_t)(triangles >> 32)};
    HEWN_TRY(hewn_scan_check(totals, "crossings", error));
    HEWN_TRY(hewn_scan_check(totals + 2, "vertices", error));
    HEWN_TRY(hewn_scan_check(pair, "triangles", error));
    out->crossing_count = totals[0];
    out->vertex_count = totals[2];
    out->triangle_count = triangles;
    return HEWN_OK;
}

static hewn_host_dual view_on_host(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   const hewn_bricks *bricks, const hewn_surface *surface)
{
    hewn_host_dual view = {.bricks = {.count = bricks->count,
                                      .bricks = bricks->list->mapped,
                                      .links = surface->links->mapped,
                                      .signs = surface->signs->mapped,
                                      .edges = surface->edges->mapped,
                                      .vertex_bases = surface->crossing_bases->mapped,
                                      .triangle_bases = surface->triangle_bases->mapped},
                           .table = extractor->dual.table.mapped,
                           .grid = *grid,
                           .lower = surface->lower->mapped,
                           .loops = surface->loops->mapped,
                           .vertex_bases = surface->vertex_bases->mapped};
    memcpy(view.bricks.cells, grid->cells, sizeof view.bricks.cells);
    return view;
}

/* Counts on the device, as part of the commands that made the signs. */
static hewn_result count_on_device(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   const hewn_bricks *bricks, const hewn_surface *surface, hewn_workspace *workspace,
                                   hewn_commands *commands, hewn_buffer **results, hewn_error *error)
{
    hewn_buffer *totals, *scratch;
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 24, HEWN_BUFFER_DEVICE, &totals, error));
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 24, HEWN_BUFFER_READBACK, results, error));
    HEWN_TRY(hewn_workspace_take(workspace, "scratch of sums", hewn_scan_scratch_bytes(bricks->count),
                                 HEWN_BUFFER_DEVICE, &scratch, error));
    const hewn_buffer *counts[] = {surface->crossing_bases, surface->vertex_bases, surface->triangle_bases};
    record_classify(extractor, grid, bricks, surface, commands);
    for (uint32_t i = 0; i < 3; i++)
        hewn_scan_record(extractor->scan, commands, counts[i]->address, bricks->count,
                         totals->address + (uint64_t)8 * i, scratch->address);
    hewn_commands_copy(commands, totals, 0, *results, 0, 24);
    return HEWN_OK;
}

hewn_result hewn_dual_classify(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               hewn_workspace *workspace, hewn_surface *out, hewn_error *error)
{
    hewn_buffer *results = NULL;
    uint32_t totals[6];
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
    if (extractor->on_host) {
        const hewn_host_dual view = view_on_host(extractor, grid, bricks, out);
        hewn_host_dual_count(&view, totals);
    } else {
        memcpy(totals, results->mapped, sizeof totals);
    }
    out->sign_seconds = times[1];
    return take_totals(totals, out, error);
}

/* --- emission ----------------------------------------------------------------------------------------------------- */

typedef struct emission {
    const hewn_extractor *extractor;
    const struct hewn_grid *grid;
    const hewn_bricks *bricks;
    const hewn_surface *surface;
    const hewn_buffer *buffers;     /* positions, normals, indices */
    hewn_buffer *points, *normals;  /* of crossings */
    hewn_buffer *passed;            /* edges that each vertex's loop passes */
    hewn_buffer *summary, *results; /* the mesh's, that of the crossings, and one for what is not a part's own */
    hewn_own own;
    hewn_buffer *records, *crossing; /* of vertices, of quads: where they are kept */
} emission;

static hewn_result take_emission(emission *run, uint32_t keep, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t points = 12 * run->surface->crossing_count, quads = run->surface->triangle_count / 2;
    uint64_t summary = (uint64_t)3 * 4 * HEWN_SUMMARY_WORDS;
    points += 12; /* what nobody owns at the end of a part is numbered up to one past the last */
    const struct {
        const char *what;
        uint64_t bytes;
        hewn_buffer **place;
    } wanted[] = {
        {"crossings", points, &run->points},
        {"normals of crossings", points, &run->normals},
        {"edges of loops", 4 * run->surface->vertex_count, &run->passed},
        {"summary", summary, &run->summary},
        {"records of vertices", keep == HEWN_KEEP_ALL ? run->buffers[0].size : 4, &run->records},
        {"crossings of quads", keep != HEWN_KEEP_NONE ? 4 * quads : 4, &run->crossing},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        HEWN_TRY(hewn_workspace_take(workspace, wanted[i].what, wanted[i].bytes, HEWN_BUFFER_DEVICE, wanted[i].place,
                                     error));
    return hewn_workspace_take(workspace, "summary", summary, HEWN_BUFFER_READBACK, &run->results, error);
}

static void record_spread(const emission *run, hewn_commands *commands)
{
    const hewn_surface *surface = run->surface;
    struct hewn_dual_spread_push push = {.count = run->bricks->count,
                                         .bricks = run->bricks->list->address,
                                         .links = surface->links->address,
                                         .signs = surface->signs->address,
                                         .edges = surface->edges->address,
                                         .loops = surface->loops->address,
                                         .crossing_bases = surface->crossing_bases->address,
                                         .vertex_bases = surface->vertex_bases->address,
                                         .quad_bases = surface->triangle_bases->address,
                                         .points = run->points->address,
                                         .positions = run->buffers[0].address,
                                         .passed = run->passed->address,
                                         .indices = run->buffers[2].address};
    memcpy(push.cells, run->grid->cells, sizeof push.cells);
    hewn_commands_dispatch(commands, run->extractor->dual.spread, &push, &run->extractor->dual.table,
                           hewn_groups_for(run->bricks->count, 32));
}

/* Vertices and quads need crossings of their own brick and of those after it. Those of a part's own bricks are summed
 * up, the others are not. */
static void record_crossings(const emission *run, hewn_commands *commands)
{
    const hewn_own *own = &run->own;
    const uint64_t ends[3] = {own->crossings[0], own->crossings[1], run->surface->crossing_count};
    for (int i = 0; i < 2; i++) {
        uint64_t summary = (uint64_t)4 * HEWN_SUMMARY_WORDS * (i == 0 ? 1 : 2);
        hewn_crossings crossings = {.first = ends[i],
                                    .end = ends[i + 1],
                                    .dual = true,
                                    .bases = own->bases[i],
                                    .positions = run->points,
                                    .normals = run->normals,
                                    .summary = run->summary->address + summary};
        hewn_crossings_record(run->extractor, run->grid, run->bricks, &crossings, commands);
    }
}

/* Quads name vertices of their own brick and of those after it. */
static void record_vertices(const emission *run, hewn_method method, hewn_commands *commands)
{
    const hewn_surface *surface = run->surface;
    const hewn_buffer *uniforms = hewn_code_uniforms(run->extractor->code);
    const hewn_dual_programs *programs = &run->extractor->dual;
    const uint64_t ends[3] = {run->own.vertices[0], run->own.vertices[1], surface->vertex_count};
    for (int i = 0; i < 2; i++) {
        uint64_t count = ends[i + 1] - ends[i], summary = (uint64_t)4 * HEWN_SUMMARY_WORDS * (i == 0 ? 0 : 2);
        struct hewn_dual_vertex_push vertices = {.grid = *run->grid,
                                                 .count = (uint32_t)count,
                                                 .beyond = run->bricks->beyond,
                                                 .bricks = run->bricks->list->address,
                                                 .links = surface->links->address,
                                                 .edges = surface->edges->address,
                                                 .points = run->points->address,
                                                 .point_normals = run->normals->address,
                                                 .positions = run->buffers[0].address + 12 * ends[i],
                                                 .normals = run->buffers[1].address + 12 * ends[i],
                                                 .summary = run->summary->address + summary};
        if (count > 0)
            hewn_commands_dispatch(commands, method == HEWN_METHOD_NETS ? programs->nets : programs->dc, &vertices,
                                   uniforms, hewn_groups_for(count, 64));
    }
}

static void record_quads(const emission *run, uint32_t keep, hewn_commands *commands)
{
    const hewn_surface *surface = run->surface;
    uint64_t first = run->own.triangles[0] / 2, quads = run->own.triangles[1] / 2 - first;
    struct hewn_dual_quad_push push = {.grid = *run->grid,
                                       .count = (uint32_t)quads,
                                       .keep = keep,
                                       .bricks = run->bricks->list->address,
                                       .links = surface->links->address,
                                       .edges = surface->edges->address,
                                       .loops = surface->loops->address,
                                       .passed = run->passed->address,
                                       .points = run->points->address,
                                       .positions = run->buffers[0].address,
                                       .indices = run->buffers[2].address + 24 * first,
                                       .crossings = run->crossing->address + (keep != HEWN_KEEP_NONE ? 4 * first : 0)};
    if (quads > 0)
        hewn_commands_dispatch(commands, run->extractor->dual.quads, &push, NULL, hewn_groups_for(quads, 64));
}

static void read_summary(const uint32_t *words, hewn_emission *out)
{
    out->caps = words[HEWN_SUMMARY_CAPS];
    out->edge_vertices = words[HEWN_SUMMARY_EDGES];
    out->corner_vertices = words[HEWN_SUMMARY_CORNERS];
    out->planes_found = words[HEWN_SUMMARY_PLANES];
    out->features_lost = words[HEWN_SUMMARY_LOST];
    memcpy(&out->max_residual, &words[HEWN_SUMMARY_RESIDUAL], sizeof out->max_residual);
    out->capped_crossings = words[HEWN_SUMMARY_WORDS + HEWN_SUMMARY_CAPS];
    for (uint32_t i = 0; i < 3; i++)
        out->cut = out->cut || words[i * HEWN_SUMMARY_WORDS + HEWN_SUMMARY_CUT] > 0;
}

static hewn_result emit_on_device(const emission *run, hewn_method method, uint32_t keep, hewn_emission *out,
                                  hewn_error *error)
{
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
    hewn_commands_fill(commands, run->summary, 0, run->summary->size, 0);
    record_spread(run, commands);
    if (keep == HEWN_KEEP_ALL)
        hewn_commands_copy(commands, &run->buffers[0], 0, run->records, 0, run->buffers[0].size);
    record_crossings(run, commands);
    record_vertices(run, method, commands);
    record_quads(run, keep, commands);
    hewn_commands_copy(commands, run->summary, 0, run->results, 0, run->summary->size);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    read_summary(run->results->mapped, out);
    return HEWN_OK;
}

static hewn_result solve_crossings(const emission *run, hewn_error *error)
{
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
    hewn_commands_fill(commands, run->summary, 0, run->summary->size, 0);
    record_crossings(run, commands);
    return hewn_commands_submit(&commands, NULL, error);
}

/* The device solves crossings and answers; all else is the host's. */
static hewn_result emit_on_host(const emission *run, hewn_method method, uint32_t keep, hewn_workspace *workspace,
                                hewn_emission *out, hewn_error *error)
{
    const hewn_own *own = &run->own;
    hewn_host_dual view = view_on_host(run->extractor, run->grid, run->bricks, run->surface);
    view.bricks.vertices = run->points->mapped;
    view.points = run->points->mapped;
    view.positions = run->buffers[0].mapped;
    view.passed = run->passed->mapped;
    view.indices = run->buffers[2].mapped;
    view.crossings = run->crossing->mapped;
    view.keep = keep;
    hewn_host_dual_spread(&view);
    if (keep == HEWN_KEEP_ALL)
        memcpy(run->records->mapped, run->buffers[0].mapped, run->buffers[0].size);
    HEWN_TRY(solve_crossings(run, error));
    hewn_emission sums = {0};
    const hewn_placing placing = {.extractor = run->extractor,
                                  .bricks = run->bricks,
                                  .dual = &view,
                                  .point_normals = run->normals->mapped,
                                  .normals = run->buffers[1].mapped,
                                  .method = method,
                                  .summary = run->summary->address};
    HEWN_TRY(hewn_host_place(&placing, own->vertices, run->surface->vertex_count, workspace, &sums, error));
    uint32_t first = own->part ? (uint32_t)own->bricks[0] : 0;
    hewn_host_dual_quads(&view, first, own->part ? (uint32_t)own->bricks[1] : run->bricks->count);
    hewn_emission seen = {0};
    read_summary(run->summary->mapped, &seen);
    sums.capped_crossings = seen.capped_crossings;
    sums.cut = seen.cut;
    *out = sums;
    return HEWN_OK;
}

hewn_result hewn_dual_emit(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                           const hewn_surface *surface, hewn_method method, const hewn_buffer buffers[3],
                           hewn_workspace *workspace, uint32_t keep, hewn_dual_hermite *kept, hewn_emission *out,
                           hewn_error *error)
{
    emission run = {.extractor = extractor, .grid = grid, .bricks = bricks, .surface = surface, .buffers = buffers};
    run.own = hewn_surface_own(surface);
    HEWN_TRY(take_emission(&run, keep, workspace, error));
    HEWN_TRY(extractor->on_host ? emit_on_host(&run, method, keep, workspace, out, error)
                                : emit_on_device(&run, method, keep, out, error));
    if (keep != HEWN_KEEP_NONE)
        *kept = (hewn_dual_hermite){run.points, run.normals, run.records, run.crossing};
    return HEWN_OK;
}
