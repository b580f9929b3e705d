#include "lanes/outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "base/error.h"
#include "field/outline.h"
#include "lanes/loops.h"

/* --- making ---------------------------------------------------------------------------------------------------------
 */

static hewn_lane_side side_of(const double p[4])
{
    hewn_lane_side side = {.from = {p[0], p[1]}, .to = {p[2], p[3]}, .along = {p[2] - p[0], p[3] - p[1]}};
    side.square = side.along[0] * side.along[0] + side.along[1] * side.along[1];
    side.inverse = 1 / side.square;
    return side;
}

hewn_result hewn_lane_outline_read(const hewn_field *field, const hewn_node_data *node, hewn_lane_outline *out,
                                   hewn_error *error)
{
    *out = (hewn_lane_outline){.size = node->parameter[0]};
    uint32_t count = hewn_outline_count(field, node);
    if (count == 0)
        return HEWN_OK;
    double(*sides)[4] = hewn_alloc(count, sizeof *sides);
    out->sides = hewn_alloc(count, sizeof *out->sides);
    if (sides && out->sides) {
        hewn_outline_sides(field, node, sides);
        for (uint32_t i = 0; i < count; i++)
            out->sides[i] = side_of(sides[i]);
        out->side_count = count;
    }
    hewn_free(sides);
    if (out->side_count > 0)
        return HEWN_OK;
    hewn_lane_outline_free(out);
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
}

void hewn_lane_outline_free(hewn_lane_outline *outline)
{
    hewn_free(outline->sides);
    hewn_free(outline->turns);
    *outline = (hewn_lane_outline){0};
}

hewn_lane_outline *hewn_lane_outlines_pack(const hewn_lane_outline *outlines, uint32_t count)
{
    size_t sides = 0, turns = 0;
    for (uint32_t i = 0; i < count; i++) {
        sides += outlines[i].side_count;
        turns += outlines[i].turn_count;
    }
    hewn_lane_outline *block =
        hewn_alloc(1, count * sizeof *block + sides * sizeof *block->sides + turns * sizeof *block->turns);
    if (!block)
        return NULL;
    hewn_lane_side *side = (hewn_lane_side *)(block + count);
    double *turn = (double *)(side + sides);
    for (uint32_t i = 0; i < count; i++) {
        block[i] = outlines[i];
        block[i].sides = side;
        block[i].turns = turn;
        memcpy(side, outlines[i].sides, outlines[i].side_count * sizeof *side);
        if (outlines[i].turn_count > 0)
            memcpy(turn, outlines[i].turns, outlines[i].turn_count * sizeof *turn);
        side += outlines[i].side_count;
        turn += outlines[i].turn_count;
    }
    return block;
}

hewn_lane_outline *hewn_lane_outlines_room(const hewn_lane_tape *whole)
{
    size_t count = whole->outline_count, sides = whole->side_count;
    hewn_lane_outline *block = hewn_alloc(
        1, count * sizeof *block + sides * (sizeof *block->sides + 2 * sizeof *block->turns) + sizeof *block);
    if (!block)
        return NULL;
    hewn_lane_side *side = (hewn_lane_side *)(block + count + 1);
    block[0] = (hewn_lane_outline){.sides = side, .turns = (double *)(side + sides)};
    return block;
}

/* --- values ---------------------------------------------------------------------------------------------------------
 */

/* The square of the distance from a side, and whether a ray along x from the point crosses it. The comparison of a
 * corner's height serves both sides that meet there, so a ray crosses one of them or none. */
static inline double square_from(const hewn_lane_side *side, double x, double y, int64_t *crossed)
{
    double dx = x - side->from[0], dy = y - side->from[1], fx = x - side->to[0], fy = y - side->to[1];
    double along = dx * side->along[0] + dy * side->along[1], cross = side->along[0] * dy - side->along[1] * dx;
    int64_t up = side->from[1] <= y, next = side->to[1] <= y, left = cross > 0;
    double beside = cross * cross * side->inverse, first = dx * dx + dy * dy, last = fx * fx + fy * fy;
    double end = along >= side->square ? last : first;
    *crossed = (up ^ next) & (left ^ up ^ 1);
    return ((along > 0) & (along < side->square)) ? beside : end;
}

/* The least square, and 1 where a ray crosses an odd number of all sides, else 0. */
HEWN_CLONES static void measure(const hewn_lane_outline *outline, const double *x, const double *y,
                                double *restrict least, int64_t *restrict odd, uint32_t count)
{
    const hewn_lane_side *sides = outline->sides, *end = sides + outline->side_count;
    count &= ~(HEWN_LANE_BLOCK - 1U);
    for (uint32_t block = 0; block < count; block += HEWN_LANE_BLOCK) {
        double held[HEWN_LANE_BLOCK];
        int64_t parity[HEWN_LANE_BLOCK];
        for (int i = 0; i < HEWN_LANE_BLOCK; i++) {
            held[i] = (double)(float)HEWN_OUTLINE_START;
            parity[i] = outline->odd;
        }
        for (uint32_t k = 0; k < outline->turn_count; k++)
            for (int i = 0; i < HEWN_LANE_BLOCK; i++)
                parity[i] ^= outline->turns[k] <= y[block + i];
        for (const hewn_lane_side *side = sides; side < end; side++)
            for (int i = 0; i < HEWN_LANE_BLOCK; i++) {
                int64_t crossed;
                double square = square_from(side, x[block + i], y[block + i], &crossed);
                held[i] = ((square < held[i]) | (square != square)) ? square : held[i];
                parity[i] ^= crossed;
            }
        for (int i = 0; i < HEWN_LANE_BLOCK; i++) {
            least[block + i] = held[i];
            odd[block + i] = parity[i];
        }
    }
}

