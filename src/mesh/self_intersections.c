#include "mesh/self_intersections.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/bvh.h"
#include "mesh/check_faces.h"

/* Fewer triangles than ALONE are not worth another thread. A slice of blocks (of four triangles) is what is done
 * between two looks at the progress callback, a chunk what a thread takes at a time. */
enum { ALONE = 1 << 12, SLICE = 1 << 14, CHUNK = 64 };

static const char stage_name[] = "self-intersections";

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* --- input -------------------------------------------------------------------------------------------------------- */

static hewn_result check_mesh(const hewn_triangle_view *mesh, uint64_t max_pairs, uint32_t (*pairs)[2],
                              hewn_error *error)
{
    if (mesh->vertex_count > 0 && !mesh->doubles && !mesh->floats)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "vertices without positions");
    if (mesh->triangle_count > 0 && !mesh->corners)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "triangles without indices");
    if (max_pairs > 0 && !pairs)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "no room given for the pairs that are asked for");
    if (mesh->vertex_count > UINT32_MAX || mesh->triangle_count > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu triangles are more than can be examined",
                         (unsigned long long)mesh->vertex_count, (unsigned long long)mesh->triangle_count);
    HEWN_TRY(hewn_check_positions(mesh->doubles, mesh->floats, mesh->vertex_count, error));
    return hewn_check_triangle_indices(mesh->corners, mesh->triangle_count, mesh->vertex_count, error);
}

/* --- counting ----------------------------------------------------------------------------------------------------- */

/* A row is what begins with one face: the pairs in which it is the lower. */
typedef struct search {
    const hewn_triangle_view *mesh;
    hewn_bvh bvh;
    _Atomic uint32_t *rows; /* how many pairs each row has; NULL where no pairs are asked for */
} search;

static void slot_box(const hewn_boxes4 *boxes, int k, float lo[3], float hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = boxes->lo[axis][k];
        hi[axis] = boxes->hi[axis][k];
    }
}

/* The pairs of a face in slot k of a block (its facet given) and the faces in the later slots of `other`. */
static uint64_t count_in_block(const search *find, uint64_t block, int k, const hewn_facet *facet, uint64_t other)
{
    float lo[3], hi[3];
    slot_box(&find->bvh.level[0][block], k, lo, hi);
    unsigned meets = hewn_boxes4_meet(&find->bvh.level[0][other], lo, hi);
    if (other == block)
        meets &= 0xfu << (k + 1);
    uint64_t found = 0;
    uint32_t face = find->bvh.order[4 * block + k];
    for (int i = 0; meets >> i != 0; i++) {
        if ((meets >> i & 1) == 0)
            continue;
        hewn_facet second;
        uint32_t partner = find->bvh.order[4 * other + i];
        hewn_view_facet(find->mesh, partner, &second);
        if (!hewn_facets_meet_improperly(facet, &second))
            continue;
        found++;
        if (find->rows)
            atomic_fetch_add_explicit(&find->rows[face < partner ? face : partner], 1, memory_order_relaxed);
    }
    return found;
}

/* The pairs of the four faces of a block with each other and with those of later blocks. */
static uint64_t count_for_block(const search *find, uint64_t block)
{
    hewn_facet facets[4];
    int count = (int)least(4, find->mesh->triangle_count - 4 * block);
    for (int k = 0; k < count; k++)
        hewn_view_facet(find->mesh, find->bvh.order[4 * block + k], &facets[k]);
    float lo[3], hi[3];
    hewn_boxes4_all(&find->bvh.level[0][block], lo, hi);
    hewn_bvh_walk walk = hewn_bvh_walk_begin(&find->bvh, lo, hi, block);
    uint64_t found = 0, other;
    while (hewn_bvh_walk_next(&walk, &other))
        for (int k = 0; k < count; k++)
            found += count_in_block(find, block, k, &facets[k], other);
    return found;
}

static hewn_result count_pairs(const search *find, const hewn_progress *progress, uint64_t *count, hewn_error *error)
{
    uint64_t blocks = find->bvh.block_count[0], found = 0;
    for (uint64_t first = 0; first < blocks; first += SLICE) {
        uint64_t end = least(first + SLICE, blocks);
#pragma omp parallel for schedule(dynamic, CHUNK) reduction(+ : found) if (find->mesh->triangle_count >= ALONE)
        for (uint64_t block = first; block < end; block++)
            found += count_for_block(find, block);
        HEWN_TRY(hewn_progress_report(progress, stage_name, 0.2 + 0.7 * (double)end / (double)blocks, error));
    }
    *count = found;
    return HEWN_OK;
}

/* --- naming ------------------------------------------------------------------------------------------------------- */

static int compare_partners(const void *a, const void *b)
{
    const uint32_t *first = a, *second = b;
    return first[1] < second[1] ? -1 : first[1] > second[1];
}

