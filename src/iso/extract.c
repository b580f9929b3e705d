/* One extraction from beginning to end: lay the grid, cull, classify, emit, hand over. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "gpu/device.h"
#include "iso/adaptive.h"
#include "iso/extraction.h"

/* Owns what a finished mesh lies in where that is the device's memory. */
typedef struct mapped_mesh {
    hewn_device *device;
    hewn_buffer buffers[3];
} mapped_mesh;

static void release_mapped(void *owner)
{
    mapped_mesh *mesh = owner;
    for (int i = 0; i < 3; i++)
        hewn_buffer_destroy(mesh->device, &mesh->buffers[i]);
    hewn_free(mesh);
}

/* --- stages ------------------------------------------------------------------------------------------------------ */

hewn_result hewn_extraction_stage(hewn_extraction *run, const char *name, double begin, double end, double share,
                                  hewn_error *error)
{
    hewn_extract_stats *stats = run->stats;
    stats->stages[stats->stage_count++] = (hewn_extract_stage){name, begin - run->begin, end - run->begin};
    const hewn_progress *progress = run->desc->progress;
    if (progress && !progress->report(progress->user, name, share))
        return hewn_fail(error, HEWN_CANCELLED, "cancelled after the stage %s", name);
    return HEWN_OK;
}

/* --- what lies between samples -------------------------------------------------------------------------------------
 */

void hewn_extraction_note_suspects(const hewn_extraction *run, const hewn_suspects *suspects)
{
    hewn_extract_stats *stats = run->stats;
    stats->suspect_cells = suspects->cells;
    stats->undefined_cells = suspects->undefined;
    for (int axis = 0; axis < 3 && suspects->cells > 0; axis++) {
        double lo = stats->bounds.lo[axis], hi = stats->bounds.hi[axis], cells = (double)stats->cells[axis];
        stats->first_suspect.lo[axis] = lo + (hi - lo) * suspects->first[axis] / cells;
        stats->first_suspect.hi[axis] = lo + (hi - lo) * (suspects->first[axis] + 1) / cells;
    }
}

static hewn_result look_between_samples(hewn_extraction *run, const hewn_bricks *bricks, const hewn_surface *surface,
                                        hewn_error *error)
{
    double begin = hewn_clock_now();
    hewn_suspects suspects;
    HEWN_TRY(hewn_suspects_find(run->extractor, &run->grid, bricks, surface, &run->workspace, &suspects, error));
    hewn_extraction_note_suspects(run, &suspects);
    return hewn_extraction_stage(run, "suspects", begin, hewn_clock_now(), 0.85, error);
}

/* --- no surface: why --------------------------------------------------------------------------------------------- */

#define LATTICE 9

hewn_result hewn_extraction_explain_empty(hewn_extraction *run, hewn_error *error)
{
    float points[LATTICE * LATTICE * LATTICE * 3], values[LATTICE * LATTICE * LATTICE];
    const hewn_box *box = &run->stats->bounds;
    size_t count = sizeof values / sizeof *values, nan = 0, inside = 0;
    for (size_t i = 0; i < count; i++) {
        size_t place[3] = {i % LATTICE, i / LATTICE % LATTICE, i / LATTICE / LATTICE};
        for (int axis = 0; axis < 3; axis++)
            points[3 * i + (size_t)axis] =
                (float)(box->lo[axis] + (box->hi[axis] - box->lo[axis]) * (double)place[axis] / (LATTICE - 1));
    }
    HEWN_TRY(hewn_code_eval_points(run->extractor->device, run->extractor->code, points, count, values, error));
    for (size_t i = 0; i < count; i++) {
        nan += isnan(values[i]) ? 1 : 0;
        inside += values[i] < 0 ? 1 : 0;
    }
    const char *why =
        nan == count ? "the field is not a number (NaN) everywhere in the bounds"
        : inside == count
            ? "the field is negative everywhere in the bounds: all of it is inside, and no surface is there"
        : inside > 0 ? "the shape lies between the samples of this grid: use a finer one"
        : nan > 0
            ? "the field is nowhere negative in the bounds, and in places not a number (NaN)"
            : "the field is nowhere negative in the bounds: the shape is empty, or elsewhere, or thinner than a cell";
    char place[128] = "";
    const hewn_box *first = &run->stats->first_suspect;
    if (run->stats->suspect_cells > 0 && inside < count)
        snprintf(place, sizeof place, "; something thinner than a cell may be near (%g, %g, %g)",
                 (first->lo[0] + first->hi[0]) / 2, (first->lo[1] + first->hi[1]) / 2,
                 (first->lo[2] + first->hi[2]) / 2);
    return hewn_fail(error, HEWN_BAD_INPUT, "no surface from (%g, %g, %g) to (%g, %g, %g) with cells of %g: %s%s",
                     box->lo[0], box->lo[1], box->lo[2], box->hi[0], box->hi[1], box->hi[2], run->stats->cell, why,
                     place);
}

