/* A volume's mesh in parts, slabs of slices. A first pass counts what each slice has; then it is known how many
 * vertices lie on edges, which is where those in cells begin, and how many slices a part may have.
 *
 * Quads of dual meshes lie between cells of their slice and of the one before it. So a part's slab begins a slice
 * before the part, and what that slice has is found twice. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "iso/lattice_blocks.h"
#include "iso/volume_extraction.h"

/* Bytes a vertex and a triangle that sinks are reckoned to take before there is a part to ask them about. */
enum { SINK_VERTEX = 24, SINK_TRIANGLE = 32 };

typedef struct stream {
    hewn_volume_extraction run;
    const hewn_mesh_sink *sink;
    hewn_lattice_sums *before; /* each slice, and one past the last */
    uint32_t slices;
    uint64_t samples; /* on the heap, bytes */
    hewn_number_run open;
} stream;

/* --- memory ------------------------------------------------------------------------------------------------------- */

static uint64_t kept_bytes(const stream *of)
{
    uint64_t table = ((uint64_t)of->slices + 1) * sizeof *of->before;
    uint64_t patches = of->run.table.count * sizeof *of->run.table.words;
    uint64_t signs = of->run.lattice.blocks ? hewn_lattice_blocks_bytes(&of->run.lattice) : 0;
    return of->samples + signs + table + patches + (of->sink->bytes ? of->sink->bytes(of->sink->user, NULL) : 0);
}

/* Samples that a slab looks at: normals reach one slice farther than edges, planes that are to meet two. */
static void find_samples(const stream *of, uint32_t begin, uint32_t end, uint32_t range[2])
{
    const hewn_lattice *lattice = &of->run.lattice;
    const uint32_t all = lattice->volume->dims[2], reach = lattice->planes ? 2 : 1;
    const uint32_t first = begin > reach + lattice->rim ? begin - reach - lattice->rim : 0;
    range[0] = first < all ? first : all;
    range[1] = all - range[0] > end - begin + 2 + 2 * reach ? range[0] + (end - begin) + 2 + 2 * reach : all;
}

static uint64_t file_bytes(const stream *of, uint32_t begin, uint32_t end)
{
    const hewn_volume *volume = of->run.lattice.volume;
    uint32_t range[2];
    if (volume->blocks)
        return 0; /* all of it counts */
    find_samples(of, begin, end, range);
    uint64_t slice = (uint64_t)volume->dims[0] * volume->dims[1] * hewn_voxel_size(volume->type);
    return volume->mapped ? slice * (range[1] - range[0]) : 0;
}

static void forget(const stream *of, uint32_t begin, uint32_t end)
{
    uint32_t range[2];
    find_samples(of, begin, end, range);
    hewn_volume_forget(of->run.lattice.volume, of->run.desc->frame, range[0], range[1]);
}

/* Where the slab of a part begins. */
static uint32_t slab_begin(const stream *of, uint32_t begin)
{
    return of->run.lattice.dual && begin > 0 ? begin - 1 : begin;
}

/* What the mesh has before a slice: of dual meshes crossings are quads, and not vertices. */
static hewn_lattice_sums mesh_before(const stream *of, uint32_t slice)
{
    const hewn_lattice_sums *all = &of->before[slice];
    return of->run.lattice.dual ? (hewn_lattice_sums){0, all->centres, 2 * all->vertices} : *all;
}

/* What a part's slab has, with crossings of the slice after it, from the first pass. */
static hewn_lattice_sums slab_of(const stream *of, uint32_t begin, uint32_t end)
{
    const hewn_lattice_sums *a = &of->before[slab_begin(of, begin)], *b = &of->before[end];
    const hewn_lattice_sums *beyond = &of->before[end < of->slices ? end + 1 : end];
    hewn_lattice_sums slab = {beyond->vertices - a->vertices, b->centres - a->centres, b->triangles - a->triangles};
    if (of->run.lattice.dual)
        slab.triangles = 2 * slab.vertices;
    return slab;
}

/* While it is made, and what is left of it for the sink. */
static uint64_t mesh_bytes(const stream *of, uint32_t begin, uint32_t end, bool made)
{
    const hewn_volume_extraction *run = &of->run;
    const hewn_lattice_sums slab = slab_of(of, begin, end);
    const uint64_t crossing = run->lattice.normals ? 24 : 12, vertex = run->desc->no_normals ? 12 : 24;
    return (made && run->lattice.dual ? 0 : crossing * slab.vertices) + vertex * slab.centres + 12 * slab.triangles;
}

static uint64_t count_bytes(const stream *of, uint32_t begin, uint32_t end)
{
    return hewn_volume_extraction_bytes(&of->run, begin, end) + file_bytes(of, begin, end);
}