/* Writes all pairs in which `face` is the lower, sorted. */
static void write_row(const search *find, uint32_t face, uint32_t (*pairs)[2])
{
    hewn_facet facet, second;
    hewn_view_facet(find->mesh, face, &facet);
    float lo[3], hi[3];
    hewn_triangle_box(find->mesh, face, lo, hi);
    hewn_bvh_walk walk = hewn_bvh_walk_begin(&find->bvh, lo, hi, 0);
    uint64_t block, count = 0;
    while (hewn_bvh_walk_next(&walk, &block)) {
        unsigned meets = hewn_boxes4_meet(&find->bvh.level[0][block], lo, hi);
        for (int i = 0; meets >> i != 0; i++) {
            uint32_t partner = find->bvh.order[4 * block + i];
            if ((meets >> i & 1) == 0 || partner <= face)
                continue;
            hewn_view_facet(find->mesh, partner, &second);
            if (hewn_facets_meet_improperly(&facet, &second)) {
                pairs[count][0] = face;
                pairs[count++][1] = partner;
            }
        }
    }
    qsort(pairs, count, sizeof *pairs, compare_partners);
}

/* The row that is wanted only in part. */
static hewn_result write_part(const search *find, uint32_t face, uint32_t count, uint64_t wanted, uint32_t (*pairs)[2],
                              hewn_error *error)
{
    uint32_t(*row)[2] = hewn_alloc(count, sizeof *row);
    if (!row)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u pairs of faces", count);
    write_row(find, face, row);
    memcpy(pairs, row, wanted * sizeof *row);
    hewn_free(row);
    return HEWN_OK;
}

/* Finds again the pairs of the first rows: their number is known, so each row is written in its place. */
static hewn_result write_pairs(const search *find, uint64_t max_pairs, uint32_t (*pairs)[2], hewn_error *error)
{
    uint64_t at = 0, faces = find->mesh->triangle_count;
    hewn_result result = HEWN_OK;
#pragma omp parallel if (faces >= ALONE)
#pragma omp single
    for (uint32_t face = 0; face < faces && at < max_pairs; face++) {
        uint32_t count = atomic_load_explicit(&find->rows[face], memory_order_relaxed);
        if (count == 0)
            continue;
        if (at + count > max_pairs) {
            result = write_part(find, face, count, max_pairs - at, pairs + at, error);
            break;
        }
        uint32_t(*row)[2] = pairs + at;
#pragma omp task firstprivate(face, row)
        write_row(find, face, row);
        at += count;
    }
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run_search(search *find, uint64_t max_pairs, uint32_t (*pairs)[2], const hewn_progress *progress,
                              uint64_t *count, hewn_error *error)
{
    if (max_pairs > 0) {
        find->rows = hewn_alloc_zero(find->mesh->triangle_count, sizeof *find->rows);
        if (!find->rows)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the counts of %llu faces",
                             (unsigned long long)find->mesh->triangle_count);
    }
    HEWN_TRY(hewn_bvh_build(find->mesh, &find->bvh, error));
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.2, error));
    HEWN_TRY(count_pairs(find, progress, count, error));
    if (max_pairs > 0 && *count > 0)
        HEWN_TRY(write_pairs(find, max_pairs, pairs, error));
    return hewn_progress_report(progress, stage_name, 1, error);
}

hewn_result hewn_view_count_self_intersections(const hewn_triangle_view *mesh, uint64_t max_pairs, uint32_t (*pairs)[2],
                                               const hewn_progress *progress, uint64_t *count, hewn_error *error)
{
    *count = 0;
    HEWN_TRY(check_mesh(mesh, max_pairs, pairs, error));
    if (mesh->triangle_count == 0)
        return hewn_progress_report(progress, stage_name, 1, error);
    search find = {.mesh = mesh};
    uint64_t found = 0;
    hewn_result result = run_search(&find, max_pairs, pairs, progress, &found, error);
    hewn_free((void *)find.rows);
    hewn_bvh_free(&find.bvh);
    *count = result == HEWN_OK ? found : 0;
    return result;
}

hewn_result hewn_count_self_intersections(const double *positions, uint64_t vertex_count, const uint32_t *triangles,
                                          uint64_t triangle_count, uint64_t max_pairs, uint32_t (*pairs)[2],
                                          const hewn_progress *progress, uint64_t *count, hewn_error *error)
{
    hewn_triangle_view mesh = {
        .vertex_count = vertex_count, .triangle_count = triangle_count, .doubles = positions, .corners = triangles};
    return hewn_view_count_self_intersections(&mesh, max_pairs, pairs, progress, count, error);
}

hewn_result hewn_triangles_count_self_intersections(const hewn_triangles *triangles, uint64_t max_pairs,
                                                    uint32_t (*pairs)[2], const hewn_progress *progress,
                                                    uint64_t *count, hewn_error *error)
{
    hewn_triangle_view mesh = {.vertex_count = triangles->vertex_count,
                               .triangle_count = triangles->triangle_count,
                               .floats = triangles->positions,
                               .corners = triangles->indices};
    return hewn_view_count_self_intersections(&mesh, max_pairs, pairs, progress, count, error);
}
