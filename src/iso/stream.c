/* A mesh in parts. Bricks come in their order, and so do vertices and triangles, so a part's own are runs of the
 * whole's. A first pass over the parts counts vertices; then every brick's first vertex is known, and a second pass can
 * name vertices of other parts. In that pass the sink takes a part while the next one is made.
 *
 * Whose bytes are whose: the device counts its buffers, which are the workspace of the part at work with all that it
 * needs on the host, its mesh, and the mesh of the part that the sink has. `host` counts the rest: the table of bricks,
 * and what the sink holds, or while it has a part, the most that it may hold meanwhile. The sink has a part from
 * hand_over() until this thread has waited for it, no matter when it is done. So what counts, and how large parts are,
 * follows from the parts before and never from time. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "gpu/device.h"
#include "iso/handing.h"
#include "iso/part.h"

/* Of all bricks, by number, and where there is room for more. */
typedef struct brick_table {
    uint32_t *numbers, *bases; /* and the first vertex of each */
    size_t count, number_room, base_room;
} brick_table;

typedef struct stream {
    hewn_extraction run;
    const hewn_mesh_sink *sink;
    hewn_handing handing; /* the part before the one at work, while the sink has it */
    hewn_region whole;
    brick_table table;
    hewn_number_run open;
    uint64_t crossings, named, triangles; /* of the whole: of vertices those that bases tell of; no fans' triangles */
    uint64_t done, done_centres, done_capped; /* in the second pass; fans' vertices are centres */
    uint64_t done_triangles, done_fans;
    hewn_box first_suspect_cell; /* lo: coordinates of the first one so far */
    uint64_t device_before;      /* bytes that the device held before the run: they do not count */
    uint64_t device_peak;        /* the device's own record, which goes on after the run */
    uint64_t host;               /* bytes that count beside those of the device */
    uint64_t begun, most;        /* bytes when the part at work was begun, and at the most since */
    uint64_t refused; /* bytes that the part at work would have come to where it was refused; 0: it was not */
    double share;     /* of the budget that the last part and another one like it take; 0: not known */
    bool decided;     /* no smaller part would have fared better than the last one */
} stream;

/* --- memory ------------------------------------------------------------------------------------------------------- */

/* What lies on the host from part to part. */
static uint64_t kept_bytes(const stream *of)
{
    return 4 * (uint64_t)(of->table.number_room + of->table.base_room);
}

/* What the sink holds, or with `part` would hold at the most: not to be asked about a part while it has one. */
static uint64_t sink_bytes(const stream *of, const hewn_mesh_part *part)
{
    if (of->handing.under_way)
        return of->handing.host_bytes;
    return of->sink->bytes ? of->sink->bytes(of->sink->user, part) : 0;
}

static uint64_t bytes_now(const stream *of)
{
    return of->run.extractor->device->bytes - of->device_before + of->host;
}

/* Notes what was in use at the most since `host` last changed. */
static void note_peak(stream *of)
{
    hewn_device *device = of->run.extractor->device;
    hewn_extract_stats *stats = of->run.stats;
    uint64_t peak = device->peak_bytes - of->device_before + of->host;
    of->device_peak = device->peak_bytes > of->device_peak ? device->peak_bytes : of->device_peak;
    device->peak_bytes = device->bytes;
    of->most = peak > of->most ? peak : of->most;
    stats->peak_memory = peak > stats->peak_memory ? peak : stats->peak_memory;
}

/* From now on so many bytes of the host count. The device may take what they leave; where it holds more than that they
 * are refused. Comes before the host takes them. */
static hewn_result reckon_host(stream *of, uint64_t host, hewn_error *error)
{
    hewn_device *device = of->run.extractor->device;
    uint64_t most = of->run.desc->max_memory, held = device->bytes - of->device_before;
    if (most > 0 && (host > most || held > most - host)) {
        of->refused = held + host;
        return hewn_fail(error, HEWN_OUT_OF_DEVICE_MEMORY,
                         "%llu bytes on the host, with %llu on the device, are more than the %llu that are allowed",
                         (unsigned long long)host, (unsigned long long)held, (unsigned long long)most);
    }
    note_peak(of);
    of->host = host;
    if (most > INT64_MAX) /* as good as none */
        device->most_bytes = 0;
    else if (most > 0) /* at least a byte: 0 is no limit */
        device->most_bytes = of->device_before + (most > host ? most - host : 1);
    return HEWN_OK;
}

