/* A mesh in parts. Bricks come in their order, and so do vertices and triangles, so a part's own are runs of the
 * whole's. A first pass over the parts counts vertices; then every brick's first vertex is known, and a second pass can
 * name vertices of other parts. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "gpu/device.h"
#include "iso/part.h"

/* Of all bricks, by number, and where there is room for more. */
typedef struct brick_table {
    uint32_t *numbers, *bases; /* and the first vertex of each */
    size_t count, number_room, base_room;
} brick_table;

typedef struct stream {
    hewn_extraction run;
    const hewn_mesh_sink *sink;
    hewn_region whole;
    brick_table table;
    hewn_number_run open;
    uint64_t crossings, named, triangles; /* of the whole: of vertices those that bases tell of; no fans' triangles */
    uint64_t done, done_centres, done_capped; /* in the second pass; fans' vertices are centres */
    uint64_t done_triangles, done_fans;
    hewn_box first_suspect_cell; /* lo: coordinates of the first one so far */
    uint64_t device_before;      /* bytes that the device held before the run: they do not count */
    uint64_t host;               /* bytes that the host was reckoned to take when the device was last limited */
    double share;                /* of the budget that the last part took */
    bool decided;                /* no smaller part would have fared better than the last one */
} stream;

/* --- memory ------------------------------------------------------------------------------------------------------- */

/* What lies on the host from part to part. */
static uint64_t kept_bytes(const stream *of)
{
    return 4 * (uint64_t)(of->table.number_room + of->table.base_room);
}

static uint64_t sink_bytes(const stream *of, const hewn_mesh_part *part)
{
    return of->sink->bytes ? of->sink->bytes(of->sink->user, part) : 0;
}

/* Leaves the device what the host does not take. */
static void limit_device(stream *of, uint64_t host)
{
    uint64_t most = of->run.desc->max_memory;
    of->host = host;
    if (most > INT64_MAX) /* as good as none */
        of->run.extractor->device->most_bytes = 0;
    else if (most > 0) /* at least a byte: 0 is no limit */
        of->run.extractor->device->most_bytes = of->device_before + (most > host ? most - host : 1);
}

/* Notes what was in use at the most since `device->peak_bytes` was last set, with so much on the host. */
static void note_peak(stream *of, uint64_t host_bytes)
{
    uint64_t peak = of->run.extractor->device->peak_bytes - of->device_before + host_bytes;
    hewn_extract_stats *stats = of->run.stats;
    stats->peak_memory = peak > stats->peak_memory ? peak : stats->peak_memory;
    if (of->run.desc->max_memory > 0)
        of->share = fmax(of->share, (double)peak / (double)of->run.desc->max_memory);
}

/* --- parts of the right size -------------------------------------------------------------------------------------- */

typedef hewn_result (*part_work)(stream *of, hewn_part *part, hewn_error *error);

/* One part. The device's own record of its peak goes on afterwards. */
static hewn_result try_part(stream *of, uint32_t begin, uint32_t end, bool counts_only, part_work work,
                            hewn_error *error)
{
    hewn_device *device = of->run.extractor->device;
    hewn_region region = of->whole;
    region.begin = begin;
    region.end = end;
    hewn_part part;
    uint64_t peak = device->peak_bytes, host = kept_bytes(of) + sink_bytes(of, NULL);
    device->peak_bytes = device->bytes;
    device->refused_bytes = 0;
    of->share = 0;
    of->decided = false;
    limit_device(of, host);
    hewn_result result = hewn_part_open(&of->run, &region, counts_only, &part, error);
    if (result == HEWN_OK) {
        note_peak(of, host + 4 * (uint64_t)part.bricks.count);
        result = work(of, &part, error);
    }
    hewn_part_clear(&part);
    hewn_workspace_clear(&of->run.workspace);
    device->peak_bytes = peak > device->peak_bytes ? peak : device->peak_bytes;
    return result;
}

/* Whether a smaller part may do better. */
static bool was_too_large(const stream *of, hewn_result result)
{
    bool refused = result == HEWN_OUT_OF_DEVICE_MEMORY && of->run.extractor->device->refused_bytes > 0;
    return !of->decided && (refused || result == HEWN_LIMIT);
}

