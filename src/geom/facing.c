#include "geom/facing.h"

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"

/* Fewer blocks than this are not worth another thread. */
enum { ALONE = 1 << 12 };

/* What may be lost by rounding: of squared distances, and of cosines by normals that are floats. */
static const double rounding = 1e-9, float_rounding = 1e-5;

/* --- building ----------------------------------------------------------------------------------------------------- */

void hewn_triangle_normal(const hewn_triangle_view *mesh, uint32_t triangle, double out[3])
{
    const uint32_t *corner = mesh->corners + 3 * (uint64_t)triangle;
    double a[3], b[3], c[3], u[3], v[3];
    hewn_triangle_point(mesh, corner[0], a);
    hewn_triangle_point(mesh, corner[1], b);
    hewn_triangle_point(mesh, corner[2], c);
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = b[axis] - a[axis];
        v[axis] = c[axis] - a[axis];
    }
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add(hewn_boxes4 *boxes, int k, const float lo[3], const float hi[3])
{
    for (int axis = 0; axis < 3; axis++) { /* never true of NaNs, which are where nothing is yet */
        boxes->lo[axis][k] = boxes->lo[axis][k] <= lo[axis] ? boxes->lo[axis][k] : lo[axis];
        boxes->hi[axis][k] = boxes->hi[axis][k] >= hi[axis] ? boxes->hi[axis][k] : hi[axis];
    }
}

/* Normals of the triangles in a block of level 0. One that is too small or large to have a length may be any. */
static void add_triangles(const hewn_bvh *bvh, const hewn_triangle_view *mesh, uint64_t block, hewn_boxes4 *boxes,
                          int k)
{
    for (uint64_t slot = 4 * block; slot < 4 * block + 4 && slot < mesh->triangle_count; slot++) {
        double n[3];
        float lo[3], hi[3];
        hewn_triangle_normal(mesh, bvh->order[slot], n);
        const double length = sqrt(dot(n, n));
        const bool sound = length > 1e-150 && length < 1e150;
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = sound ? (float)(n[axis] / length) : -1;
            hi[axis] = sound ? lo[axis] : 1;
        }
        add(boxes, k, lo, hi);
    }
}

static void fill_block(const hewn_bvh *bvh, const hewn_triangle_view *mesh, const hewn_facing *facing, uint32_t level,
                       uint64_t block)
{
    hewn_boxes4 *boxes = &facing->level[level][block];
    for (int k = 0; k < 4; k++) {
        const uint64_t child = 4 * block + (uint64_t)k;
        for (int axis = 0; axis < 3; axis++)
            boxes->lo[axis][k] = boxes->hi[axis][k] = NAN;
        if (child >= bvh->block_count[level - 1])
            continue;
        if (level == 1) {
            add_triangles(bvh, mesh, child, boxes, k);
        } else {
            float lo[3], hi[3];
            hewn_boxes4_all(&facing->level[level - 1][child], lo, hi);
            add(boxes, k, lo, hi);
        }
    }
}

hewn_result hewn_facing_build(const hewn_bvh *bvh, const hewn_triangle_view *mesh, hewn_facing *out, hewn_error *error)
{
    uint64_t total = 0;
    *out = (hewn_facing){0};
    for (uint32_t level = 1; level < bvh->level_count; level++)
        total += bvh->block_count[level];
    hewn_boxes4 *boxes = hewn_alloc(total, sizeof *boxes);
    if (!boxes)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the normals of %llu triangles",
                         (unsigned long long)mesh->triangle_count);
    out->level[1] = boxes;
    for (uint32_t level = 1; level < bvh->level_count; level++) {
        out->level[level] = boxes;
        boxes += bvh->block_count[level];
#pragma omp parallel for schedule(static) if (bvh->block_count[level] >= ALONE)
        for (uint64_t block = 0; block < bvh->block_count[level]; block++)
            fill_block(bvh, mesh, out, level, block);
    }
    return HEWN_OK;
}

void hewn_facing_free(hewn_facing *facing)
{
    hewn_free(facing->level[1]);
    *facing = (hewn_facing){0};
}