/* --- parts of the right size -------------------------------------------------------------------------------------- */

typedef hewn_result (*part_work)(stream *of, hewn_part *part, hewn_error *error);

static void note_share(stream *of, uint64_t bytes)
{
    if (of->run.desc->max_memory > 0)
        of->share = (double)bytes / (double)of->run.desc->max_memory;
}

static hewn_result make_part(stream *of, const hewn_region *region, bool counts_only, part_work work, hewn_error *error)
{
    hewn_part part;
    HEWN_TRY(reckon_host(of, kept_bytes(of) + sink_bytes(of, NULL), error));
    of->begun = of->most = bytes_now(of);
    HEWN_TRY(hewn_part_open(&of->run, region, counts_only, &part, error));
    return work(of, &part, error);
}

static hewn_result try_part(stream *of, uint32_t begin, uint32_t end, bool counts_only, part_work work,
                            hewn_error *error)
{
    hewn_device *device = of->run.extractor->device;
    hewn_region region = of->whole;
    region.begin = begin;
    region.end = end;
    device->refused_bytes = 0;
    of->refused = 0;
    of->share = 0;
    of->decided = false;
    hewn_result result = make_part(of, &region, counts_only, work, error);
    hewn_workspace_clear(&of->run.workspace);
    note_peak(of);
    if (counts_only)
        note_share(of, of->most);
    if (device->refused_bytes > 0)
        of->refused = device->refused_bytes - of->device_before + of->host;
    return result;
}

static bool was_refused(const stream *of, hewn_result result)
{
    return !of->decided && result == HEWN_OUT_OF_DEVICE_MEMORY && of->refused > 0;
}

/* Whether a smaller part may do better. */
static bool was_too_large(const stream *of, hewn_result result)
{
    return was_refused(of, result) || (!of->decided && result == HEWN_LIMIT);
}

static hewn_result fail_least(const stream *of, hewn_result result, hewn_error *error)
{
    if (!was_refused(of, result))
        return result;
    return hewn_fail(error, result,
                     "the least part of this mesh needs at least %llu bytes, more than the %llu that are allowed",
                     (unsigned long long)of->refused, (unsigned long long)of->run.desc->max_memory);
}

/* What goes wrong in the sink is not a matter of the size of the part at work. */
static hewn_result wait_for_sink(stream *of, hewn_error *error)
{
    hewn_result result = hewn_handing_end(&of->handing, of->run.extractor->device, error);
    of->decided = of->decided || result != HEWN_OK;
    return result;
}

/* The number of the brick before whose first vertex lie `most` more than before `begin`. */
static uint32_t number_after(const stream *of, uint32_t begin, uint64_t most)
{
    const brick_table *table = &of->table;
    uint64_t low = 0, high = table->count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        bool below = table->numbers[middle] < begin || table->bases[middle] <= of->done + most;
        low = below ? middle + 1 : low;
        high = below ? high : middle;
    }
    return low < table->count ? table->numbers[low] : of->whole.end;
}

/* How long parts are: of so many numbers of bricks, and of so many vertices where these are known. */
typedef struct part_plan {
    uint64_t numbers, vertices; /* 0: vertices do not matter */
    uint64_t most;              /* vertices */
    bool by_vertices;           /* they decided where the last part ended */
} part_plan;

/* Meshes that are not small come in some parts at least, whatever fits, so that the sink has some while others are
 * made. With fewer the two wait for each other, and with many more the bricks beside parts, which are made twice, cost
 * more than that. */
enum { PARTS_AT_LEAST = 4, SMALL_PART = 1 << 18 };

/* `a_vertex`: bytes a vertex that a part may be reckoned to take, 0 where vertices are not known. */
static part_plan plan_first(const stream *of, uint64_t a_vertex)
{
    uint64_t most = of->named / PARTS_AT_LEAST, fit = a_vertex > 0 ? of->run.desc->max_memory / a_vertex : 0;
    most = most > SMALL_PART ? most : SMALL_PART;
    return (part_plan){.numbers = of->whole.end, .vertices = fit < most ? fit : most, .most = most};
}

static uint32_t find_end(const stream *of, uint32_t begin, part_plan *plan)
{
    uint32_t end = hewn_region_end(&of->whole, begin, (uint32_t)plan->numbers);
    uint32_t reach = plan->vertices > 0 ? number_after(of, begin, plan->vertices) - begin : end - begin;
    plan->by_vertices = reach < end - begin;
    return plan->by_vertices ? hewn_region_end(&of->whole, begin, reach) : end;
}