/* Signs and rows, and the crossings of dual meshes, are gone when the sink takes a part. */
static uint64_t emission_bytes(const stream *of, uint32_t begin, uint32_t end)
{
    const uint32_t from = slab_begin(of, begin);
    const hewn_lattice_sums slab = slab_of(of, begin, end);
    const uint64_t vertices = slab.centres + (of->run.lattice.dual ? 0 : slab.vertices);
    const uint64_t sink = mesh_bytes(of, begin, end, true) + file_bytes(of, from, end) + SINK_VERTEX * vertices +
                          SINK_TRIANGLE * slab.triangles;
    const uint64_t making = mesh_bytes(of, begin, end, false) + count_bytes(of, from, end);
    return sink > making ? sink : making;
}

static hewn_result note(stream *of, uint64_t bytes, hewn_error *error)
{
    uint64_t most = of->run.desc->max_memory;
    if (most > 0 && bytes > most)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                         "the least part of this mesh needs %llu bytes, more than the %llu that are allowed",
                         (unsigned long long)bytes, (unsigned long long)most);
    of->run.stats.peak_memory = bytes > of->run.stats.peak_memory ? bytes : of->run.stats.peak_memory;
    return HEWN_OK;
}

/* The end of the largest slab from `begin` on, of at most `most` slices, that leaves an eighth of the memory free,
 * which the program itself and the heap's own tables take; of one slice in any case. */
static uint32_t find_end(const stream *of, uint32_t begin, uint32_t most,
                         uint64_t (*bytes)(const stream *, uint32_t, uint32_t))
{
    uint64_t limit = of->run.desc->max_memory, kept = kept_bytes(of);
    uint32_t low = begin + 1, high = of->slices - begin > most ? begin + most : of->slices;
    if (limit == 0)
        return high;
    limit -= limit / 8;
    while (low < high) {
        uint32_t middle = high - (high - low) / 2;
        bool fits = kept + bytes(of, begin, middle) <= limit;
        low = fits ? middle : low;
        high = fits ? high : middle - 1;
    }
    return low;
}

/* --- the first pass ----------------------------------------------------------------------------------------------- */

static void take_counts(stream *of)
{
    const hewn_lattice *lattice = &of->run.lattice;
    hewn_volume_extract_stats *stats = &of->run.stats;
    stats->active_cells += lattice->active_cells;
    stats->decided_cells += lattice->decided_cells;
    stats->cap_vertices += lattice->cap_vertices;
}

static hewn_result count_all(stream *of, hewn_error *error)
{
    hewn_lattice *lattice = &of->run.lattice;
    for (uint32_t begin = 0, end; begin < of->slices; begin = end) {
        end = find_end(of, begin, of->slices, count_bytes);
        HEWN_TRY(note(of, kept_bytes(of) + count_bytes(of, begin, end), error));
        HEWN_TRY(hewn_progress_report(of->run.desc->progress, "extract", 0.4 * begin / of->slices, error));
        HEWN_TRY(hewn_volume_extraction_lay(&of->run, begin, end, error));
        lattice->before = of->before[begin];
        lattice->slices = of->before + begin;
        hewn_lattice_find_signs(lattice);
        HEWN_TRY(hewn_lattice_count(lattice, error));
        take_counts(of);
        forget(of, begin, end);
    }
    lattice->slices = NULL;
    lattice->vertex_count = of->before[of->slices].vertices;
    return HEWN_OK;
}

/* --- the second pass ---------------------------------------------------------------------------------------------- */

static hewn_mesh_part make_part(stream *of, uint32_t begin, uint32_t end, const hewn_triangles *mesh)
{
    const hewn_lattice *lattice = &of->run.lattice;
    const hewn_lattice_sums *slab = &lattice->before;
    const hewn_lattice_sums before = mesh_before(of, begin), after = mesh_before(of, end);
    const uint64_t on_edges = lattice->dual ? 0 : lattice->vertex_count;
    /* Places in the slab's mesh: of dual ones it begins earlier. */
    const uint64_t centre = (lattice->dual ? 0 : lattice->reached - slab->vertices) + before.centres - slab->centres;
    const uint64_t triangle = before.triangles - (lattice->dual ? 2 * slab->vertices : slab->triangles);
    const float *normals = mesh->normals;
    hewn_mesh_part part = {.open = &of->open};
    part.vertices[0] = (hewn_vertex_run){before.vertices, after.vertices - before.vertices, mesh->positions, normals};
    part.vertices[1] = (hewn_vertex_run){on_edges + before.centres, after.centres - before.centres,
                                         mesh->positions + 3 * centre, normals ? normals + 3 * centre : NULL};
    part.triangles[0] =
        (hewn_triangle_run){before.triangles, after.triangles - before.triangles, mesh->indices + 3 * triangle};
    /* Cells to come name no vertex on edges of the slices that are done; quads do those in the last one's cells. */
    of->open = (hewn_number_run){after.vertices, on_edges - after.vertices};
    if (lattice->dual) {
        const uint64_t first = of->before[end - 1].centres;
        of->open = (hewn_number_run){first, end < of->slices ? of->before[of->slices].centres - first : 0};
    }
    part.open_count = of->open.count > 0;
    return part;
}

