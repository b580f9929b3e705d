#include "simplify/fan.h"

#include <math.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "simplify/vector.h"

/* Four numbers, or four yes and no, all bits set or none. */
typedef double four __attribute__((vector_size(32), aligned(8)));
typedef int64_t bits __attribute__((vector_size(32), aligned(8)));

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
    const size_t lanes = (size_t)blocks * SIMPLIFY_FOUR;
    if (lanes > fan->least_capacity || lanes > fan->beyond_capacity) {
        hewn_result result = hewn_reserve((void **)&fan->least, &fan->least_capacity, lanes, sizeof *fan->least, NULL);
        if (result == HEWN_OK)
            result = hewn_reserve((void **)&fan->beyond, &fan->beyond_capacity, lanes, sizeof *fan->beyond, NULL);
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

/* Least distances to all triangles: those to their planes, and in these to the furthest of the sides. They are what the
 * distances are where the point is above a triangle, and mostly where it is beyond one side. */
static inline void bound(const simplify_fan_block *blocks, uint32_t count, const double at[3], double *least,
                         double *beyond)
{
    const four x = {at[0], at[0], at[0], at[0]}, y = {at[1], at[1], at[1], at[1]}, z = {at[2], at[2], at[2], at[2]};
    for (uint32_t i = 0; i < count; i++) {
        const simplify_fan_block *block = &blocks[i];
        four most = {0};
        for (int k = 0; k < 3; k++) {
            four out = FOUR(block->across[k][0]) * x + FOUR(block->across[k][1]) * y + FOUR(block->across[k][2]) * z;
            if (k == 1)
                out -= FOUR(block->offset);
            const four square = out * out * FOUR(block->inverse[k]);
            const bits more = (out > 0) & (square > most);
            most = PICK(more, square, most);
        }
        const four high = FOUR(block->across[3][0]) * x + FOUR(block->across[3][1]) * y + FOUR(block->across[3][2]) * z;
        const bits flat = FOUR(block->inverse[3]) <= 0;
        *(four *)&least[(size_t)i * SIMPLIFY_FOUR] = high * high * FOUR(block->inverse[3]) + most;
        *(four *)&beyond[(size_t)i * SIMPLIFY_FOUR] = PICK(flat, 1 + (four){0}, most);
    }
}

static uint32_t find_least(const double *values, uint32_t count)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; i++)
        best = values[i] < values[best] ? i : best;
    return best;
}

HEWN_CLONES
void hewn_simplify_fan_nearest(const simplify_fan *fan, simplify_fan_point *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        simplify_fan_point *point = &points[i];
        bound(fan->blocks, (fan->count + SIMPLIFY_FOUR - 1) / SIMPLIFY_FOUR, point->at, fan->least, fan->beyond);
        point->square = INFINITY;
        point->near = 0;
        for (;;) {
            const uint32_t next = find_least(fan->least, fan->count);
            double square = fan->least[next];
            if (!(square < point->square))
                break;
            const bool over = !(fan->beyond[next] > 0);
            if (!over)
                square = square_to_sides(&fan->blocks[next / SIMPLIFY_FOUR], next % SIMPLIFY_FOUR, point->at);
            fan->least[next] = INFINITY;
            if (square < point->square) {
                point->square = square;
                point->near = next;
            }
            if (over)
                break;
        }
    }
}

HEWN_CLONES
void hewn_simplify_find_marks(const simplify_fan_point *points, size_t count, simplify_mark_block *marks, size_t blocks)
{
    for (size_t b = 0; b < blocks; b++) {
        const four x = FOUR(marks[b].at[0]), y = FOUR(marks[b].at[1]), z = FOUR(marks[b].at[2]);
        four least = INFINITY + (four){0};
        bits nearest = {0};
        for (size_t i = 0; i < count; i++) {
            const four u = x - points[i].at[0], v = y - points[i].at[1], w = z - points[i].at[2];
            const four square = u * u + v * v + w * w;
            const bits less = square < least, here = (int64_t)i + (bits){0};
            least = PICK(less, square, least);
            nearest = (here & less) | (nearest & ~less);
        }
        *(four *)marks[b].square = least;
        *(bits *)marks[b].nearest = nearest;
    }
}