/* The next part has what makes four fifths of the budget, going by the one that was made: of `numbers`, with
 * `vertices`. */
static void plan_next(const stream *of, uint64_t numbers, uint64_t vertices, part_plan *plan)
{
    double factor = of->share > 0 ? fmin(2, 0.8 / of->share) : 2;
    if (!plan->by_vertices)
        plan->numbers = (uint64_t)fmax(1, fmin((double)of->whole.end, factor * (double)numbers));
    else if (vertices > 0)
        plan->vertices = (uint64_t)fmax(1, fmin((double)plan->most, factor * (double)vertices));
}

/* Goes over all bricks in parts. One that does not fit beside the part that the sink has is made again when that is
 * gone; and one that does not fit at all is halved. */
static hewn_result go_over(stream *of, const char *stage, bool counts_only, uint64_t a_vertex, part_work work,
                           hewn_error *error)
{
    part_plan plan = plan_first(of, a_vertex);
    for (uint32_t begin = 0; begin < of->whole.end;) {
        uint32_t end = find_end(of, begin, &plan);
        uint64_t done = of->done;
        HEWN_TRY(hewn_progress_report(of->run.desc->progress, stage, (double)begin / (double)of->whole.end, error));
        hewn_result result = try_part(of, begin, end, counts_only, work, error);
        if (was_refused(of, result) && of->handing.under_way) {
            HEWN_TRY(wait_for_sink(of, error));
        } else if (was_too_large(of, result) && end - begin > 1) {
            plan.numbers = (end - begin) / 2;
            plan.vertices = (plan.vertices + 1) / 2;
        } else if (result != HEWN_OK) {
            return fail_least(of, result, error);
        } else {
            plan_next(of, end - begin, of->done - done, &plan);
            begin = end;
        }
    }
    return HEWN_OK;
}

/* --- the first pass ----------------------------------------------------------------------------------------------- */

static bool comes_before(const uint32_t a[3], const double b[3])
{
    for (int axis = 2; axis >= 0; axis--)
        if ((double)a[axis] != b[axis])
            return (double)a[axis] < b[axis];
    return false;
}

static hewn_result look_between(stream *of, const hewn_part *part, hewn_error *error)
{
    hewn_suspects found;
    hewn_extract_stats *stats = of->run.stats;
    uint64_t cells = stats->suspect_cells, undefined = stats->undefined_cells;
    HEWN_TRY(hewn_suspects_find(of->run.extractor, &of->run.grid, &part->bricks, &part->surface, &of->run.workspace,
                                &found, error));
    if (found.cells > 0 && (cells == 0 || comes_before(found.first, of->first_suspect_cell.lo))) {
        hewn_extraction_note_suspects(&of->run, &found);
        for (int axis = 0; axis < 3; axis++)
            of->first_suspect_cell.lo[axis] = found.first[axis];
    }
    stats->suspect_cells = cells + found.cells;
    stats->undefined_cells = undefined + found.undefined;
    return HEWN_OK;
}

/* Room for so many bricks more; arrays grow to twice their length at the most, or what is needed. */
static hewn_result reserve_bricks(stream *of, size_t more, hewn_error *error)
{
    brick_table *table = &of->table;
    size_t needed = table->count + more, room = needed > table->number_room ? 2 * needed + 16 : table->number_room;
    HEWN_TRY(reckon_host(of, 8 * (uint64_t)room + sink_bytes(of, NULL), error));
    void *items = table->numbers;
    HEWN_TRY(hewn_reserve(&items, &table->number_room, needed, sizeof *table->numbers, error));
    table->numbers = items;
    items = table->bases;
    HEWN_TRY(hewn_reserve(&items, &table->base_room, needed, sizeof *table->bases, error));
    table->bases = items;
    return reckon_host(of, kept_bytes(of) + sink_bytes(of, NULL), error);
}

static void add_to_table(stream *of, const hewn_part *part)
{
    brick_table *table = &of->table;
    const uint64_t *own = part->surface.own.bricks;
    for (uint64_t i = own[0]; i < own[1]; i++, table->count++) {
        table->numbers[table->count] = part->numbers[i];
        table->bases[table->count] = (uint32_t)(of->named + hewn_part_base(part, i) - hewn_part_base(part, own[0]));
    }
}