/* --- handing over ------------------------------------------------------------------------------------------------ */

static hewn_result hand_over(mapped_mesh *mesh, const hewn_surface *surface, hewn_triangles *out, hewn_error *error)
{
    for (int i = 0; i < 3; i++)
        HEWN_TRY(hewn_buffer_bring_home(mesh->device, "the mesh on the host", &mesh->buffers[i], error));
    *out = (hewn_triangles){.vertex_count = surface->vertex_count,
                            .triangle_count = surface->triangle_count,
                            .positions = mesh->buffers[0].mapped,
                            .normals = mesh->buffers[1].mapped,
                            .indices = mesh->buffers[2].mapped,
                            .paired = surface->loops && surface->fan_count == 0,
                            .release = release_mapped,
                            .owner = mesh};

    return HEWN_OK;
}

static void note_emission(hewn_extract_stats *stats, const hewn_emission *emission)
{
    stats->cap_vertices = emission->caps;
    stats->max_residual = emission->max_residual;
    stats->edge_vertices = emission->edge_vertices;
    stats->corner_vertices = emission->corner_vertices;
    stats->planes_found = emission->planes_found;
    stats->features_lost = emission->features_lost;
}

/* Merging wants quads, and takes what they were made of. */
static hewn_result emit_dual(hewn_extraction *run, const hewn_bricks *bricks, hewn_surface *surface, mapped_mesh *mesh,
                             hewn_dual_hermite *kept, hewn_emission *emission, hewn_error *error)
{
    uint32_t keep = run->desc->adaptive > 0 ? HEWN_KEEP_ALL : run->desc->quads ? HEWN_KEEP_NONE : HEWN_KEEP_FANS;
    HEWN_TRY(hewn_dual_emit(run->extractor, &run->grid, bricks, surface, run->method, mesh->buffers, &run->workspace,
                            keep, kept, emission, error));
    if (keep == HEWN_KEEP_FANS)
        HEWN_TRY(hewn_dual_add_fans(run->extractor, kept, surface, mesh->buffers, &run->workspace, error));
    run->stats->fans = surface->fan_count;
    return HEWN_OK;
}

static hewn_result emit_into(hewn_extraction *run, const hewn_bricks *bricks, hewn_surface *surface, mapped_mesh *mesh,
                             hewn_dual_hermite *kept, hewn_error *error)
{
    static const char *const what[3] = {"positions", "normals", "indices"};
    uint64_t items[3] = {surface->vertex_count, surface->vertex_count, surface->triangle_count};
    for (int i = 0; i < 3; i++)
        HEWN_TRY(
            hewn_buffer_create(mesh->device, what[i], 12 * items[i], HEWN_BUFFER_DEVICE, &mesh->buffers[i], error));
    hewn_emission emission = {0};
    if (hewn_method_is_dual(run->method))
        HEWN_TRY(emit_dual(run, bricks, surface, mesh, kept, &emission, error));
    else
        HEWN_TRY(hewn_surface_emit(run->extractor, &run->grid, bricks, surface, mesh->buffers, &run->workspace,
                                   &emission, error));
    if (emission.cut)
        return hewn_emission_fail_cut(error);
    note_emission(run->stats, &emission);
    run->stats->left_bounds = emission.capped_crossings > 0;
    return emission.capped_crossings == surface->crossing_count ? hewn_extraction_explain_empty(run, error) : HEWN_OK;
}