static hewn_result fail_least(const stream *of, hewn_result result, hewn_error *error)
{
    const hewn_device *device = of->run.extractor->device;
    if (result != HEWN_OUT_OF_DEVICE_MEMORY || device->refused_bytes == 0 || of->decided)
        return result;
    uint64_t most = of->run.desc->max_memory;
    return hewn_fail(
        error, result, "the least part of this mesh needs at least %llu bytes, more than the %llu that are allowed",
        (unsigned long long)(device->refused_bytes - of->device_before + of->host), (unsigned long long)most);
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

/* Goes over all bricks in parts. Their length follows from what the last one took, and is halved where one does not
 * fit. `a_vertex`: bytes a vertex that a part may be reckoned to take, 0 where vertices are not known. */
static hewn_result go_over(stream *of, const char *stage, bool counts_only, uint64_t a_vertex, part_work work,
                           hewn_error *error)
{
    double most = (double)of->run.desc->max_memory;
    uint64_t length = of->whole.end, vertices = a_vertex > 0 && most > 0 ? (uint64_t)(most / (double)a_vertex) : 0;
    for (uint32_t begin = 0; begin < of->whole.end;) {
        uint32_t end = hewn_region_end(&of->whole, begin, (uint32_t)length);
        if (vertices > 0) {
            uint32_t reach = number_after(of, begin, vertices) - begin;
            end = hewn_region_end(&of->whole, begin, reach < end - begin ? reach : end - begin);
        }
        HEWN_TRY(hewn_progress_report(of->run.desc->progress, stage, (double)begin / (double)of->whole.end, error));
        hewn_result result = try_part(of, begin, end, counts_only, work, error);
        if (was_too_large(of, result) && end - begin > 1) {
            length = (end - begin) / 2;
            vertices /= 2;
            continue;
        }
        if (result != HEWN_OK)
            return fail_least(of, result, error);
        double factor = of->share > 0 ? fmin(2, 0.8 / of->share) : 1;
        length = (uint64_t)fmax(1, fmin((double)of->whole.end, factor * (double)(end - begin)));
        vertices = vertices > 0 ? (uint64_t)fmax(1, factor * (double)vertices) : 0;
        begin = end;
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

static hewn_result add_to_table(stream *of, const hewn_part *part, hewn_error *error)
{
    brick_table *table = &of->table;
    const uint64_t *own = part->surface.own.bricks;
    size_t needed = table->count + (size_t)(own[1] - own[0]);
    void *items = table->numbers;
    HEWN_TRY(hewn_reserve(&items, &table->number_room, needed, sizeof *table->numbers, error));
    table->numbers = items;
    items = table->bases;
    HEWN_TRY(hewn_reserve(&items, &table->base_room, needed, sizeof *table->bases, error));
    table->bases = items;
    for (uint64_t i = own[0]; i < own[1]; i++, table->count++) {
        table->numbers[table->count] = part->numbers[i];
        table->bases[table->count] = (uint32_t)(of->named + hewn_part_base(part, i) - hewn_part_base(part, own[0]));
    }
    return HEWN_OK;
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
    HEWN_TRY(look_between(of, part, error));
    note_peak(of, kept_bytes(of) + sink_bytes(of, NULL) + 4 * (uint64_t)part->bricks.count);
    HEWN_TRY(add_to_table(of, part, error));
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
    uint32_t *firsts; /* the whole's first vertex of each brick; UINT32_MAX: none that this part could name */
    uint64_t own[2];  /* numbers of the part's own vertices, and what the first becomes */
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

static hewn_result begin_naming(const stream *of, const hewn_part *part, naming *out, hewn_error *error)
{
    const hewn_surface *surface = &part->surface;
    const hewn_own *own = &surface->own;
    bool dual = surface->loops;
    *out = (naming){.part = part, .own = {own->vertices[0], own->vertices[1]}, .own_first = of->done};
    out->extra[0] = part->named_vertices + (dual ? 0 : own->centres[0]);
    out->extra[1] = dual ? surface->vertex_count : part->named_vertices + own->centres[1];
    out->extra_first = of->named + of->done_centres;
    out->firsts = hewn_alloc(part->bricks.count, sizeof *out->firsts);
    if (!out->firsts)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u bricks", part->bricks.count);
    for (uint64_t i = 0; i < part->bricks.count; i++) {
        uint64_t at = find_number(&of->table, part->numbers[i]);
        out->firsts[i] = at < of->table.count ? of->table.bases[at] : UINT32_MAX;
    }
    return HEWN_OK;
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

static hewn_result read_run(stream *of, const hewn_buffer buffers[2], uint64_t from, uint64_t first, uint64_t count,
                            hewn_vertex_run *out, hewn_error *error)
{
    const void *at[2];
    for (int i = 0; i < 2; i++)
        HEWN_TRY(hewn_workspace_read(&of->run.workspace, &buffers[i], 12 * from, 12 * count, &at[i], error));
    *out = (hewn_vertex_run){first, count, at[0], at[1]};
    if (of->run.desc->open)
        of->run.stats->left_bounds = of->run.stats->left_bounds || touches_bounds(&of->run.grid, out);
    return HEWN_OK;
}

/* Makes a part of what lies in the buffers; further triangles of fans follow the part's own. */
static hewn_result assemble(stream *of, const hewn_part *part, const naming *names, const hewn_buffer buffers[3],
                            hewn_mesh_part *out, hewn_error *error)
{
    const hewn_own *own = &part->surface.own;
    uint64_t vertices = own->vertices[1] - own->vertices[0], extra = names->extra[1] - names->extra[0];
    uint64_t triangles = own->triangles[1] - own->triangles[0], further = 2 * (uint64_t)part->surface.fan_count;
    const void *indices;
    HEWN_TRY(check_vertices(of, names->extra_first + extra, error));
    HEWN_TRY(read_run(of, buffers, own->vertices[0], of->done, vertices, &out->vertices[0], error));
    HEWN_TRY(read_run(of, buffers, names->extra[0], names->extra_first, extra, &out->vertices[1], error));
    HEWN_TRY(hewn_workspace_read(&of->run.workspace, &buffers[2], 12 * own->triangles[0], 12 * (triangles + further),
                                 &indices, error));
    uint32_t *renamed = (uint32_t *)(uintptr_t)indices; /* a buffer of ours either way */
    HEWN_TRY(name_all(names, renamed, 3 * (triangles + further), error));
    out->triangles[0] = (hewn_triangle_run){of->done_triangles, triangles, renamed};
    out->triangles[1] = (hewn_triangle_run){of->triangles + of->done_fans, further, renamed + 3 * triangles};
    /* Bricks that are still to come have vertices that triangles so far may name, but no brick has that is done. */
    of->open = (hewn_number_run){of->done + vertices, of->named - of->done - vertices};
    out->open = &of->open;
    out->open_count = of->open.count > 0;
    return HEWN_OK;
}

/* The last moment to find that a part is too large: what the device no longer needs is given back before the sink takes
 * memory. */
static hewn_result hand_over(stream *of, const hewn_mesh_part *given, uint64_t bricks, const hewn_buffer *buffer,
                             hewn_error *error)
{
    hewn_device *device = of->run.extractor->device;
    uint64_t most = of->run.desc->max_memory;
    if (buffer->mapped) /* else the part lies in the workspace */
        hewn_workspace_clear(&of->run.workspace);
    uint64_t host = kept_bytes(of) + sink_bytes(of, given) + 4 * bricks;
    if (most > 0 && device->bytes - of->device_before + host > most) {
        device->refused_bytes = device->bytes;
        of->host = host;
        return hewn_fail(error, HEWN_OUT_OF_DEVICE_MEMORY, "a part of %llu triangles is too large",
                         (unsigned long long)given->triangles[0].count);
    }
    device->peak_bytes = device->bytes;
    note_peak(of, host);
    of->decided = true;
    of->run.stats->parts++;
    HEWN_TRY(of->sink->take(of->sink->user, given, error));
    of->done += given->vertices[0].count;
    of->done_centres += given->vertices[1].count;
    of->done_triangles += given->triangles[0].count;
    of->done_fans += given->triangles[1].count;
    return HEWN_OK;
}

static hewn_result emit_into(stream *of, hewn_part *part, hewn_buffer buffers[3], hewn_error *error)
{
    uint64_t host = kept_bytes(of) + 8 * (uint64_t)part->bricks.count + sink_bytes(of, NULL);
    hewn_emission emission = {0};
    hewn_mesh_part given = {0};
    naming names;
    limit_device(of, host);
    HEWN_TRY(hewn_part_emit(&of->run, part, buffers, &emission, error));
    of->decided = emission.cut;
    if (emission.cut)
        return hewn_emission_fail_cut(error);
    HEWN_TRY(begin_naming(of, part, &names, error));
    hewn_result result = assemble(of, part, &names, buffers, &given, error);
    hewn_free(names.firsts);
    note_peak(of, host);
    if (result == HEWN_OK)
        result = hand_over(of, &given, part->bricks.count, &buffers[0], error);
    if (result == HEWN_OK) {
        add_emission(of, &emission);
        of->run.stats->fans += part->surface.fan_count;
    }
    return result;
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

/* Bytes a vertex of a part's own, without its neighbours, in the mesh and what it is made of and for a sink. */
enum { A_VERTEX = 160, A_DUAL_VERTEX = 300 };

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
    if (of->done_capped > 0 && !run->desc->open)
        run->stats->left_bounds = true;
    if (of->done_capped == of->crossings)
        return hewn_extraction_explain_empty(run, error);
    run->stats->vertices = of->named + of->done_centres;
    run->stats->triangles = of->done_triangles + of->done_fans;
    return hewn_extraction_stage(run, "extract", counted, hewn_clock_now(), 1, error);
}

hewn_result hewn_extract_parts(hewn_extractor *extractor, const hewn_extract_desc *desc, const hewn_mesh_sink *sink,
                               hewn_extract_stats *stats, hewn_error *error)
{
    hewn_extract_stats unwanted;
    stream of = {.sink = sink};
    if (desc->adaptive > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "merging triangles to a tolerance needs the whole mesh in memory; it cannot be made in parts");
    HEWN_TRY(hewn_extraction_begin(extractor, desc, stats ? stats : &unwanted, &of.run, error));
    of.whole = hewn_region_whole(&of.run.grid);
    of.device_before = extractor->device->bytes;
    hewn_result result = run_passes(&of, error);
    extractor->device->most_bytes = 0;
    hewn_free(of.table.numbers);
    hewn_free(of.table.bases);
    return result;
}