/* --- searching ---------------------------------------------------------------------------------------------------- */

typedef struct side_search {
    const hewn_bvh *bvh;
    const hewn_facing *facing;
    const hewn_triangle_view *mesh;
    const double *at;
    const double *direction;
    bool away;         /* triangles that face away from it are the usual ones, others are looked for; else they are */
    double towards[3]; /* the direction, or the opposite one */
    double square;     /* boxes are looked into that are as near */
    double within;     /* triangles count that are as near */
    double surely;     /* a product by unit normals that is not below 0 with those themselves */
} side_search;

/* Squared distances to four boxes in which there may be triangles that are looked for; of others infinite. */
static HEWN_INTO_CLONES void find_boxes(const side_search *search, uint32_t level, uint64_t block, double out[4])
{
    typedef float quad __attribute__((vector_size(16), aligned(4)));
    typedef double four __attribute__((vector_size(32), aligned(8)));
    typedef int64_t bits __attribute__((vector_size(32)));
    hewn_boxes4_squares(&search->bvh->level[level][block], search->at, out);
    if (level == 0)
        return;
    const hewn_boxes4 *normals = &search->facing->level[level][block];
    four sum = {0};
    for (int axis = 0; axis < 3; axis++) {
        const float *bound = search->towards[axis] > 0 ? normals->lo[axis] : normals->hi[axis];
        sum += search->towards[axis] * __builtin_convertvector(*(const quad *)bound, four);
    }
    const bits passed = sum >= search->surely;
    *(four *)out = (four)(((bits)(INFINITY + (four){0}) & passed) | ((bits) * (four *)out & ~passed));
}

static inline bool is_other(const side_search *search, uint32_t triangle)
{
    double n[3];
    hewn_triangle_normal(search->mesh, triangle, n);
    return dot(search->direction, n) < 0 ? !search->away : search->away;
}

static void come_nearer(side_search *search, double distance)
{
    search->within = fmin(search->within, distance * (1 + HEWN_AS_NEAR));
    search->square = search->within * search->within * (1 + rounding);
}

/* Nearer boxes first; whether there is another triangle among those that are as near as what is found on the way. */
HEWN_CLONES static bool find_other(side_search *search)
{
    const hewn_bvh *bvh = search->bvh;
    struct {
        double square[4];
        uint64_t block;
    } steps[HEWN_BVH_LEVELS];
    const uint32_t top = bvh->level_count - 1;
    uint32_t level = top;
    steps[top].block = 0;
    find_boxes(search, top, 0, steps[top].square);
    for (;;) {
        double *square = steps[level].square;
        const int least = hewn_least_of4(square);
        if (!(square[least] <= search->square && square[least] < INFINITY)) {
            if (level++ == top)
                return false;
            continue;
        }
        square[least] = INFINITY;
        const uint64_t child = 4 * steps[level].block + (uint64_t)least;
        if (level > 0) {
            steps[--level].block = child;
            find_boxes(search, level, child, steps[level].square);
            continue;
        }
        const double distance = hewn_view_reach(search->mesh, bvh->order[child], search->at);
        if (distance <= search->within && is_other(search, bvh->order[child]))
            return true;
        come_nearer(search, distance);
    }
}

hewn_side hewn_bvh_nearest_side(const hewn_bvh *bvh, const hewn_facing *facing, const hewn_triangle_view *mesh,
                                const double at[3], uint32_t guess, const double direction[3])
{
    double n[3];
    hewn_triangle_normal(mesh, guess, n);
    side_search search = {.bvh = bvh, .facing = facing, .mesh = mesh, .at = at, .direction = direction};
    search.away = dot(direction, n) < 0;
    for (int axis = 0; axis < 3; axis++)
        search.towards[axis] = search.away ? -direction[axis] : direction[axis];
    search.within = INFINITY;
    search.surely = float_rounding * sqrt(dot(direction, direction));
    come_nearer(&search, hewn_view_reach(mesh, guess, at));
    return find_other(&search) ? HEWN_SIDE_UNSURE : search.away ? HEWN_SIDE_AWAY : HEWN_SIDE_ALONG;
}