/* Whether an open surface reaches the bounds: it does where a vertex lies on them. */
static bool touches_bounds(const hewn_extraction *run, const hewn_triangles *triangles)
{
    for (uint64_t i = 0; i < 3 * triangles->vertex_count; i++) {
        float at = triangles->positions[i];
        if (at == run->grid.origin[i % 3] || at == run->grid.far[i % 3])
            return true;
    }
    return false;
}

/* Merges what the tolerance allows, on the host. */
static hewn_result collapse(hewn_extraction *run, const hewn_bricks *bricks, const hewn_surface *surface,
                            const mapped_mesh *mesh, const hewn_dual_hermite *kept, hewn_triangles *out,
                            hewn_error *error)
{
    hewn_dual_reading reading;
    hewn_adaptive_stats merged;
    hewn_extract_stats *stats = run->stats;
    double start = hewn_clock_now();
    HEWN_TRY(hewn_dual_read(run->extractor, &run->grid, bricks, surface, kept, mesh->buffers, &run->workspace, &reading,
                            error));
    double read = hewn_clock_now();
    hewn_result result = hewn_extraction_stage(run, "read_back", start, read, 0.9, error);
    if (result == HEWN_OK)
        result =
            hewn_adaptive_collapse(&reading.surface, run->desc->adaptive, run->desc->progress, out, &merged, error);
    hewn_dual_reading_clear(&reading);
    if (result != HEWN_OK)
        return result;
    stats->uniform_vertices = surface->vertex_count;
    stats->uniform_triangles = surface->triangle_count;
    stats->octree_merges = merged.octree_merges;
    stats->pair_merges = merged.pair_merges;
    stats->max_residual = NAN; /* vertices have moved */
    return hewn_extraction_stage(run, "collapse", read, hewn_clock_now(), 1, error);
}

static hewn_result classify(hewn_extraction *run, const hewn_bricks *bricks, hewn_surface *surface, hewn_error *error)
{
    if (hewn_method_is_dual(run->method))
        return hewn_dual_classify(run->extractor, &run->grid, bricks, &run->workspace, surface, error);
    return hewn_surface_classify(run->extractor, &run->grid, bricks, &run->workspace, surface, error);
}

static hewn_result run_stages(hewn_extraction *run, hewn_triangles *out, hewn_error *error)
{
    hewn_bricks bricks = {.beyond = run->method == HEWN_METHOD_DC ? HEWN_DUAL_BEYOND : 0};
    hewn_surface surface = {0};
    double start = hewn_clock_now();
    HEWN_TRY(hewn_bricks_cull(run->extractor, &run->grid, &run->workspace, &bricks, error));
    double culled = hewn_clock_now();
    run->stats->bricks_active = bricks.count;
    run->stats->cells_visited = (uint64_t)bricks.count * 512;
    HEWN_TRY(hewn_extraction_stage(run, "cull", start, culled, 0.1, error));
    if (bricks.count == 0)
        return hewn_extraction_explain_empty(run, error);
    HEWN_TRY(classify(run, &bricks, &surface, error));
    double evaluated = culled + surface.sign_seconds;
    HEWN_TRY(hewn_extraction_stage(run, "evaluate", culled, evaluated, 0.5, error));
    if (surface.crossing_count == 0) {
        HEWN_TRY(look_between_samples(run, &bricks, &surface, error));
        return hewn_extraction_explain_empty(run, error);
    }
    if (run->method == HEWN_METHOD_MC33)
        HEWN_TRY(hewn_mc33_refine(run->extractor, &run->grid, &bricks, &run->workspace, &surface, error));
    mapped_mesh *mesh = hewn_alloc_zero(1, sizeof *mesh);
    if (!mesh)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a mesh");
    mesh->device = run->extractor->device;
    hewn_dual_hermite kept;
    hewn_result result = emit_into(run, &bricks, &surface, mesh, &kept, error);
    double extracted = hewn_clock_now();
    if (result == HEWN_OK)
        result = hewn_extraction_stage(run, "extract", evaluated, extracted, 0.8, error);
    if (result == HEWN_OK)
        result = look_between_samples(run, &bricks, &surface, error);
    double searched = hewn_clock_now();
    bool merge = run->desc->adaptive > 0;
    if (result == HEWN_OK && merge)
        result = collapse(run, &bricks, &surface, mesh, &kept, out, error);
    else if (result == HEWN_OK)
        result = hand_over(mesh, &surface, out, error);
    if (result != HEWN_OK || merge)
        release_mapped(mesh);
    if (result != HEWN_OK)
        return result;
    if (run->desc->open)
        run->stats->left_bounds = touches_bounds(run, out);
    return merge ? HEWN_OK : hewn_extraction_stage(run, "read_back", searched, hewn_clock_now(), 1, error);
}

