#include "simplify/fan.h"

#include <math.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "simplify/vector.h"

/* Four numbers, or four yes and no, all bits set or none. */
typedef double four __attribute__((vector_size(32), aligned(8)));
typedef int64_t bits __attribute__((vector_size(32), aligned(8)));

enum { MARKS_AT_ONCE = 2 };

/* Vectors are not handed to functions: how that is done depends on the processor. */
#define FOUR(ARRAY) (*(const four *)(ARRAY))
#define PICK(YES, A, B) ((four)(((bits)(A) & (YES)) | ((bits)(B) & ~(YES))))

void hewn_simplify_fan_release(simplify_fan *fan)
{
    hewn_free(fan->blocks);
    hewn_free(fan->least);
    hewn_free(fan->beyond);
    *fan = (simplify_fan){0};
}

/* --- what it is made of ------------------------------------------------------------------------------------------- */

static void set(simplify_fan_block *block, uint32_t lane, uint32_t face, const double p[3], const double q[3])
{
    block->face[lane] = face;
    for (int axis = 0; axis < 3; axis++) {
        block->p[axis][lane] = p[axis];
        block->q[axis][lane] = q[axis];
    }
}

hewn_result hewn_simplify_fan_add(simplify_fan *fan, uint32_t face, const double p[3], const double q[3])
{
    const uint32_t at = fan->count / SIMPLIFY_FOUR;
    if (at >= fan->capacity) {
        const hewn_result result =
            hewn_reserve((void **)&fan->blocks, &fan->capacity, at + 1, sizeof *fan->blocks, NULL);
        if (result != HEWN_OK)
            return result;
    }
    set(&fan->blocks[at], fan->count++ % SIMPLIFY_FOUR, face, p, q);
    return HEWN_OK;
}

static inline void cross(const four a[3], const four b[3], four out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

HEWN_CLONES
static void find_planes(simplify_fan_block *blocks, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        simplify_fan_block *block = &blocks[i];
        four p[3], q[3], r[3], n[4][3];
        for (int axis = 0; axis < 3; axis++) {
            p[axis] = FOUR(block->p[axis]);
            q[axis] = FOUR(block->q[axis]);
            r[axis] = q[axis] - p[axis];
        }
        cross(p, q, n[3]);
        cross(p, n[3], n[0]);
        cross(r, n[3], n[1]);
        cross(n[3], q, n[2]);
        bits full = {-1, -1, -1, -1};
        four squares[4];
        for (int k = 0; k < 4; k++) {
            squares[k] = n[k][0] * n[k][0] + n[k][1] * n[k][1] + n[k][2] * n[k][2];
            full &= squares[k] > 0;
        }
        for (int k = 0; k < 4; k++) {
            *(four *)block->inverse[k] = PICK(full, 1 / squares[k], (four){0});
            for (int axis = 0; axis < 3; axis++)
                *(four *)block->across[k][axis] = PICK(full, n[k][axis], (four){0});
        }
        const four offset = n[1][0] * p[0] + n[1][1] * p[1] + n[1][2] * p[2];
        *(four *)block->offset = PICK(full, offset, -1 - (four){0});
    }
}

hewn_result hewn_simplify_fan_settle(simplify_fan *fan)
{
    const uint32_t blocks = (fan->count + SIMPLIFY_FOUR - 1) / SIMPLIFY_FOUR;
    const size_t lanes = (size_t)blocks * SIMPLIFY_FOUR, bounds = lanes * SIMPLIFY_FOUR;
    if (bounds > fan->least_capacity || bounds > fan->beyond_capacity) {
        hewn_result result = hewn_reserve((void **)&fan->least, &fan->least_capacity, bounds, sizeof *fan->least, NULL);
        if (result == HEWN_OK)
            result = hewn_reserve((void **)&fan->beyond, &fan->beyond_capacity, bounds, sizeof *fan->beyond, NULL);
        if (result != HEWN_OK)
            return result;
    }
    for (uint32_t lane = fan->count; lane < lanes; lane++) {
        const simplify_fan_block *block = &fan->blocks[blocks - 1];
        double p[3], q[3];
        simplify_fan_vector(block->p[0], (fan->count - 1) % SIMPLIFY_FOUR, p);
        simplify_fan_vector(block->q[0], (fan->count - 1) % SIMPLIFY_FOUR, q);
        set(&fan->blocks[blocks - 1], lane % SIMPLIFY_FOUR, 0, p, q);
    }
    find_planes(fan->blocks, blocks);
    return HEWN_OK;
}

