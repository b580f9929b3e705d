/* One extraction from a volume, from beginning to end. */
#include "iso/volume_extraction.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "iso/bodies.h"
#include "iso/lattice_blocks.h"
#include "iso/lattice_dual.h"
#include "iso/marching_cubes.h"

/* The coarsest that floats may be: as a part of a voxel. */
#define MOST_MARGIN 0x1p-4

hewn_result hewn_volume_extraction_stage(hewn_volume_extraction *run, const char *name, double share, hewn_error *error)
{
    double now = hewn_clock_now() - run->begin;
    run->stats.stages[run->stats.stage_count++] = (hewn_extract_stage){name, run->stage, now};
    run->stage = now;
    return hewn_progress_report(run->desc->progress, "extract", share, error);
}

/* --- the place ---------------------------------------------------------------------------------------------------- */

/* The inverse of the 3 x 3 part; false where it is singular. */
static bool invert(const double m[12], double inverse[9], double *determinant)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            inverse[3 * i + j] = m[4 * a + c] * m[4 * b + d] - m[4 * a + d] * m[4 * b + c];
        }
    *determinant = m[0] * inverse[0] + m[1] * inverse[3] + m[2] * inverse[6];
    bool good = isfinite(*determinant) && *determinant != 0;
    for (int i = 0; i < 9; i++) {
        inverse[i] /= *determinant;
        good = good && isfinite(inverse[i]);
    }
    return good;
}

/* How far vertices keep from grid points: where floats are coarse at the farthest corner, so far that any two vertices
 * differ by more than rounding takes from them. */
static double find_margin(const hewn_lattice *lattice, const double inverse[9])
{
    double most = 0, sum = 0;
    int exponent;
    for (int c = 0; c < 8; c++)
        for (int i = 0; i < 3; i++) {
            const double *row = lattice->place + (ptrdiff_t)4 * i;
            double at = row[3];
            for (int axis = 0; axis < 3; axis++)
                at += (c >> axis & 1) * row[axis] * (double)(lattice->volume->dims[axis] - 1);
            most = fmax(most, fabs(at));
        }
    (void)frexp(most, &exponent);
    for (int i = 0; i < 9; i++)
        sum += inverse[i] * inverse[i];
    /* The mean of a loop is at least a third as far from a cell's face as those of its crossings that are not in it. */
    return fmax(HEWN_LATTICE_MARGIN, (lattice->dual ? 6 : 2) * ldexp(1, exponent - 24) * sqrt(sum));
}

