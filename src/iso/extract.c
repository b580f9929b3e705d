/* One extraction from beginning to end: lay the grid, cull, classify, emit, hand over. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "iso/extractor.h"

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

typedef struct extraction {
    const hewn_extractor *extractor;
    const hewn_extract_desc *desc;
    struct hewn_grid grid;
    hewn_workspace workspace;
    hewn_extract_stats *stats;
    double begin;
} extraction;

static hewn_result stage(extraction *run, const char *name, double begin, double end, double share, hewn_error *error)
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

static void note_suspects(const extraction *run, const hewn_suspects *suspects)
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

static hewn_result look_between_samples(extraction *run, const hewn_bricks *bricks, const hewn_surface *surface,
                                        hewn_error *error)
{
    double begin = hewn_clock_now();
    hewn_suspects suspects;
    HEWN_TRY(hewn_suspects_find(run->extractor, &run->grid, bricks, surface, &run->workspace, &suspects, error));
    note_suspects(run, &suspects);
    return stage(run, "suspects", begin, hewn_clock_now(), 0.95, error);
}

/* --- no surface: why --------------------------------------------------------------------------------------------- */

#define LATTICE 9

static hewn_result explain_empty(extraction *run, hewn_error *error)
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

static hewn_result copy_home(hewn_device *device, hewn_buffer *buffer, hewn_error *error)
{
    hewn_buffer home = {0};
    HEWN_TRY(hewn_buffer_create(device, "the mesh on the host", buffer->size, HEWN_BUFFER_READBACK, &home, error));
    hewn_commands *commands;
    hewn_result result = hewn_commands_begin(device, &commands, error);
    if (result == HEWN_OK) {
        hewn_commands_copy(commands, buffer, 0, &home, 0, buffer->size);
        result = hewn_commands_submit(&commands, NULL, error);
    }
    hewn_buffer_destroy(device, result == HEWN_OK ? buffer : &home);
    if (result == HEWN_OK)
        *buffer = home;
    return result;
}

static hewn_result hand_over(mapped_mesh *mesh, const hewn_surface *surface, hewn_triangles *out, hewn_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!mesh->buffers[i].mapped)
            HEWN_TRY(copy_home(mesh->device, &mesh->buffers[i], error));
    *out = (hewn_triangles){.vertex_count = surface->vertex_count,
                            .triangle_count = surface->triangle_count,
                            .positions = mesh->buffers[0].mapped,
                            .normals = mesh->buffers[1].mapped,
                            .indices = mesh->buffers[2].mapped,
                            .release = release_mapped,
                            .owner = mesh};

    return HEWN_OK;
}

static hewn_result emit_into(extraction *run, const hewn_bricks *bricks, const hewn_surface *surface, mapped_mesh *mesh,
                             hewn_error *error)
{
    static const char *const what[3] = {"positions", "normals", "indices"};
    uint64_t items[3] = {surface->vertex_count, surface->vertex_count, surface->triangle_count};
    for (int i = 0; i < 3; i++)
        HEWN_TRY(
            hewn_buffer_create(mesh->device, what[i], 12 * items[i], HEWN_BUFFER_DEVICE, &mesh->buffers[i], error));
    hewn_emission emission = {0};
    HEWN_TRY(hewn_surface_emit(run->extractor, &run->grid, bricks, surface, mesh->buffers, &run->workspace, &emission,
                               error));
    run->stats->cap_vertices = emission.caps;
    run->stats->max_residual = emission.max_residual;
    return HEWN_OK;
}

/* Whether an open surface reaches the bounds: it does where a vertex lies on them. */
static bool touches_bounds(const extraction *run, const hewn_triangles *triangles)
{
    for (uint64_t i = 0; i < 3 * triangles->vertex_count; i++) {
        float at = triangles->positions[i];
        if (at == run->grid.origin[i % 3] || at == run->grid.far[i % 3])
            return true;
    }
    return false;
}

static hewn_result run_stages(extraction *run, hewn_triangles *out, hewn_error *error)
{
    hewn_bricks bricks = {0};
    hewn_surface surface = {0};
    double start = hewn_clock_now();
    HEWN_TRY(hewn_bricks_cull(run->extractor, &run->grid, &run->workspace, &bricks, error));
    double culled = hewn_clock_now();
    run->stats->bricks_active = bricks.count;
    run->stats->cells_visited = (uint64_t)bricks.count * 512;
    HEWN_TRY(stage(run, "cull", start, culled, 0.1, error));
    if (bricks.count == 0)
        return explain_empty(run, error);
    HEWN_TRY(hewn_surface_classify(run->extractor, &run->grid, &bricks, &run->workspace, &surface, error));
    double evaluated = culled + surface.sign_seconds;
    HEWN_TRY(stage(run, "evaluate", culled, evaluated, 0.5, error));
    if (surface.vertex_count == 0) {
        HEWN_TRY(look_between_samples(run, &bricks, &surface, error));
        return explain_empty(run, error);
    }
    if (run->desc->method == HEWN_METHOD_MC33)
        HEWN_TRY(hewn_mc33_refine(run->extractor, &run->grid, &bricks, &run->workspace, &surface, error));
    mapped_mesh *mesh = hewn_alloc_zero(1, sizeof *mesh);
    if (!mesh)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a mesh");
    mesh->device = run->extractor->device;
    hewn_result result = emit_into(run, &bricks, &surface, mesh, error);
    double extracted = hewn_clock_now();
    if (result == HEWN_OK)
        result = stage(run, "extract", evaluated, extracted, 0.9, error);
    if (result == HEWN_OK && run->stats->cap_vertices == surface.vertex_count - surface.centre_count)
        result = explain_empty(run, error);
    if (result == HEWN_OK)
        result = look_between_samples(run, &bricks, &surface, error);
    double searched = hewn_clock_now();
    if (result == HEWN_OK)
        result = hand_over(mesh, &surface, out, error);
    if (result != HEWN_OK) {
        release_mapped(mesh);
        return result;
    }
    run->stats->left_bounds = run->desc->open ? touches_bounds(run, out) : run->stats->cap_vertices > 0;
    return stage(run, "read_back", searched, hewn_clock_now(), 1, error);
}

hewn_result hewn_extract(hewn_extractor *extractor, const hewn_extract_desc *desc, hewn_triangles *out,
                         hewn_extract_stats *stats, hewn_error *error)
{
    hewn_extract_stats unwanted;
    extraction run = {
        .extractor = extractor, .desc = desc, .workspace.device = extractor->device, .begin = hewn_clock_now()};
    run.stats = stats ? stats : &unwanted;
    *run.stats = (hewn_extract_stats){0};
    *out = (hewn_triangles){0};
    HEWN_TRY(hewn_grid_lay(desc, &run.grid, &run.stats->bounds, error));
    if (desc->method == HEWN_METHOD_MC33)
        HEWN_TRY(hewn_mc33_prepare(extractor, error));
    run.stats->cell =
        desc->cell != 0 ? desc->cell : (run.stats->bounds.hi[0] - run.stats->bounds.lo[0]) / run.grid.cells[0];
    for (int axis = 0; axis < 3; axis++)
        run.stats->cells[axis] = run.grid.cells[axis];
    hewn_result result = run_stages(&run, out, error);
    hewn_workspace_clear(&run.workspace);
    if (result != HEWN_OK)
        hewn_triangles_destroy(out);
    return result;
}
