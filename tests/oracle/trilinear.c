#include "trilinear.h"

#include <gmp.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* --- heights ----------------------------------------------------------------------------------------------------- */

/* (u + v sqrt(D)) / w with w > 0; D is the cell's. */
typedef struct height {
    mpz_t u, v, w;
} height;

enum { MOST_HEIGHTS = 8 }; /* 0, four columns, two of the quadratic, 1 */

/* A cell under examination: values as integers of a common scale, column i from low[i] to low[i] + rise[i], and
 * q = column 0 times column 2 less column 1 times column 3, as q2 z^2 + q1 z + q0. Columns in order around the slice.
 */
typedef struct sweep {
    mpz_t low[4], rise[4], q[3], root; /* root: D */
    mpz_t t[6];
    height at[MOST_HEIGHTS], middle;
    int count;
} sweep;

static void sweep_init(sweep *s)
{
    for (int i = 0; i < 4; i++)
        mpz_inits(s->low[i], s->rise[i], NULL);
    mpz_inits(s->q[0], s->q[1], s->q[2], s->root, NULL);
    for (int i = 0; i < 6; i++)
        mpz_init(s->t[i]);
    for (int i = 0; i < MOST_HEIGHTS; i++)
        mpz_inits(s->at[i].u, s->at[i].v, s->at[i].w, NULL);
    mpz_inits(s->middle.u, s->middle.v, s->middle.w, NULL);
}

static void sweep_clear(sweep *s)
{
    for (int i = 0; i < 4; i++)
        mpz_clears(s->low[i], s->rise[i], NULL);
    mpz_clears(s->q[0], s->q[1], s->q[2], s->root, NULL);
    for (int i = 0; i < 6; i++)
        mpz_clear(s->t[i]);
    for (int i = 0; i < MOST_HEIGHTS; i++)
        mpz_clears(s->at[i].u, s->at[i].v, s->at[i].w, NULL);
    mpz_clears(s->middle.u, s->middle.v, s->middle.w, NULL);
}

/* The sign of u + v sqrt(D). */
static int sign_of(sweep *s, const mpz_t u, const mpz_t v)
{
    int su = mpz_sgn(u), sv = mpz_sgn(s->root) == 0 ? 0 : mpz_sgn(v);
    if (su == 0 || sv == 0 || su == sv)
        return su ? su : sv;
    mpz_mul(s->t[4], u, u);
    mpz_mul(s->t[5], v, v);
    mpz_mul(s->t[5], s->t[5], s->root);
    return su * mpz_cmp(s->t[4], s->t[5]) > 0 ? 1 : mpz_cmp(s->t[4], s->t[5]) == 0 ? 0 : -1;
}

static int compare(sweep *s, const height *a, const height *b)
{
    mpz_mul(s->t[0], a->u, b->w);
    mpz_submul(s->t[0], b->u, a->w);
    mpz_mul(s->t[1], a->v, b->w);
    mpz_submul(s->t[1], b->v, a->w);
    return sign_of(s, s->t[0], s->t[1]);
}

/* Puts the height in at[count] into its place if it lies between the first two heights, 0 and 1, and is new. */
static void keep_height(sweep *s)
{
    height *fresh = &s->at[s->count];
    if (mpz_sgn(fresh->w) < 0) {
        mpz_neg(fresh->u, fresh->u);
        mpz_neg(fresh->v, fresh->v);
        mpz_neg(fresh->w, fresh->w);
    }
    int place = 0;
    while (place < s->count && compare(s, &s->at[place], fresh) < 0)
        place++;
    if (place == 0 || place == s->count || compare(s, &s->at[place], fresh) == 0)
        return;
    height moved = *fresh;
    memmove(&s->at[place + 1], &s->at[place], (size_t)(s->count - place) * sizeof moved);
    s->at[place] = moved;
    s->count++;
}

static void set_height(height *at, long u, unsigned long w)
{
    mpz_set_si(at->u, u);
    mpz_set_ui(at->v, 0);
    mpz_set_ui(at->w, w);
}