static hewn_result set_place(hewn_lattice *lattice, const double *place, hewn_error *error)
{
    double inverse[9], determinant;
    const double *from = place ? place : lattice->volume->to_world;
    for (int i = 0; i < 12; i++) {
        lattice->place[i] = from[i];
        if (!isfinite(from[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the place of the samples is not finite");
    }
    if (!invert(lattice->place, inverse, &determinant))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the place of the samples is singular");
    lattice->mirrors = determinant < 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            lattice->turn[3 * i + j] = lattice->above ? -inverse[3 * j + i] : inverse[3 * j + i];
    memcpy(lattice->back, inverse, sizeof inverse);
    lattice->margin = find_margin(lattice, inverse);
    if (!(lattice->margin <= MOST_MARGIN))
        return hewn_fail(error, HEWN_BAD_INPUT,
                         "the volume is so far from the origin that float positions cannot tell its vertices apart");
    return HEWN_OK;
}

/* --- before any sample is looked at ------------------------------------------------------------------------------- */

/* Marching cubes' patches as records of the other table: they have no vertices in cells, and nothing to decide. */
static hewn_result take_marching_cubes(hewn_mc33_table *out, hewn_error *error)
{
    hewn_mc_table table;
    hewn_mc_table_derive(&table);
    *out = (hewn_mc33_table){.words = hewn_alloc(256 + 256 * HEWN_MC_ENTRY_WORDS, sizeof *out->words)};
    if (!out->words)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a table of configurations");
    for (uint32_t pattern = 0; pattern < 256; pattern++)
        out->words[pattern] = 256 + HEWN_MC_ENTRY_WORDS * pattern;
    memcpy(out->words + 256, table.words, sizeof table.words);
    out->count = 256 + 256 * HEWN_MC_ENTRY_WORDS;
    return HEWN_OK;
}

static hewn_result check(const hewn_volume *volume, const hewn_volume_extract_desc *desc, hewn_method method,
                         hewn_error *error)
{
    if (desc->frame >= volume->frame_count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no frame %llu; the volume has %llu, counted from 0",
                         (unsigned long long)desc->frame, (unsigned long long)volume->frame_count);
    if (!isfinite(desc->iso))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an iso value of %g makes no sense", desc->iso);
    if (desc->keep && desc->open)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "bodies can be chosen where the surface is closed, not with open");
    if (desc->keep && !(desc->keep->least_volume >= 0 && isfinite(desc->keep->least_volume)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a least volume of %g makes no sense", desc->keep->least_volume);
    if (!hewn_method_name(method))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "volumes are meshed by mc33, mc, nets or dc");
    for (int axis = 0; axis < 3 && desc->open; axis++)
        if (volume->dims[axis] == 1)
            return hewn_fail(error, HEWN_BAD_INPUT,
                             "a volume of one slice has a surface around that slice only, so it cannot be left open");
    return HEWN_OK;
}

static void set_field(hewn_lattice *lattice, const hewn_volume_extract_desc *desc)
{
    const hewn_volume *volume = lattice->volume;
    bool below = desc->inside == HEWN_INSIDE_BELOW || (desc->inside == HEWN_INSIDE_DEFAULT && volume->level_set);
    lattice->above = !below;
    lattice->threshold = hewn_threshold_find(volume, desc->iso, below);
    lattice->level = (desc->iso - volume->intercept) / volume->slope;
    lattice->rise = volume->slope < 0 ? -1 : 1;
    lattice->first = hewn_volume_frame_size(volume) * desc->frame;
    lattice->normals = !desc->no_normals || lattice->planes;
}

static hewn_result lay(hewn_volume_extraction *run, hewn_error *error)
{
    hewn_lattice *lattice = &run->lattice;
    const hewn_volume *volume = lattice->volume;
    lattice->repeats = run->desc->open && lattice->dual;
    lattice->rim = run->desc->open && !lattice->dual ? 0 : 1;
    for (int axis = 0; axis < 3; axis++) {
        lattice->dims[axis] = volume->dims[axis] + 2 * lattice->rim;
        run->stats.cells[axis] = volume->dims[axis] - 1;
        if (volume->dims[axis] > UINT32_MAX - 64)
            return hewn_fail(error, HEWN_LIMIT, "%u samples along axis %d are too many", volume->dims[axis], axis + 1);
    }
    lattice->words = (lattice->dims[0] + 63) / 64;
    return HEWN_OK;
}

hewn_result hewn_volume_extraction_begin(const hewn_volume *volume, const hewn_volume_extract_desc *desc,
                                         hewn_volume_extraction *out, hewn_error *error)
{
    hewn_method method = desc->method == HEWN_METHOD_DEFAULT ? HEWN_METHOD_MC33 : desc->method;
    hewn_volume_extraction *run = out;
    hewn_lattice *lattice = &run->lattice;
    *run = (hewn_volume_extraction){.desc = desc, .lattice = {.volume = volume}, .begin = hewn_clock_now()};
    HEWN_TRY(check(volume, desc, method, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "extract", 0, error));
    lattice->dual = hewn_method_is_dual(method);
    lattice->planes = method == HEWN_METHOD_DC;
    set_field(lattice, desc);
    HEWN_TRY(set_place(lattice, desc->place, error));
    HEWN_TRY(lay(run, error));
    lattice->flipped = method == HEWN_METHOD_MC33 && lattice->above;
    hewn_result result = method == HEWN_METHOD_MC33 ? hewn_mc33_table_derive(&run->table, error)
                         : lattice->dual            ? hewn_lattice_dual_table_make(&run->table, error)
                                                    : take_marching_cubes(&run->table, error);
    lattice->table = run->table.words;
    run->stats.method = method;
    run->stats.below = !lattice->above;
    HEWN_TRY(result);
    return volume->blocks ? hewn_lattice_blocks_create(lattice, desc, error) : HEWN_OK;
}

void hewn_volume_extraction_free_slab(hewn_volume_extraction *run)
{
    hewn_lattice *lattice = &run->lattice;
    hewn_free(lattice->inside);
    hewn_free(lattice->rows);
    lattice->inside = NULL;
    lattice->rows = NULL;
    if (lattice->blocks) {
        hewn_free(lattice->blocks->rows);
        lattice->blocks->rows = NULL;
    }
}

void hewn_volume_extraction_clear(hewn_volume_extraction *run)
{
    hewn_volume_extraction_free_slab(run);
    hewn_lattice_blocks_destroy(&run->lattice);
    hewn_mc33_table_destroy(&run->table);
}

static uint64_t sign_words(const hewn_lattice *slab)
{
    return (uint64_t)slab->dims[1] * (hewn_lattice_signs_end(slab) - slab->begin) * slab->words + 1;
}

static uint64_t row_count(const hewn_lattice *slab)
{
    return (uint64_t)slab->dims[1] * (hewn_lattice_rows_end(slab) - slab->begin);
}

uint64_t hewn_volume_extraction_bytes(const hewn_volume_extraction *run, uint32_t begin, uint32_t end)
{
    hewn_lattice slab = run->lattice;
    slab.begin = begin;
    slab.end = end;
    if (slab.blocks)
        return hewn_lattice_blocks_row_bytes(&slab, begin, end);
    return sign_words(&slab) * sizeof *slab.inside + row_count(&slab) * sizeof *slab.rows;
}

hewn_result hewn_volume_extraction_lay(hewn_volume_extraction *run, uint32_t begin, uint32_t end, hewn_error *error)
{
    hewn_lattice *lattice = &run->lattice;
    hewn_volume_extraction_free_slab(run);
    lattice->begin = begin;
    lattice->end = end;
    if (lattice->blocks)
        return hewn_lattice_blocks_lay(lattice, error);
    lattice->inside = hewn_alloc(sign_words(lattice), sizeof *lattice->inside);
    lattice->rows = hewn_alloc(row_count(lattice), sizeof *lattice->rows);
    if (!lattice->inside || !lattice->rows)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the signs of %llu rows of samples",
                         (unsigned long long)row_count(lattice));
    return HEWN_OK;
}

hewn_result hewn_volume_extraction_explain_empty(const hewn_volume_extraction *run, hewn_error *error)
{
    return hewn_fail(error, HEWN_BAD_INPUT, "there is no surface at the value %g", run->desc->iso);
}

/* --- the mesh ----------------------------------------------------------------------------------------------------- */

static hewn_result allocate(uint64_t vertices, uint64_t triangles, bool normals, hewn_triangles *out, hewn_error *error)
{
    out->vertex_count = vertices;
    out->triangle_count = triangles;
    out->positions = hewn_alloc(out->vertex_count, 3 * sizeof *out->positions);
    out->normals = normals ? hewn_alloc(out->vertex_count, 3 * sizeof *out->normals) : NULL;
    out->indices = hewn_alloc(out->triangle_count, 3 * sizeof *out->indices);
    if (out->positions && out->indices && (out->normals || !normals))
        return HEWN_OK;
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu vertices and %llu triangles",
                     (unsigned long long)out->vertex_count, (unsigned long long)out->triangle_count);
}

/* Parts have no stages of their own. */
static hewn_result end_vertices(hewn_volume_extraction *run, hewn_error *error)
{
    return run->in_parts ? HEWN_OK : hewn_volume_extraction_stage(run, "vertices", 0.8, error);
}

/* Crossings first, then vertices in cells and quads between these. */
static hewn_result emit_dual(hewn_volume_extraction *run, uint64_t first, hewn_triangles *out, hewn_error *error)
{
    hewn_lattice *lattice = &run->lattice;
    const uint64_t count = lattice->reached - lattice->before.vertices;
    hewn_triangles crossings = {0};
    hewn_result result = allocate(count, 0, lattice->normals, &crossings, error);
    if (result == HEWN_OK)
        result =
            allocate(lattice->after.centres - lattice->before.centres, 2 * count, !run->desc->no_normals, out, error);
    if (result == HEWN_OK) {
        hewn_lattice_emit_vertices(lattice, &crossings);
        lattice->crossings = &crossings;
        hewn_lattice_emit_triangles(lattice, out);
        result = end_vertices(run, error);
    }
    if (result == HEWN_OK)
        hewn_lattice_dual_cut(lattice, first, lattice->after.vertices, out);
    lattice->crossings = NULL;
    hewn_triangles_destroy(&crossings);
    return result;
}

hewn_result hewn_volume_extraction_emit(hewn_volume_extraction *run, uint64_t first, hewn_triangles *out,
                                        hewn_error *error)
{
    const hewn_lattice *lattice = &run->lattice;
    const hewn_lattice_sums *before = &lattice->before, *after = &lattice->after;
    if (lattice->dual)
        return emit_dual(run, first, out, error);
    HEWN_TRY(allocate(lattice->reached - before->vertices + after->centres - before->centres,
                      after->triangles - before->triangles, lattice->normals, out, error));
    hewn_lattice_emit_vertices(lattice, out);
    HEWN_TRY(end_vertices(run, error));
    hewn_lattice_emit_triangles(lattice, out);
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run_stages(hewn_volume_extraction *run, hewn_triangles *out, hewn_error *error)
{
    hewn_lattice *lattice = &run->lattice;
    HEWN_TRY(hewn_volume_extraction_lay(run, 0, lattice->dims[2], error));
    hewn_lattice_find_signs(lattice);
    HEWN_TRY(hewn_volume_extraction_stage(run, "signs", 0.3, error));
    HEWN_TRY(hewn_lattice_count(lattice, error));
    lattice->vertex_count = lattice->after.vertices;
    run->stats.active_cells = lattice->active_cells;
    run->stats.decided_cells = lattice->decided_cells;
    run->stats.cap_vertices = lattice->cap_vertices;
    HEWN_TRY(hewn_volume_extraction_stage(run, "count", 0.5, error));
    if (lattice->dual ? lattice->after.vertices == 0 : lattice->after.triangles == 0)
        return hewn_volume_extraction_explain_empty(run, error);
    HEWN_TRY(hewn_volume_extraction_emit(run, 0, out, error));
    HEWN_TRY(hewn_volume_extraction_stage(run, "triangles", run->desc->keep ? 0.9 : 1, error));
    if (!run->desc->keep)
        return HEWN_OK;
    HEWN_TRY(hewn_lattice_choose_bodies(lattice, run->desc->keep, out, &run->stats.bodies, error));
    run->stats.cap_vertices = lattice->cap_vertices;
    return hewn_volume_extraction_stage(run, "bodies", 1, error);
}

hewn_result hewn_volume_extract(const hewn_volume *volume, const hewn_volume_extract_desc *desc, hewn_triangles *out,
                                hewn_volume_extract_stats *stats, hewn_error *error)
{
    hewn_volume_extraction run;
    hewn_volume_extract_desc whole = *desc;
    whole.max_memory = 0; /* which is for parts */
    *out = (hewn_triangles){0};
    hewn_result result = hewn_volume_extraction_begin(volume, &whole, &run, error);
    if (result == HEWN_OK)
        result = run_stages(&run, out, error);
    hewn_volume_extraction_clear(&run);
    if (result != HEWN_OK)
        hewn_triangles_destroy(out);
    else {
        run.stats.vertices = out->vertex_count;
        run.stats.triangles = out->triangle_count;
    }
    if (stats)
        *stats = run.stats;
    return result;
}
