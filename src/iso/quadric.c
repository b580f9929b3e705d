#include "iso/quadric.h"

#include <math.h>
#include <string.h>

void hewn_quadric_add_plane(hewn_quadric *quadric, const double point[3], const double normal[3])
{
    if (quadric->weight == 0)
        memcpy(quadric->origin, point, sizeof quadric->origin);
    double offset = 0, local[3];
    for (int i = 0; i < 3; i++) {
        local[i] = point[i] - quadric->origin[i];
        offset += normal[i] * local[i];
    }
    for (int i = 0, k = 0; i < 3; i++) {
        for (int j = i; j < 3; j++)
            quadric->square[k++] += normal[i] * normal[j];
        quadric->linear[i] += normal[i] * offset;
        quadric->points[i] += local[i];
    }
    quadric->constant += offset * offset;
    quadric->weight += 1;
}

/* The matrix times a vector. */
static void apply(const hewn_quadric *quadric, const double v[3], double out[3])
{
    const double *s = quadric->square;
    out[0] = s[0] * v[0] + s[1] * v[1] + s[2] * v[2];
    out[1] = s[1] * v[0] + s[3] * v[1] + s[4] * v[2];
    out[2] = s[2] * v[0] + s[4] * v[1] + s[5] * v[2];
}

void hewn_quadric_add(hewn_quadric *quadric, const hewn_quadric *other)
{
    if (quadric->weight == 0) {
        *quadric = *other;
        return;
    }
    double shift[3], moved[3];
    for (int i = 0; i < 3; i++)
        shift[i] = other->origin[i] - quadric->origin[i];
    apply(other, shift, moved);
    for (int i = 0; i < 6; i++)
        quadric->square[i] += other->square[i];
    quadric->constant += other->constant;
    for (int i = 0; i < 3; i++) {
        quadric->constant += shift[i] * (2 * other->linear[i] + moved[i]);
        quadric->linear[i] += other->linear[i] + moved[i];
        quadric->points[i] += other->points[i] + other->weight * shift[i];
    }
    quadric->weight += other->weight;
}

void hewn_quadric_centre(const hewn_quadric *quadric, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = quadric->origin[i] + (quadric->weight > 0 ? quadric->points[i] / quadric->weight : 0);
}

double hewn_quadric_distance(const hewn_quadric *quadric, const double at[3])
{
    double local[3], moved[3], sum = quadric->constant;
    for (int i = 0; i < 3; i++)
        local[i] = at[i] - quadric->origin[i];
    apply(quadric, local, moved);
    for (int i = 0; i < 3; i++)
        sum += local[i] * (moved[i] - 2 * quadric->linear[i]);
    return sum > 0 ? sqrt(sum / quadric->weight) : 0;
}

/* --- the minimum in a box ------------------------------------------------------------------------------------------
 */

/* Minimise x.Mx - 2 v.x, with M positive definite, for lo <= x <= hi. */
typedef struct program {
    double matrix[3][3], vector[3], lo[3], hi[3];
} program;

static double value_of(const program *p, const double x[3])
{
    double value = 0;
    for (int i = 0; i < 3; i++) {
        value -= 2 * p->vector[i] * x[i];
        for (int j = 0; j < 3; j++)
            value += x[i] * p->matrix[i][j] * x[j];
    }
    return value;
}

/* Solves for the coordinates in `open`; the others stay what they are in x. Elimination needs no pivots, as the matrix
 * is positive definite. */
static void solve(const program *p, const int *open, int count, double x[3])
{
    double rows[3][4];
    for (int i = 0; i < count; i++) {
        rows[i][3] = p->vector[open[i]];
        for (int j = 0; j < count; j++)
            rows[i][j] = p->matrix[open[i]][open[j]];
        for (int j = 0; j < 3; j++) {
            bool fixed = true;
            for (int k = 0; k < count; k++)
                fixed &= open[k] != j;
            if (fixed)
                rows[i][3] -= p->matrix[open[i]][j] * x[j];
        }
    }
    for (int i = 0; i < count; i++)
        for (int k = i + 1; k < count; k++) {
            double share = rows[k][i] / rows[i][i];
            for (int j = i; j < count; j++)
                rows[k][j] -= share * rows[i][j];
            rows[k][3] -= share * rows[i][3];
        }
    for (int i = count - 1; i >= 0; i--) {
        double sum = rows[i][3];
        for (int j = i + 1; j < count; j++)
            sum -= rows[i][j] * x[open[j]];
        x[open[i]] = sum / rows[i][i];
    }
}

/* One of 27 places: each coordinate open, at its low end, or at its high end. False where it leaves the box. */
static bool solve_at(const program *p, int place, double x[3])
{
    int open[3], count = 0;
    for (int i = 0; i < 3; i++, place /= 3) {
        if (place % 3 == 0)
            open[count++] = i;
        else
            x[i] = place % 3 == 1 ? p->lo[i] : p->hi[i];
    }
    solve(p, open, count, x);
    for (int i = 0; i < 3; i++)
        if (!(x[i] >= p->lo[i] && x[i] <= p->hi[i]))
            return false;
    return true;
}

void hewn_quadric_minimise(const hewn_quadric *quadric, double hold, const hewn_box *box, double at[3])
{
    static const int places[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    program p;
    double local[3], moved[3], best[3] = {0, 0, 0}, least = INFINITY;
    for (int i = 0; i < 3; i++)
        local[i] = at[i] - quadric->origin[i];
    apply(quadric, local, moved);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            p.matrix[i][j] = quadric->square[places[i][j]] / quadric->weight + (i == j ? hold : 0);
        p.vector[i] = (quadric->linear[i] - moved[i]) / quadric->weight;
        p.lo[i] = box->lo[i] - at[i];
        p.hi[i] = box->hi[i] - at[i];
        best[i] = fmin(fmax(0, p.lo[i]), p.hi[i]);
    }
    for (int place = 0; place < 27; place++) {
        double x[3];
        if (!solve_at(&p, place, x))
            continue;
        double value = value_of(&p, x);
        if (value < least) {
            least = value;
            memcpy(best, x, sizeof best);
        }
        if (place == 0)
            break; /* the minimum of all is in the box */
    }
    for (int i = 0; i < 3; i++)
        at[i] = fmin(fmax(at[i] + best[i], box->lo[i]), box->hi[i]);
}