static void find_heights(sweep *s)
{
    set_height(&s->at[0], 0, 1);
    set_height(&s->at[1], 1, 1);
    s->count = 2;
    for (int i = 0; i < 4; i++) {
        if (mpz_sgn(s->rise[i]) == 0)
            continue;
        height *fresh = &s->at[s->count];
        mpz_neg(fresh->u, s->low[i]);
        mpz_set_ui(fresh->v, 0);
        mpz_set(fresh->w, s->rise[i]);
        keep_height(s);
    }
    bool square = mpz_sgn(s->q[2]) != 0;
    if (!square && mpz_sgn(s->q[1]) == 0)
        return;
    if (square && mpz_sgn(s->root) < 0)
        return;
    for (int side = -1; side <= (square ? 1 : -1); side += 2) {
        height *fresh = &s->at[s->count];
        mpz_neg(fresh->u, square ? s->q[1] : s->q[0]);
        mpz_set_si(fresh->v, square ? side : 0);
        mpz_mul_ui(fresh->w, square ? s->q[2] : s->q[1], square ? 2 : 1);
        keep_height(s);
    }
}

/* --- one slice ---------------------------------------------------------------------------------------------------- */

typedef struct slice {
    bool in[4];
    bool joined; /* column 0 with 2 or 1 with 3 inside across the slice; else the outside is */
} slice;

static slice look(sweep *s, const height *z)
{
    slice seen = {0};
    for (int i = 0; i < 4; i++) {
        mpz_mul(s->t[0], s->low[i], z->w);
        mpz_addmul(s->t[0], s->rise[i], z->u);
        mpz_mul(s->t[1], s->rise[i], z->v);
        seen.in[i] = sign_of(s, s->t[0], s->t[1]) < 0;
    }
    if (seen.in[0] == seen.in[1] || seen.in[0] != seen.in[2] || seen.in[1] != seen.in[3])
        return seen;
    /* q w^2 at z = (u + v r) / w is (q2 (u^2 + v^2 D) + q1 u w + q0 w^2) + (2 q2 u v + q1 v w) r. */
    mpz_mul(s->t[0], z->u, z->u);
    mpz_mul(s->t[1], z->v, z->v);
    mpz_addmul(s->t[0], s->t[1], s->root);
    mpz_mul(s->t[0], s->t[0], s->q[2]);
    mpz_mul(s->t[1], z->u, z->w);
    mpz_addmul(s->t[0], s->t[1], s->q[1]);
    mpz_mul(s->t[1], z->w, z->w);
    mpz_addmul(s->t[0], s->t[1], s->q[0]);
    mpz_mul(s->t[1], z->u, s->q[2]);
    mpz_mul_ui(s->t[1], s->t[1], 2);
    mpz_addmul(s->t[1], z->w, s->q[1]);
    mpz_mul(s->t[1], s->t[1], z->v);
    int sign = sign_of(s, s->t[0], s->t[1]);
    seen.joined = seen.in[0] ? sign > 0 : sign < 0;
    return seen;
}

static int discs(const slice *seen)
{
    int inside = 0, changes = 0;
    for (int i = 0; i < 4; i++) {
        inside += seen->in[i];
        changes += seen->in[i] != seen->in[(i + 1) % 4];
    }
    return inside == 0 ? 0 : changes == 4 && !seen->joined ? 2 : 1;
}

/* --- components --------------------------------------------------------------------------------------------------- */

static uint32_t find(uint32_t *parent, uint32_t of)
{
    while (parent[of] != of) {
        parent[of] = parent[parent[of]];
        of = parent[of];
    }
    return of;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    parent[find(parent, a)] = find(parent, b);
}

static void join_slice(uint32_t *parent, uint32_t first, const slice *seen)
{
    for (uint32_t i = 0; i < 4; i++)
        if (seen->in[i] == seen->in[(i + 1) % 4])
            join(parent, first + i, first + (i + 1) % 4);
    for (uint32_t i = 0; i < 2; i++)
        if (seen->in[i] == seen->in[i + 2] && seen->in[i] == seen->joined)
            if (seen->in[i] != seen->in[i + 1] && seen->in[i] != seen->in[(i + 3) % 4])
                join(parent, first + i, first + i + 2);
}