static hewn_result check_vertices(stream *of, uint64_t vertices, hewn_error *error)
{
    if (vertices < UINT32_MAX)
        return HEWN_OK;
    of->decided = true;
    return hewn_fail(error, HEWN_LIMIT,
                     "this mesh has more than the 4294967294 vertices that indices can name; use larger cells");
}

static hewn_result count_part(stream *of, hewn_part *part, hewn_error *error)
{
    const hewn_own *own = &part->surface.own;
    uint64_t bricks = hewn_part_own_bricks(part);
    if (bricks == 0)
        return HEWN_OK;
    HEWN_TRY(reserve_bricks(of, (size_t)bricks, error));
    HEWN_TRY(look_between(of, part, error));
    add_to_table(of, part);
    of->run.stats->bricks_active += bricks;
    of->run.stats->cells_visited += 512 * bricks;
    of->crossings += own->crossings[1] - own->crossings[0];
    of->named += own->vertices[1] - own->vertices[0];
    of->triangles += own->triangles[1] - own->triangles[0];
    return check_vertices(of, of->named, error);
}

/* --- names of vertices -------------------------------------------------------------------------------------------- */

/* From a part's numbers of vertices to those of the whole. */
typedef struct naming {
    const hewn_part *part;
    const uint32_t *firsts; /* the whole's first vertex of each brick; UINT32_MAX: none that this part could name */
    uint64_t own[2];        /* numbers of the part's own vertices, and what the first becomes */
    uint64_t own_first;
    uint64_t extra[2]; /* the same of those in cells or of fans */
    uint64_t extra_first;
} naming;

/* Where a brick's number stands in the table; its count where it does not. */
static uint64_t find_number(const brick_table *table, uint32_t number)
{
    uint64_t low = 0, high = table->count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        bool below = table->numbers[middle] < number;
        low = below ? middle + 1 : low;
        high = below ? high : middle;
    }
    return low < table->count && table->numbers[low] == number ? low : table->count;
}

/* Takes the memory for names: before a part is emitted, so that one that is too large shows early. */
static hewn_result find_firsts(stream *of, const hewn_part *part, const uint32_t **out, hewn_error *error)
{
    hewn_buffer *home;
    HEWN_TRY(hewn_workspace_take(&of->run.workspace, "first vertices of bricks", 4 * (uint64_t)part->bricks.count,
                                 HEWN_BUFFER_READBACK, &home, error));
    uint32_t *firsts = home->mapped;
    for (uint64_t i = 0; i < part->bricks.count; i++) {
        uint64_t at = find_number(&of->table, part->numbers[i]);
        firsts[i] = at < of->table.count ? of->table.bases[at] : UINT32_MAX;
    }
    *out = firsts;
    return HEWN_OK;
}

/* Of a part that is emitted: only then fans are counted. */
static naming begin_naming(const stream *of, const hewn_part *part, const uint32_t *firsts)
{
    const hewn_surface *surface = &part->surface;
    const hewn_own *own = &surface->own;
    bool dual = surface->loops;
    return (naming){.part = part,
                    .firsts = firsts,
                    .own = {own->vertices[0], own->vertices[1]},
                    .own_first = of->done,
                    .extra = {part->named_vertices + (dual ? 0 : own->centres[0]),
                              dual ? surface->vertex_count : part->named_vertices + own->centres[1]},
                    .extra_first = of->named + of->done_centres};
}

/* Vertex `v` of another part: the last brick whose first vertex is no later has it. UINT32_MAX: none has. */
static uint32_t name_other(const naming *names, uint32_t v)
{
    const hewn_part *part = names->part;
    uint64_t low = 0, high = part->bricks.count;
    while (high - low > 1) {
        uint64_t middle = low + (high - low) / 2;
        if (part->bases[middle] <= v)
            low = middle;
        else
            high = middle;
    }
    return names->firsts[low] == UINT32_MAX ? UINT32_MAX : names->firsts[low] + (v - part->bases[low]);
}

static uint32_t name_vertex(const naming *names, uint32_t v)
{
    if (v >= names->own[0] && v < names->own[1])
        return (uint32_t)(names->own_first + v - names->own[0]);
    if (v >= names->extra[0] && v < names->extra[1])
        return (uint32_t)(names->extra_first + v - names->extra[0]);
    return v < names->part->named_vertices ? name_other(names, v) : UINT32_MAX;
}