static hewn_result prepare(hewn_extractor *extractor, const hewn_extract_desc *desc, hewn_method method,
                           hewn_error *error)
{
    if (!hewn_method_name(method))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no extraction method %d", (int)method);
    if (desc->quads && !hewn_method_is_dual(method))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the method %s makes no quads: its vertices lie on grid edges",
                         hewn_method_name(method));
    if (!(desc->adaptive >= 0) || !isfinite(desc->adaptive))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a tolerance of %g makes no sense", desc->adaptive);
    if (desc->adaptive > 0 && (method != HEWN_METHOD_DC || desc->quads))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "only the triangles of dc can be merged to a tolerance");
    if (method == HEWN_METHOD_MC33)
        return hewn_mc33_prepare(extractor, error);
    return hewn_method_is_dual(method) ? hewn_dual_prepare(extractor, method, error) : HEWN_OK;
}

hewn_result hewn_extraction_begin(hewn_extractor *extractor, const hewn_extract_desc *desc, hewn_extract_stats *stats,
                                  hewn_extraction *out, hewn_error *error)
{
    hewn_extraction *run = out;
    *run = (hewn_extraction){.extractor = extractor,
                             .desc = desc,
                             .method = desc->method == HEWN_METHOD_DEFAULT ? HEWN_METHOD_DC : desc->method,
                             .workspace.device = extractor->device,
                             .stats = stats,
                             .begin = hewn_clock_now()};
    *stats = (hewn_extract_stats){.method = run->method};
    HEWN_TRY(hewn_grid_lay(desc, &run->grid, &stats->bounds, error));
    HEWN_TRY(hewn_extractor_reach(extractor, &run->grid, error));
    HEWN_TRY(prepare(extractor, desc, run->method, error));
    for (int axis = 0; axis < 3; axis++)
        stats->cells[axis] = run->grid.cells[axis] - 2 * run->grid.rim;
    stats->cell = desc->cell != 0 ? desc->cell : (stats->bounds.hi[0] - stats->bounds.lo[0]) / (double)stats->cells[0];
    return hewn_extraction_stage(run, "prepare", run->begin, hewn_clock_now(), 0.02, error);
}

hewn_result hewn_extract(hewn_extractor *extractor, const hewn_extract_desc *desc, hewn_triangles *out,
                         hewn_extract_stats *stats, hewn_error *error)
{
    hewn_extract_stats unwanted;
    hewn_extraction run;
    *out = (hewn_triangles){0};
    HEWN_TRY(hewn_extraction_begin(extractor, desc, stats ? stats : &unwanted, &run, error));
    bool limited = desc->max_memory > 0 && desc->max_memory <= INT64_MAX;
    extractor->device->most_bytes = limited ? extractor->device->bytes + desc->max_memory : 0;
    hewn_result result = run_stages(&run, out, error);
    hewn_workspace_clear(&run.workspace);
    extractor->device->most_bytes = 0;
    if (result != HEWN_OK)
        hewn_triangles_destroy(out);
    return result;
}