/* --- a cell ------------------------------------------------------------------------------------------------------- */

/* Integers that are the values times one power of two. */
static void load_values(sweep *s, const double values[8])
{
    static const int column[4] = {0, 1, 3, 2};
    int least = 0;
    for (int c = 0; c < 8; c++) {
        int exponent;
        if (values[c] != 0 && (frexp(values[c], &exponent), exponent - 53 < least))
            least = exponent - 53;
    }
    for (int i = 0; i < 4; i++) {
        for (int side = 0; side < 2; side++) {
            int exponent;
            double fraction = frexp(values[column[i] + 4 * side], &exponent);
            mpz_ptr into = side ? s->rise[i] : s->low[i];
            mpz_set_d(into, ldexp(fraction, 53));
            if (fraction != 0)
                mpz_mul_2exp(into, into, (mp_bitcnt_t)(exponent - 53 - least));
        }
        mpz_sub(s->rise[i], s->rise[i], s->low[i]);
    }
    for (int i = 0; i < 3; i++)
        mpz_set_ui(s->q[i], 0);
    mpz_addmul(s->q[0], s->low[0], s->low[2]);
    mpz_submul(s->q[0], s->low[1], s->low[3]);
    mpz_addmul(s->q[1], s->low[0], s->rise[2]);
    mpz_addmul(s->q[1], s->rise[0], s->low[2]);
    mpz_submul(s->q[1], s->low[1], s->rise[3]);
    mpz_submul(s->q[1], s->rise[1], s->low[3]);
    mpz_addmul(s->q[2], s->rise[0], s->rise[2]);
    mpz_submul(s->q[2], s->rise[1], s->rise[3]);
    mpz_mul(s->root, s->q[1], s->q[1]);
    mpz_mul(s->t[0], s->q[2], s->q[0]);
    mpz_submul_ui(s->root, s->t[0], 4);
}

static const height *between(sweep *s, const height *a, const height *b)
{
    mpz_mul(s->middle.u, a->u, b->w);
    mpz_addmul(s->middle.u, b->u, a->w);
    mpz_mul(s->middle.v, a->v, b->w);
    mpz_addmul(s->middle.v, b->v, a->w);
    mpz_mul(s->middle.w, a->w, b->w);
    mpz_mul_ui(s->middle.w, s->middle.w, 2);
    return &s->middle;
}

static oracle_cell sweep_cell(sweep *s, const double values[8])
{
    oracle_cell out = {0};
    uint32_t parent[4 * 2 * MOST_HEIGHTS];
    for (uint32_t i = 0; i < sizeof parent / sizeof *parent; i++)
        parent[i] = i;
    load_values(s, values);
    find_heights(s);
    slice before = {0};
    uint32_t slices = 2 * (uint32_t)s->count - 1;
    for (uint32_t i = 0; i < slices; i++) {
        bool exact = i % 2 == 0;
        slice here = look(s, exact ? &s->at[i / 2] : between(s, &s->at[i / 2], &s->at[i / 2 + 1]));
        join_slice(parent, 4 * i, &here);
        /* Inside is open, so what is inside at a height is so next to it; outside is closed and goes the other way. */
        for (uint32_t c = 0; i > 0 && c < 4; c++) {
            bool at = exact ? here.in[c] : before.in[c], beside = exact ? before.in[c] : here.in[c];
            if (at || !beside)
                join(parent, 4 * i + c, 4 * (i - 1) + c);
        }
        if (i > 0 && i < slices - 1)
            out.euler += exact ? discs(&here) : -discs(&here);
        before = here;
    }
    static const uint32_t column[4] = {0, 1, 3, 2};
    for (uint32_t c = 0; c < 4; c++) {
        out.label[column[c]] = (uint8_t)find(parent, c);
        out.label[column[c] + 4] = (uint8_t)find(parent, 4 * (slices - 1) + c);
    }
    return out;
}