/* What is less than another square and stays so however both are rounded, coordinates being at most 2. */
static const double surely = 1 - 1e-9, little = 1e-24;

/* --- points ------------------------------------------------------------------------------------------------------- */

static double square_to_side(const double at[3], const double from[3], const double to[3])
{
    double along[3], away[3];
    simplify_between(from, to, along);
    simplify_between(from, at, away);
    const double length = simplify_dot(along, along);
    double share = length > 0 ? simplify_dot(along, away) / length : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    for (int axis = 0; axis < 3; axis++)
        away[axis] -= share * along[axis];
    return simplify_dot(away, away);
}

/* To a triangle that the point is out of: what is nearest is on a side that it is beyond. */
static double square_to_sides(const simplify_fan_block *block, uint32_t lane, const double at[3])
{
    const double place[3] = {0};
    double corner[4][3] = {{0}}, square = INFINITY;
    simplify_fan_vector(block->p[0], lane, corner[1]);
    simplify_fan_vector(block->q[0], lane, corner[2]);
    for (int k = 0; k < 3; k++) {
        double out[3];
        simplify_fan_vector(block->across[k][0], lane, out);
        if (block->inverse[3][lane] > 0 && simplify_dot(out, at) - (k == 1 ? block->offset[lane] : 0) <= 0)
            continue;
        const double found = square_to_side(at, corner[k], k == 2 ? place : corner[k + 1]);
        square = found < square ? found : square;
    }
    return square;
}

/* Four points' squared least distances to a triangle: that to its plane, and in it to the furthest of the sides beyond
 * which a point is. They are what the distances are where a point is above the triangle, and mostly where it is beyond
 * one side. `beyond` is 0 above it. */
static HEWN_INTO_CLONES void bound(const simplify_fan_block *block, uint32_t lane, four x, four y, four z, four *least,
                                   four *beyond)
{
    four most = {0};
    for (int k = 0; k < 3; k++) {
        four out = block->across[k][0][lane] * x + block->across[k][1][lane] * y + block->across[k][2][lane] * z;
        if (k == 1)
            out -= block->offset[lane];
        const four square = out * out * block->inverse[k][lane];
        const bits more = (out > 0) & (square > most);
        most = PICK(more, square, most);
    }
    const four high = block->across[3][0][lane] * x + block->across[3][1][lane] * y + block->across[3][2][lane] * z;
    *least = high * high * block->inverse[3][lane] + most;
    *beyond = block->inverse[3][lane] > 0 ? most : 1 + (four){0};
}

/* The least of every fourth value. */
static uint32_t find_least(const double *values, uint32_t count)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; i++)
        best = values[(size_t)i * SIMPLIFY_FOUR] < values[(size_t)best * SIMPLIFY_FOUR] ? i : best;
    return best;
}

/* By the bounds in one lane: triangles are looked at from the least bound on, `next`, until none is less than what was
 * found. */
static void place_one(const simplify_fan *fan, uint32_t next, uint32_t lane, simplify_fan_point *point)
{
    double *least = fan->least + lane;
    const double *beyond = fan->beyond + lane;
    point->square = INFINITY;
    point->near = 0;
    for (;; next = find_least(least, fan->count)) {
        const size_t at = (size_t)next * SIMPLIFY_FOUR;
        double square = least[at];
        if (!(square < point->square))
            return;
        const bool over = !(beyond[at] > 0);
        if (!over)
            square = square_to_sides(&fan->blocks[next / SIMPLIFY_FOUR], next % SIMPLIFY_FOUR, point->at);
        least[at] = INFINITY;
        if (square < point->square) {
            point->square = square;
            point->near = next;
        }
        if (over)
            return;
    }
}