static hewn_result make_slab(stream *of, uint32_t begin, uint32_t end, hewn_triangles *out, hewn_error *error)
{
    hewn_lattice *lattice = &of->run.lattice;
    const uint32_t from = slab_begin(of, begin);
    HEWN_TRY(note(of, kept_bytes(of) + mesh_bytes(of, begin, end, false) + count_bytes(of, from, end), error));
    HEWN_TRY(hewn_volume_extraction_lay(&of->run, from, end, error));
    lattice->before = of->before[from];
    hewn_lattice_find_signs(lattice);
    HEWN_TRY(hewn_lattice_count(lattice, error));
    HEWN_TRY(hewn_volume_extraction_emit(&of->run, of->before[begin].vertices, out, error));
    forget(of, from, end);
    hewn_volume_extraction_free_slab(&of->run);
    return HEWN_OK;
}

/* Emits a slab; `*fits` tells whether the sink may take it. */
static hewn_result emit_part(stream *of, uint32_t begin, uint32_t end, bool *fits, hewn_error *error)
{
    hewn_triangles mesh = {0};
    uint64_t bytes = kept_bytes(of) + mesh_bytes(of, begin, end, true), most = of->run.desc->max_memory;
    hewn_result result = make_slab(of, begin, end, &mesh, error);
    if (result == HEWN_OK) {
        hewn_mesh_part part = make_part(of, begin, end, &mesh);
        if (of->sink->bytes)
            bytes += of->sink->bytes(of->sink->user, &part) - of->sink->bytes(of->sink->user, NULL);
        *fits = most == 0 || bytes <= most || end - begin == 1;
        result = *fits ? note(of, bytes, error) : HEWN_OK;
        if (result == HEWN_OK && *fits)
            result = of->sink->take(of->sink->user, &part, error);
    }
    hewn_triangles_destroy(&mesh);
    return result;
}

static bool has_nothing(const stream *of, uint32_t begin, uint32_t end)
{
    const hewn_lattice_sums a = mesh_before(of, begin), b = mesh_before(of, end);
    return a.vertices == b.vertices && a.centres == b.centres && a.triangles == b.triangles;
}

static hewn_result emit_all(stream *of, hewn_error *error)
{
    uint32_t most = of->slices;
    for (uint32_t begin = 0, end; begin < of->slices;) {
        bool fits = true;
        end = find_end(of, begin, most, emission_bytes);
        const bool nothing = has_nothing(of, begin, end); /* no part either */
        while (nothing && end < of->slices && has_nothing(of, begin, end + 1))
            end++;
        HEWN_TRY(hewn_progress_report(of->run.desc->progress, "extract", 0.4 + 0.6 * begin / of->slices, error));
        if (!nothing) {
            HEWN_TRY(emit_part(of, begin, end, &fits, error));
            of->run.stats.parts += fits;
        }
        most = fits ? of->slices : (end - begin) / 2;
        begin = fits ? end : begin;
    }
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run_passes(stream *of, hewn_error *error)
{
    hewn_volume_extraction *run = &of->run;
    const hewn_volume *volume = run->lattice.volume;
    of->slices = run->lattice.dims[2];
    of->samples = volume->mapped && !volume->blocks ? 0 : volume->memory_length;
    of->before = hewn_alloc_zero((size_t)of->slices + 1, sizeof *of->before);
    if (!of->before)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for counts of %u slices", of->slices);
    HEWN_TRY(note(of, volume->blocks ? run->lattice.blocks->peak : 0, error));
    HEWN_TRY(count_all(of, error));
    HEWN_TRY(hewn_volume_extraction_stage(run, "count", 0.4, error));
    const hewn_lattice_sums all = mesh_before(of, of->slices);
    if (all.triangles == 0)
        return hewn_volume_extraction_explain_empty(run, error);
    if (all.vertices + all.centres >= UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the surface needs %llu vertices, more than indices can name",
                         (unsigned long long)(all.vertices + all.centres));
    HEWN_TRY(emit_all(of, error));
    run->stats.vertices = all.vertices + all.centres;
    run->stats.triangles = all.triangles;
    return hewn_volume_extraction_stage(run, "extract", 1, error);
}

hewn_result hewn_volume_extract_parts(const hewn_volume *volume, const hewn_volume_extract_desc *desc,
                                      const hewn_mesh_sink *sink, hewn_volume_extract_stats *stats, hewn_error *error)
{
    stream of = {.sink = sink};
    hewn_result result = hewn_volume_extraction_begin(volume, desc, &of.run, error);
    of.run.in_parts = true;
    if (result == HEWN_OK)
        result = run_passes(&of, error);
    hewn_volume_extraction_clear(&of.run);
    hewn_free(of.before);
    if (stats)
        *stats = of.run.stats;
    return result;
}