oracle_cell oracle_trilinear_cell(const double values[8])
{
    sweep s;
    sweep_init(&s);
    oracle_cell out = sweep_cell(&s, values);
    sweep_clear(&s);
    return out;
}

/* --- a grid ------------------------------------------------------------------------------------------------------- */

/* Discs of inside in the open square with these values around it: what a slice of a cell that does not change has. */
static int square_discs(sweep *s, const double around[4])
{
    bool in[4];
    int inside = 0;
    for (int i = 0; i < 4; i++)
        inside += in[i] = around[i] < 0;
    if (inside != 2 || in[0] != in[2])
        return inside > 0;
    double values[8];
    static const int column[4] = {0, 1, 3, 2};
    for (int i = 0; i < 4; i++)
        values[column[i]] = values[column[i] + 4] = around[i];
    load_values(s, values);
    set_height(&s->at[0], 0, 1);
    slice seen = look(s, &s->at[0]);
    return discs(&seen);
}

typedef struct grid_walk {
    const uint32_t *samples;
    const double *values;
    sweep s;
    uint32_t *parent;
    int64_t euler; /* of the inside, with compact support */
} grid_walk;

static void walk_sample(grid_walk *walk, const uint32_t at[3], uint32_t index)
{
    const uint32_t *n = walk->samples;
    uint32_t step[3] = {1, n[0], n[0] * n[1]};
    const double *v = walk->values + index;
    bool room[3] = {at[0] + 1 < n[0], at[1] + 1 < n[1], at[2] + 1 < n[2]};
    walk->euler += v[0] < 0;
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3;
        if (room[axis])
            walk->euler -= v[0] < 0 || v[step[axis]] < 0;
        if (room[axis] && room[next])
            walk->euler += square_discs(
                &walk->s, (const double[4]){v[0], v[step[axis]], v[step[axis] + step[next]], v[step[next]]});
    }
    if (!room[0] || !room[1] || !room[2])
        return;
    double corners[8];
    uint32_t index_of[8], inside = 0;
    for (uint32_t c = 0; c < 8; c++) {
        index_of[c] = (c & 1) * step[0] + (c >> 1 & 1) * step[1] + (c >> 2) * step[2];
        corners[c] = v[index_of[c]];
        inside += corners[c] < 0;
    }
    oracle_cell cell = {.euler = inside == 8 ? -1 : 0};
    if (inside % 8 != 0)
        cell = sweep_cell(&walk->s, corners);
    walk->euler += cell.euler;
    for (uint32_t a = 0; a < 8; a++)
        for (uint32_t b = 0; b < a; b++)
            if (cell.label[a] == cell.label[b])
                join(walk->parent, index + index_of[a], index + index_of[b]);
}

oracle_topology oracle_trilinear(const uint32_t samples[3], const double *values)
{
    uint32_t count = samples[0] * samples[1] * samples[2], index = 0, at[3];
    grid_walk walk = {.samples = samples, .values = values, .parent = malloc(count * sizeof(uint32_t))};
    if (!walk.parent)
        abort();
    sweep_init(&walk.s);
    for (uint32_t i = 0; i < count; i++)
        walk.parent[i] = i;
    for (at[2] = 0; at[2] < samples[2]; at[2]++)
        for (at[1] = 0; at[1] < samples[1]; at[1]++)
            for (at[0] = 0; at[0] < samples[0]; at[0]++)
                walk_sample(&walk, at, index++);
    /* The inside is an open 3-manifold, so its own Euler number is the negative; the boundary of its closure has twice
     * that. Each closed surface in a ball separates it, so the parts and the surfaces between them are a tree. */
    oracle_topology out = {.euler = -2 * walk.euler};
    for (uint32_t i = 0; i < count; i++)
        out.components += walk.parent[i] == i;
    out.components--;
    sweep_clear(&walk.s);
    free(walk.parent);
    return out;
}
