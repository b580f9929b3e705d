#include "eval/outline_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum {
    DEPTH_MOST = 12,      /* halvings of the square, and divisions of a cell */
    DIVISIONS = 3,        /* of one cell */
    CROWDED = 12,         /* a cell of more sides is divided where the outline is close */
    CROWDED_FAR = 64,     /* and elsewhere */
    SETTLED = 4,          /* a box of so few sides and turns is not looked at cell by cell where the outline is close */
    SETTLED_FAR = 16,     /* and elsewhere, where hardly anybody asks */
    SMALL = 4,            /* a cell is divided into so many a side */
    RING = 8,             /* cells across a ring */
    DIRECTIONS = 64,      /* for what is far away */
    WORDS_MOST = 1 << 23, /* of a table: 32 MiB */
    COUNT_MOST = 1 << HEWN_TABLE_TURNS_AT
};

/* Rounding errors of a distance, as a part of the largest coordinate: sixteen times what four operations make. */
static const double apart = 0x1p-18;

/* What matters in a box. */
typedef struct pick {
    uint32_t *sides;
    float *turns;
    uint32_t side_count, turn_count;
    bool odd;
    bool close; /* the outline is hardly farther off than the box is large */
} pick;

/* A side in double; 0 is the inverse of no length's square. */
typedef struct segment {
    double from[2], along[2], inverse;
} segment;

typedef struct making {
    const float (*sides)[HEWN_TABLE_SIDE];
    uint32_t count, most;
    double size, middle[2], half;
    segment *segments;      /* the sides */
    double *near;           /* a number for each side */
    pick picks[DEPTH_MOST]; /* one for each level of the descent */
    uint32_t *words;
    size_t used, capacity;
    uint32_t longest;
    uint32_t crowded_far; /* what CROWDED_FAR says, or more where nobody asks */
    bool crowded, failed;
} making;

/* fmin() and fmax() are calls, because of what they do about NaN, and there is none here. */
static inline double lesser(double a, double b)
{
    return b < a ? b : a;
}

static inline double greater(double a, double b)
{
    return b > a ? b : a;
}

typedef struct square {
    double lo[2], hi[2];
} square;

static square widened(const making *own, const square *box)
{
    square out = *box;
    double far = own->size;
    for (int i = 0; i < 2; i++)
        far += greater(fabs(box->lo[i]), fabs(box->hi[i]));
    for (int i = 0; i < 2; i++) {
        out.lo[i] -= apart * far + 1e-18;
        out.hi[i] += apart * far + 1e-18;
    }
    return out;
}

/* --- picking ------------------------------------------------------------------------------------------------------ */

static inline double square_from(const segment *side, double x, double y)
{
    double dx = x - side->from[0], dy = y - side->from[1];
    double t = lesser(greater((dx * side->along[0] + dy * side->along[1]) * side->inverse, 0), 1);
    dx -= t * side->along[0];
    dy -= t * side->along[1];
    return dx * dx + dy * dy;
}

/* How far two sides' ends are apart at most. */
static double spread(const float *a, const float *b)
{
    double most = 0;
    for (int i = 0; i < 4; i++) {
        double dx = (double)a[i & 2] - (double)b[2 * (i & 1)], dy = (double)a[(i & 2) + 1] - (double)b[2 * (i & 1) + 1];
        most = greater(most, dx * dx + dy * dy);
    }
    return sqrt(most);
}

/* How much a side can come nearer than another one somewhere in the box, against what is so in its middle. By no more
 * than twice the way; and the distances from both change alike where the directions to them are alike. */
static double gain(const float *side, double far, const float *other, double other_far, double reach)
{
    double least = lesser(far, other_far) - reach;
    return reach * (least > 0 ? lesser(2, spread(side, other) / least) : 2);
}

/* Marks the sides of `from` that can be nearest somewhere in the box by 1, the others by 0. Returns the least distance
 * in the middle. */