static hewn_result name_all(const naming *names, uint32_t *indices, uint64_t count, hewn_error *error)
{
    bool lost = false;
#pragma omp parallel for schedule(static) reduction(|| : lost)
    for (uint64_t i = 0; i < count; i++) {
        indices[i] = name_vertex(names, indices[i]);
        lost = lost || indices[i] == UINT32_MAX;
    }
    return lost ? hewn_fail(error, HEWN_INTERNAL, "a triangle names a vertex that no part has") : HEWN_OK;
}

/* --- the second pass ---------------------------------------------------------------------------------------------- */

static void add_emission(stream *of, const hewn_emission *emission)
{
    hewn_extract_stats *stats = of->run.stats;
    stats->cap_vertices += emission->caps;
    stats->max_residual = fmaxf(stats->max_residual, emission->max_residual);
    stats->edge_vertices += emission->edge_vertices;
    stats->corner_vertices += emission->corner_vertices;
    stats->planes_found += emission->planes_found;
    stats->features_lost += emission->features_lost;
    of->done_capped += emission->capped_crossings;
}

static bool touches_bounds(const struct hewn_grid *grid, const hewn_vertex_run *run)
{
    for (uint64_t i = 0; i < 3 * run->count; i++)
        if (run->positions[i] == grid->origin[i % 3] || run->positions[i] == grid->far[i % 3])
            return true;
    return false;
}

static hewn_vertex_run vertex_run(stream *of, const hewn_buffer buffers[2], uint64_t from, uint64_t first,
                                  uint64_t count)
{
    const float *positions = buffers[0].mapped, *normals = buffers[1].mapped;
    hewn_vertex_run run = {first, count, positions + 3 * from, normals + 3 * from};
    if (of->run.desc->open)
        of->run.stats->left_bounds = of->run.stats->left_bounds || touches_bounds(&of->run.grid, &run);
    return run;
}

/* Makes a part of what lies in the buffers; further triangles of fans follow the part's own. */
static hewn_result assemble(stream *of, const hewn_part *part, const naming *names, const hewn_buffer buffers[3],
                            hewn_mesh_part *out, hewn_error *error)
{
    const hewn_own *own = &part->surface.own;
    uint64_t vertices = own->vertices[1] - own->vertices[0], extra = names->extra[1] - names->extra[0];
    uint64_t triangles = own->triangles[1] - own->triangles[0], further = 2 * (uint64_t)part->surface.fan_count;
    uint32_t *indices = (uint32_t *)buffers[2].mapped + 3 * own->triangles[0];
    HEWN_TRY(check_vertices(of, names->extra_first + extra, error));
    HEWN_TRY(name_all(names, indices, 3 * (triangles + further), error));
    out->vertices[0] = vertex_run(of, buffers, own->vertices[0], of->done, vertices);
    out->vertices[1] = vertex_run(of, buffers, names->extra[0], names->extra_first, extra);
    out->triangles[0] = (hewn_triangle_run){of->done_triangles, triangles, indices};
    out->triangles[1] = (hewn_triangle_run){of->triangles + of->done_fans, further, indices + 3 * triangles};
    /* Bricks that are still to come have vertices that triangles so far may name, but no brick has that is done. */
    of->open = (hewn_number_run){of->done + vertices, of->named - of->done - vertices};
    out->open = &of->open;
    out->open_count = of->open.count > 0;
    return HEWN_OK;
}

/* The last moment to find that a part is too large: what the device no longer needs is given back, the part before
 * leaves, and the sink is asked what it takes. Then the buffers are the sink's. */
static hewn_result hand_over(stream *of, const hewn_mesh_part *given, hewn_buffer buffers[3], hewn_error *error)
{
    hewn_workspace_clear(&of->run.workspace);
    note_peak(of);
    uint64_t making = of->most - of->begun;
    HEWN_TRY(wait_for_sink(of, error));
    uint64_t taking = sink_bytes(of, given);
    HEWN_TRY(reckon_host(of, kept_bytes(of) + taking, error));
    note_share(of, making + bytes_now(of));
    of->decided = true;
    of->run.stats->parts++;
    of->done += given->vertices[0].count;
    of->done_centres += given->vertices[1].count;
    of->done_triangles += given->triangles[0].count;
    of->done_fans += given->triangles[1].count;
    hewn_handing_begin(&of->handing, of->sink, given, buffers, taking);
    return HEWN_OK;
}