/* Up to four points; lanes that are left over are like the first. */
static HEWN_INTO_CLONES void place_four(const simplify_fan *fan, simplify_fan_point *const points[], uint32_t count)
{
    double least[SIMPLIFY_FOUR], beyond[SIMPLIFY_FOUR];
    int64_t nearest[SIMPLIFY_FOUR];
    const double *a = points[0]->at, *b = points[count > 1 ? 1 : 0]->at, *c = points[count > 2 ? 2 : 0]->at,
                 *d = points[count > 3 ? 3 : 0]->at;
    const four x = {a[0], b[0], c[0], d[0]}, y = {a[1], b[1], c[1], d[1]}, z = {a[2], b[2], c[2], d[2]};
    four first = INFINITY + (four){0}, out = {0};
    bits near = {0};
    for (uint32_t f = 0; f < fan->count; f++) {
        four here, by;
        bound(&fan->blocks[f / SIMPLIFY_FOUR], f % SIMPLIFY_FOUR, x, y, z, &here, &by);
        *(four *)&fan->least[(size_t)f * SIMPLIFY_FOUR] = here;
        *(four *)&fan->beyond[(size_t)f * SIMPLIFY_FOUR] = by;
        const bits less = here < first, number = (int64_t)f + (bits){0};
        first = PICK(less, here, first);
        out = PICK(less, by, out);
        near = (number & less) | (near & ~less);
    }
    *(four *)least = first;
    *(four *)beyond = out;
    *(bits *)nearest = near;
    for (uint32_t lane = 0; lane < count; lane++) {
        points[lane]->square = least[lane];
        points[lane]->near = (uint32_t)nearest[lane];
        if (beyond[lane] > 0)
            place_one(fan, (uint32_t)nearest[lane], lane, points[lane]);
    }
}

HEWN_CLONES
void hewn_simplify_fan_nearest(const simplify_fan *fan, simplify_fan_point *points, size_t count)
{
    for (size_t i = 0; i < count;) {
        simplify_fan_point *some[SIMPLIFY_FOUR] = {points, points, points, points};
        uint32_t taken = 0;
        for (; i < count && taken < SIMPLIFY_FOUR; i++)
            if (points[i].near == SIMPLIFY_NOWHERE)
                some[taken++] = &points[i];
        if (taken > 0)
            place_four(fan, some, taken);
    }
}

bool hewn_simplify_fan_is_within(const simplify_fan *fan, uint32_t face, const double at[3], double most)
{
    const simplify_fan_block *block = &fan->blocks[face / SIMPLIFY_FOUR];
    const uint32_t lane = face % SIMPLIFY_FOUR;
    double out[3];
    simplify_fan_vector(block->across[3][0], lane, out);
    const double high = simplify_dot(out, at);
    if (!(block->inverse[3][lane] > 0) || !(high * high * block->inverse[3][lane] <= most))
        return false;
    bool over = true;
    for (int k = 0; k < 3; k++) {
        simplify_fan_vector(block->across[k][0], lane, out);
        over &= simplify_dot(out, at) - (k == 1 ? block->offset[lane] : 0) <= 0;
    }
    return over || square_to_sides(block, lane, at) <= surely * most - little;
}

/* Of `count` blocks at a time, so that no step waits for the one before. */
static HEWN_INTO_CLONES void find_some(const simplify_fan_point *points, size_t point_count, simplify_mark_block *marks,
                                       size_t count)
{
    four least[MARKS_AT_ONCE];
    bits nearest[MARKS_AT_ONCE];
    for (size_t b = 0; b < count; b++) {
        least[b] = INFINITY + (four){0};
        nearest[b] = (bits){0};
    }
    for (size_t i = 0; i < point_count; i++)
        for (size_t b = 0; b < count; b++) {
            const four u = FOUR(marks[b].at[0]) - points[i].at[0], v = FOUR(marks[b].at[1]) - points[i].at[1],
                       w = FOUR(marks[b].at[2]) - points[i].at[2];
            const four square = u * u + v * v + w * w;
            const bits less = square < least[b], here = (int64_t)i + (bits){0};
            least[b] = PICK(less, square, least[b]);
            nearest[b] = (here & less) | (nearest[b] & ~less);
        }
    for (size_t b = 0; b < count; b++) {
        *(four *)marks[b].square = least[b];
        *(bits *)marks[b].nearest = nearest[b];
    }
}

HEWN_CLONES
void hewn_simplify_find_marks(const simplify_fan_point *points, size_t count, simplify_mark_block *marks, size_t blocks)
{
    size_t b = 0;
    for (; b + MARKS_AT_ONCE <= blocks; b += MARKS_AT_ONCE)
        find_some(points, count, marks + b, MARKS_AT_ONCE);
    for (; b < blocks; b++)
        find_some(points, count, marks + b, 1);
}