static double find_near(making *own, const pick *from, const square *box)
{
    double x = 0.5 * (box->lo[0] + box->hi[0]), y = 0.5 * (box->lo[1] + box->hi[1]);
    double rx = box->hi[0] - x, ry = box->hi[1] - y, reach = sqrt(rx * rx + ry * ry), least = INFINITY, most = INFINITY;
    double slack = apart * (own->size + fabs(x) + fabs(y) + 2 * reach) + 1e-18;
    const float *nearest = own->sides[0];
    for (uint32_t i = 0; i < from->side_count; i++) {
        double away = own->near[i] = square_from(&own->segments[from->sides[i]], x, y);
        nearest = away < least ? own->sides[from->sides[i]] : nearest;
        least = lesser(least, away);
    }
    least = sqrt(least);
    double limit = least + 2 * reach + slack, limit_square = limit * limit;
    for (uint32_t i = 0; i < from->side_count; i++) {
        if (own->near[i] > limit_square)
            continue;
        double farthest = 0; /* at a corner, since a distance from what is convex is convex */
        for (int corner = 0; corner < 4; corner++)
            farthest =
                greater(farthest, square_from(&own->segments[from->sides[i]], corner & 1 ? box->hi[0] : box->lo[0],
                                              corner & 2 ? box->hi[1] : box->lo[1]));
        most = lesser(most, farthest);
    }
    most = sqrt(most);
    for (uint32_t i = 0; i < from->side_count; i++) {
        double far = own->near[i] <= limit_square ? sqrt(own->near[i]) : INFINITY;
        own->near[i] = far <= limit && far - reach <= most + slack &&
                       far <= least + slack + gain(own->sides[from->sides[i]], far, nearest, least, reach);
    }
    return least;
}

/* A height at which the parity turns, if it is between the box's ends; where it is below them it has turned everywhere.
 */
static void add_turn(pick *out, const square *box, float height)
{
    if ((double)height <= box->lo[1])
        out->odd = !out->odd;
    else if ((double)height <= box->hi[1])
        out->turns[out->turn_count++] = height;
}

/* Whether a ray along x crosses a side from any place of the box at the side's height: 1 or 0, or -1 where that is not
 * the same for all of them, or rounding could tell otherwise. */
static int crosses(const float *side, const square *box)
{
    double ax = (double)side[0], ay = (double)side[1], ex = (double)side[2] - ax, ey = (double)side[3] - ay;
    double bottom = greater(box->lo[1], lesser(ay, (double)side[3])),
           top = lesser(box->hi[1], greater(ay, (double)side[3]));
    int left = 0;
    for (int corner = 0; corner < 4; corner++) {
        double dx = (corner & 1 ? box->hi[0] : box->lo[0]) - ax, dy = (corner & 2 ? top : bottom) - ay;
        double turn = ex * dy - ey * dx, error = 0x1p-20 * (fabs(ex * dy) + fabs(ey * dx)) + 1e-36;
        if (fabs(turn) <= error)
            return -1;
        left += turn > 0;
    }
    return left == 0 ? ey < 0 : left == 4 ? ey > 0 : -1;
}

/* Leaves a side out, which is nearest nowhere; false where its crossings must be computed all the same. */
static bool leave_out(pick *out, const square *box, const float *side)
{
    double bottom = lesser((double)side[1], (double)side[3]), top = greater((double)side[1], (double)side[3]);
    if (side[1] == side[3] || top <= box->lo[1] || bottom > box->hi[1])
        return true;
    int crossed = crosses(side, box);
    if (crossed > 0) {
        add_turn(out, box, side[1]);
        add_turn(out, box, side[3]);
    }
    return crossed >= 0;
}