void hewn_lane_outline_value(const hewn_lane_outline *outline, const float *x, const float *y, float *out,
                             uint32_t count)
{
    double px[HEWN_LANES] = {0}, py[HEWN_LANES] = {0}, least[HEWN_LANES] = {0};
    int64_t odd[HEWN_LANES] = {0};
    for (uint32_t i = 0; i < count; i++) {
        px[i] = (double)x[i];
        py[i] = (double)y[i];
    }
    measure(outline, px, py, least, odd, count);
    for (uint32_t i = 0; i < count; i++) {
        float root = sqrtf((float)least[i]);
        out[i] = odd[i] ? -root : root;
    }
}

/* A distance is 1-Lipschitz: it lies about that in the middle. */
void hewn_lane_outline_bound(const hewn_lane_outline *outline, const float *const x[2], const float *const y[2],
                             float *lo, float *hi, uint32_t count)
{
    double px[HEWN_LANES] = {0}, py[HEWN_LANES] = {0}, least[HEWN_LANES] = {0};
    int64_t odd[HEWN_LANES] = {0};
    for (uint32_t i = 0; i < count; i++) {
        px[i] = 0.5 * (double)x[0][i] + 0.5 * (double)x[1][i];
        py[i] = 0.5 * (double)y[0][i] + 0.5 * (double)y[1][i];
    }
    measure(outline, px, py, least, odd, count);
    for (uint32_t i = 0; i < count; i++) {
        double rx = (double)x[1][i] - px[i], ry = (double)y[1][i] - py[i], value = sqrt(least[i]);
        double far = fabs(px[i]) + rx + fabs(py[i]) + ry;
        double reach = sqrt(rx * rx + ry * ry) + 0x1p-20 * (far + outline->size);
        value = odd[i] ? -value : value;
        lo[i] = (float)(value - reach);
        hi[i] = (float)(value + reach);
    }
}

/* The side's own normal, which is right on the side too: a point there counts as right of a side that rises or falls,
 * and as above a level one. */
static void direction_from(const hewn_lane_side *side, double x, double y, float away[2])
{
    double dx = x - side->from[0], dy = y - side->from[1], ex = side->along[0], ey = side->along[1];
    double along = dx * ex + dy * ey, cross = ex * dy - ey * dx, out[2];
    if (along > 0 && along < side->square) {
        double turn = cross > 0 || (cross == 0 && ey == 0 && ex > 0) ? 1 : -1;
        out[0] = -ey * turn;
        out[1] = ex * turn;
    } else {
        out[0] = along >= side->square ? x - side->to[0] : dx;
        out[1] = along >= side->square ? y - side->to[1] : dy;
    }
    double length = sqrt(out[0] * out[0] + out[1] * out[1]), inverse = length > 0 ? 1 / length : 0;
    away[0] = (float)(out[0] * inverse);
    away[1] = (float)(out[1] * inverse);
}

float hewn_lane_outline_gradient(const hewn_lane_outline *outline, float x, float y, float away[2])
{
    const hewn_lane_side *nearest = outline->sides;
    double px = (double)x, py = (double)y, least = (double)(float)HEWN_OUTLINE_START;
    int64_t odd = outline->odd, crossed;
    for (uint32_t k = 0; k < outline->turn_count; k++)
        odd ^= outline->turns[k] <= py;
    for (uint32_t k = 0; k < outline->side_count; k++) {
        double square = square_from(&outline->sides[k], px, py, &crossed);
        if (square < least)
            nearest = &outline->sides[k];
        least = square < least || isnan(square) ? square : least;
        odd ^= crossed;
    }
    direction_from(nearest, px, py, away);
    float root = sqrtf((float)least);
    for (int i = 0; i < 2 && odd; i++)
        away[i] = -away[i];
    return odd ? -root : root;
}

/* --- picking --------------------------------------------------------------------------------------------------------
 */

/* A box, and how far apart two distances must be for their order to be sure in spite of rounding. */
typedef struct cell {
    double lo[2], hi[2], middle[2], reach, margin;
} cell;