static hewn_result emit_into(stream *of, hewn_part *part, hewn_buffer buffers[3], hewn_error *error)
{
    hewn_emission emission = {0};
    hewn_mesh_part given = {0};
    const uint32_t *firsts;
    HEWN_TRY(find_firsts(of, part, &firsts, error));
    HEWN_TRY(hewn_part_emit(&of->run, part, buffers, &emission, error));
    of->decided = emission.cut;
    if (emission.cut)
        return hewn_emission_fail_cut(error);
    for (int i = 0; i < 3; i++)
        HEWN_TRY(hewn_buffer_bring_home(of->run.extractor->device, "a part on the host", &buffers[i], error));
    const naming names = begin_naming(of, part, firsts);
    HEWN_TRY(assemble(of, part, &names, buffers, &given, error));
    HEWN_TRY(hand_over(of, &given, buffers, error));
    add_emission(of, &emission);
    of->run.stats->fans += part->surface.fan_count;
    return HEWN_OK;
}

static hewn_result emit_part(stream *of, hewn_part *part, hewn_error *error)
{
    const hewn_own *own = &part->surface.own;
    hewn_buffer buffers[3] = {{0}};
    if (own->triangles[1] == own->triangles[0] && own->vertices[1] == own->vertices[0])
        return HEWN_OK;
    hewn_result result = emit_into(of, part, buffers, error);
    for (int i = 0; i < 3; i++)
        hewn_buffer_destroy(of->run.extractor->device, &buffers[i]);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

/* Bytes a vertex of a part's own that a part takes to be made, and one like it for the sink that certifies it, with a
 * fifth to spare: 60 to 75 and 116 to 136 were counted by the methods with vertices on edges, 125 to 190 and 120 to 140
 * by the dual ones. */
enum { A_VERTEX = 250, A_DUAL_VERTEX = 350 };

static hewn_result run_passes(stream *of, hewn_error *error)
{
    hewn_extraction *run = &of->run;
    bool dual = hewn_method_is_dual(run->method);
    double begin = hewn_clock_now();
    HEWN_TRY(go_over(of, "count", true, 0, count_part, error));
    if (of->crossings == 0)
        return hewn_extraction_explain_empty(run, error);
    double counted = hewn_clock_now();
    HEWN_TRY(hewn_extraction_stage(run, "count", begin, counted, 1, error));
    if (!dual)
        of->triangles = UINT64_MAX; /* there are no others behind them */
    HEWN_TRY(go_over(of, "extract", false, dual ? A_DUAL_VERTEX : A_VERTEX, emit_part, error));
    double extracted = hewn_clock_now();
    HEWN_TRY(wait_for_sink(of, error));
    if (of->done_capped > 0 && !run->desc->open)
        run->stats->left_bounds = true;
    if (of->done_capped == of->crossings)
        return hewn_extraction_explain_empty(run, error);
    run->stats->vertices = of->named + of->done_centres;
    run->stats->triangles = of->done_triangles + of->done_fans;
    return hewn_extraction_stage(run, "extract", counted, extracted, 1, error);
}

hewn_result hewn_extract_parts(hewn_extractor *extractor, const hewn_extract_desc *desc, const hewn_mesh_sink *sink,
                               hewn_extract_stats *stats, hewn_error *error)
{
    hewn_extract_stats unwanted;
    hewn_device *device = extractor->device;
    stream of = {.sink = sink};
    if (desc->adaptive > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "merging triangles to a tolerance needs the whole mesh in memory; it cannot be made in parts");
    HEWN_TRY(hewn_extraction_begin(extractor, desc, stats ? stats : &unwanted, &of.run, error));
    of.whole = hewn_region_whole(&of.run.grid);
    of.device_before = device->bytes;
    of.device_peak = device->peak_bytes;
    device->peak_bytes = device->bytes;
    hewn_result result = run_passes(&of, error);
    /* After an error a part may be with the sink: what went wrong with that came first. */
    hewn_result taken = hewn_handing_end(&of.handing, device, error);
    device->most_bytes = 0;
    device->peak_bytes = of.device_peak > device->peak_bytes ? of.device_peak : device->peak_bytes;
    hewn_free(of.table.numbers);
    hewn_free(of.table.bases);
    return taken != HEWN_OK ? taken : result;
}