static int by_height(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Two turns at one height are none: so it is at corners where a boundary goes on upwards. */
static void drop_pairs(pick *out)
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

/* What of level `depth` matters in a box, to the level below. Turns of a side that is left out are never more than two,
 * so there is room. */
static void descend(making *own, int depth, const square *place)
{
    const square box = widened(own, place);
    const pick *from = &own->picks[depth];
    pick *out = &own->picks[depth + 1];
    out->side_count = out->turn_count = 0;
    out->odd = from->odd;
    out->close = find_near(own, from, &box) < box.hi[0] - box.lo[0];
    for (uint32_t i = 0; i < from->turn_count; i++)
        add_turn(out, &box, from->turns[i]);
    for (uint32_t i = 0; i < from->side_count; i++)
        if (own->near[i] > 0 || !leave_out(out, &box, own->sides[from->sides[i]]))
            out->sides[out->side_count++] = from->sides[i];
    drop_pairs(out);
}

/* --- words -------------------------------------------------------------------------------------------------------- */

/* Room for more words at the end; the first one's place. */
static size_t add_words(making *own, size_t count)
{
    size_t first = own->used;
    void *words = own->words;
    if (own->failed || hewn_reserve(&words, &own->capacity, own->used + count, sizeof *own->words, NULL) != HEWN_OK) {
        own->failed = true;
        return 0;
    }
    own->words = words;
    memset(own->words + first, 0, count * sizeof *own->words);
    own->used += count;
    return first;
}

static void write_pick(making *own, const pick *from, size_t entry)
{
    uint32_t length = from->side_count + from->turn_count;
    own->longest = length > own->longest ? length : own->longest;
    own->crowded = own->crowded || length > own->most || from->side_count >= COUNT_MOST ||
                   from->turn_count >= COUNT_MOST || own->used > WORDS_MOST;
    if (own->crowded)
        return;
    size_t at = add_words(own, from->turn_count + (size_t)HEWN_TABLE_SIDE * from->side_count);
    if (own->failed)
        return;
    own->words[entry] = (uint32_t)at;
    own->words[entry + 1] =
        from->side_count | from->turn_count << HEWN_TABLE_TURNS_AT | (from->odd ? 1U : 0U) << HEWN_TABLE_ODD_AT;
    if (from->turn_count > 0)
        memcpy(own->words + at, from->turns, from->turn_count * sizeof *own->words);
    at += from->turn_count;
    for (uint32_t i = 0; i < from->side_count; i++, at += HEWN_TABLE_SIDE)
        memcpy(own->words + at, own->sides[from->sides[i]], sizeof own->sides[0]);
}

static square part(const square *box, uint32_t x, uint32_t y, uint32_t across)
{
    const uint32_t at[2] = {x, y};
    square out;
    for (int i = 0; i < 2; i++) {
        double step = (box->hi[i] - box->lo[i]) / across;
        out.lo[i] = box->lo[i] + at[i] * step;
        out.hi[i] = box->lo[i] + (at[i] + 1) * step;
    }
    return out;
}

/* Writes the cell of which the pick at `depth` tells, divided where it is crowded. */
static void write_cell(making *own, int depth, const square *box, /* NOLINT(misc-no-recursion): see DEPTH_MOST */
                       size_t entry, int divisions)
{
    const pick *from = &own->picks[depth];
    uint32_t length = from->close ? from->side_count : from->side_count + from->turn_count;
    bool crowded = divisions > 0 && length > (from->close ? CROWDED : own->crowded_far);
    if (!crowded || own->used > WORDS_MOST / 2) {
        write_pick(own, from, entry);
        return;
    }
    size_t cells = add_words(own, (size_t)2 * SMALL * SMALL);
    for (uint32_t i = 0; i < SMALL * SMALL && !own->failed && !own->crowded; i++) {
        const square inner = part(box, i % SMALL, i / SMALL, SMALL);
        descend(own, depth, &inner);
        write_cell(own, depth + 1, &inner, cells + (size_t)2 * i, divisions - 1);
    }
    if (own->failed)
        return;
    own->words[entry] = (uint32_t)cells;
    own->words[entry + 1] = 1U << 31;
}

/* So little matters in a box that its cells may share it. */
static bool is_settled(const pick *from)
{
    return from->side_count + from->turn_count <= (uint32_t)(from->close ? SETTLED : SETTLED_FAR);
}

/* What matters in a box, for all of its cells. */
static void share_pick(making *own, const pick *from, uint32_t size, size_t first, uint32_t across)
{
    write_pick(own, from, 2 * first);
    for (size_t i = 1; i < (size_t)size * size && !own->failed && !own->crowded; i++)
        memcpy(own->words + 2 * (first + i % size + i / size * across), own->words + 2 * first, 2 * sizeof *own->words);
}

/* Halves a box until its parts are cells, or may share what matters: `first` is the lowest one's place in rows of
 * `across`. */
static void write_cells(making *own, int depth, const square *box, /* NOLINT(misc-no-recursion): see DEPTH_MOST */
                        uint32_t size, size_t first, uint32_t across)
{
    if (size == 1) {
        write_cell(own, depth, box, 2 * first, DIVISIONS);
        return;
    }
    if (depth > 0 && is_settled(&own->picks[depth])) {
        share_pick(own, &own->picks[depth], size, first, across);
        return;
    }
    for (uint32_t i = 0; i < 4 && !own->failed && !own->crowded; i++) {
        const square inner = part(box, i & 1, i >> 1, 2);
        uint32_t half = size / 2;
        descend(own, depth, &inner);
        write_cells(own, depth + 1, &inner, half, first + (size_t)(i & 1) * half + (size_t)(i >> 1) * half * across,
                    across);
    }
}

static square around(const making *own, double half)
{
    return (square){{own->middle[0] - half, own->middle[1] - half}, {own->middle[0] + half, own->middle[1] + half}};
}

/* The cells of a ring that are not what it surrounds. */
static void write_ring(making *own, uint32_t ring, size_t first)
{
    const square box = around(own, own->half * pow(4, ring));
    own->crowded_far = ring == 1 ? CROWDED_FAR : own->most; /* bounds and rays end long before */
    for (uint32_t i = 0; i < RING * RING && !own->failed && !own->crowded; i++) {
        uint32_t k = i % 4, block = i / 4, x = 2 * (block % 4) + k % 2, y = 2 * (block / 4) + k / 2; /* four by four */
        bool inside = x >= 3 && x < 5 && y >= 3 && y < 5, whole = block % 4 % 3 == 0 || block / 4 % 3 == 0;
        const square cell = part(&box, x, y, RING);
        if (whole && k == 0) {
            const square four = part(&box, x / 2, y / 2, RING / 2);
            descend(own, 0, &four);
        }
        if (inside)
            continue;
        int depth = whole ? 1 : 0;
        descend(own, depth, &cell);
        write_cell(own, depth + 1, &cell, 2 * (first + x + (size_t)RING * y), DIVISIONS);
    }
}

/* Far away: one of the sides that go farthest in each direction, and to the left of the outline the heights at which a
 * ray along x meets it. */
static void write_far(making *own, size_t first)
{
    pick *out = &own->picks[1];
    bool *taken = hewn_alloc_zero(own->count, sizeof *taken);
    own->failed = own->failed || !taken;
    for (int direction = 0; direction < DIRECTIONS && taken; direction++) {
        double angle = 6.283185307179586 * direction / DIRECTIONS, x = cos(angle), y = sin(angle), most = -INFINITY;
        uint32_t farthest = 0;
        for (uint32_t i = 0; i < own->count; i++)
            for (int end = 0; end < 4; end += 2) {
                double there = x * (double)own->sides[i][end] + y * (double)own->sides[i][end + 1];
                farthest = there > most ? i : farthest;
                most = greater(most, there);
            }
        taken[farthest] = true;
    }
    for (int left = 0; left < 2 && !own->failed; left++) {
        out->side_count = out->turn_count = 0;
        out->odd = false;
        for (uint32_t i = 0; i < own->count; i++) {
            if (taken[i])
                out->sides[out->side_count++] = i;
            else if (left && own->sides[i][1] != own->sides[i][3])
                for (int end = 1; end < 4; end += 2)
                    out->turns[out->turn_count++] = own->sides[i][end];
        }
        drop_pairs(out);
        write_pick(own, out, 2 * (first + (size_t)left));
    }
    hewn_free(taken);
}

/* --- making ------------------------------------------------------------------------------------------------------- */

static void measure(making *own)
{
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < own->count; i++)
        for (int k = 0; k < 4; k++) {
            lo[k & 1] = lesser(lo[k & 1], (double)own->sides[i][k]);
            hi[k & 1] = greater(hi[k & 1], (double)own->sides[i][k]);
        }
    for (int i = 0; i < 2; i++)
        own->middle[i] = (double)(float)(0.5 * (lo[i] + hi[i]));
    own->half = 0.625 * greater(hi[0] - lo[0], hi[1] - lo[1]);
}