static cell cell_of(const hewn_lane_outline *outline, const float lo[2], const float hi[2])
{
    cell out = {0};
    double far = outline->size, square = 0;
    for (int i = 0; i < 2; i++) {
        out.lo[i] = (double)lo[i];
        out.hi[i] = (double)hi[i];
        out.middle[i] = 0.5 * (out.lo[i] + out.hi[i]);
        square += (out.hi[i] - out.middle[i]) * (out.hi[i] - out.middle[i]);
        far += fmax(fabs(out.lo[i]), fabs(out.hi[i]));
    }
    out.reach = sqrt(square);
    out.margin = 0x1p-30 * far;
    return out;
}

/* The least and the greatest distance of a box's points from a side. The greatest is at a corner, because distances
 * from what is convex are. */
static void distances(const cell *box, const hewn_lane_side *side, double *least, double *most)
{
    int64_t unused, left = 0;
    double nearest = INFINITY, farthest = 0;
    for (int k = 0; k < 4; k++) {
        double x = k & 1 ? box->hi[0] : box->lo[0], y = k & 2 ? box->hi[1] : box->lo[1];
        double square = square_from(side, x, y, &unused);
        nearest = fmin(nearest, square);
        farthest = fmax(farthest, square);
        left += side->along[0] * (y - side->from[1]) > side->along[1] * (x - side->from[0]);
    }
    bool apart = left == 0 || left == 4;
    for (int i = 0; i < 2; i++)
        apart = apart || fmin(side->from[i], side->to[i]) > box->hi[i] || fmax(side->from[i], side->to[i]) < box->lo[i];
    for (int end = 0; end < 2; end++) {
        const double *p = end ? side->to : side->from;
        double dx = fmax(fmax(box->lo[0] - p[0], p[0] - box->hi[0]), 0);
        double dy = fmax(fmax(box->lo[1] - p[1], p[1] - box->hi[1]), 0);
        nearest = fmin(nearest, dx * dx + dy * dy);
    }
    *least = apart ? sqrt(nearest) : 0;
    *most = sqrt(farthest);
}

/* Marks the sides that can be nearest somewhere in the box with 1, others with 0. */
static void find_near(const hewn_lane_outline *from, const cell *box, double *near)
{
    double least = INFINITY, most = INFINITY;
    int64_t unused;
    for (uint32_t k = 0; k < from->side_count; k++) {
        near[k] = sqrt(square_from(&from->sides[k], box->middle[0], box->middle[1], &unused));
        least = fmin(least, near[k]);
    }
    double limit = least + 2 * box->reach + 2 * box->margin;
    for (uint32_t k = 0; k < from->side_count; k++) {
        double nearest = INFINITY, farthest = INFINITY;
        if (near[k] <= limit)
            distances(box, &from->sides[k], &nearest, &farthest);
        near[k] = nearest;
        most = fmin(most, farthest);
    }
    for (uint32_t k = 0; k < from->side_count; k++)
        near[k] = near[k] <= most + box->margin;
}

/* Adds a height at which the parity turns, to those that are between the box's ends; below its lower end it has turned
 * everywhere. */
static void add_turn(const cell *box, double height, hewn_lane_outline *out)
{
    if (height <= box->lo[1])
        out->odd = !out->odd;
    else if (height <= box->hi[1])
        out->turns[out->turn_count++] = height;
}

/* A side that does not touch the box. Where their heights meet, all of the box is on one side of it; a ray along x
 * crosses it from the left of it, between its ends. */
static void leave_out(const cell *box, const hewn_lane_side *side, hewn_lane_outline *out)
{
    double a = side->from[1], b = side->to[1], bottom = fmin(a, b), top = fmax(a, b);
    if (a == b || top <= box->lo[1] || bottom > box->hi[1])
        return;
    double y = 0.5 * (fmax(box->lo[1], bottom) + fmin(box->hi[1], top));
    double x = side->from[0] + side->along[0] * ((y - a) / side->along[1]);
    if (x < box->middle[0])
        return;
    add_turn(box, a, out);
    add_turn(box, b, out);
}

static int by_height(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Two turns at one height are none: so it is at corners where a boundary goes on upwards. */
static void drop_pairs(hewn_lane_outline *out)
{
    uint32_t kept = 0;
    qsort(out->turns, out->turn_count, sizeof *out->turns, by_height);
    for (uint32_t i = 0; i < out->turn_count; i++)
        if (kept > 0 && out->turns[kept - 1] == out->turns[i])
            kept--;
        else
            out->turns[kept++] = out->turns[i];
    out->turn_count = kept;
}

void hewn_lane_outline_pick(const hewn_lane_outline *from, const float lo[2], const float hi[2], double *scratch,
                            hewn_lane_outline *out)
{
    const cell box = cell_of(from, lo, hi);
    out->size = from->size;
    out->side_count = out->turn_count = 0;
    out->odd = from->odd;
    find_near(from, &box, scratch);
    for (uint32_t k = 0; k < from->turn_count; k++)
        add_turn(&box, from->turns[k], out);
    for (uint32_t k = 0; k < from->side_count; k++)
        if (scratch[k] > 0)
            out->sides[out->side_count++] = from->sides[k];
        else
            leave_out(&box, &from->sides[k], out);
    drop_pairs(out);
}