static segment segment_of(const float *side)
{
    segment out = {.from = {(double)side[0], (double)side[1]},
                   .along = {(double)side[2] - (double)side[0], (double)side[3] - (double)side[1]}};
    double length = out.along[0] * out.along[0] + out.along[1] * out.along[1];
    out.inverse = length > 0 ? 1 / length : 0;
    return out;
}

static bool make_room(making *own)
{
    own->near = hewn_alloc(own->count, sizeof *own->near);
    own->segments = hewn_alloc(own->count, sizeof *own->segments);
    bool enough = own->near && own->segments;
    for (int i = 0; i < DEPTH_MOST; i++) {
        own->picks[i].sides = hewn_alloc(own->count, sizeof *own->picks[i].sides);
        own->picks[i].turns = hewn_alloc((size_t)2 * own->count, sizeof *own->picks[i].turns);
        enough = enough && own->picks[i].sides && own->picks[i].turns;
    }
    for (uint32_t i = 0; i < own->count && enough; i++) {
        own->picks[0].sides[i] = i;
        own->segments[i] = segment_of(own->sides[i]);
    }
    own->picks[0].side_count = own->count;
    return enough;
}

static void fill(making *own, uint32_t across)
{
    size_t cells = (size_t)across * across, all = cells + (size_t)HEWN_TABLE_RINGS * RING * RING;
    add_words(own, 2 * (all + 2));
    const square box = around(own, own->half);
    own->crowded_far = CROWDED_FAR;
    write_cells(own, 0, &box, across, 0, across);
    for (uint32_t ring = 0; ring < HEWN_TABLE_RINGS; ring++)
        write_ring(own, ring + 1, cells + (size_t)ring * RING * RING);
    write_far(own, all);
}

hewn_result hewn_outline_table_create(const float (*sides)[HEWN_TABLE_SIDE], uint32_t count, float size, uint32_t most,
                                      hewn_outline_table *out, hewn_error *error)
{
    *out = (hewn_outline_table){0};
    making own = {.sides = sides, .count = count, .most = most, .size = (double)size};
    measure(&own);
    float inverse = (float)(1 / own.half);
    if (!(own.half > 1e-12 && own.half < 1e12 && own.half > 1e-4 * own.size))
        return HEWN_OK;
    own.half = 1 / (double)inverse;
    uint32_t across = 8;
    while (across < 128 && across * across < 4 * count)
        across *= 2;
    own.failed = !make_room(&own);
    if (!own.failed)
        fill(&own, across);
    for (int i = 0; i < DEPTH_MOST; i++) {
        hewn_free(own.picks[i].sides);
        hewn_free(own.picks[i].turns);
    }
    hewn_free(own.near);
    hewn_free(own.segments);
    if (own.failed || own.crowded) {
        hewn_free(own.words);
        return own.failed ? hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the table of an outline") : HEWN_OK;
    }
    *out = (hewn_outline_table){.words = own.words,
                                .word_count = own.used,
                                .longest = own.longest,
                                .numbers = {size, (float)own.middle[0], (float)own.middle[1], inverse, (float)across}};
    return HEWN_OK;
}
