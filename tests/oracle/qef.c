#include "qef.h"

#include <math.h>
#include <string.h>

enum { MOST_PLANES = 64, SWEEPS = 60, DESCENTS = 20000, PROJECTIONS = 20000 };

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Turns columns p and q of the planes (and of the basis) until they are orthogonal (Hestenes 1958). */
static void turn(double (*rows)[3], size_t count, double (*basis)[3], int p, int q)
{
    double pp = 0, qq = 0, pq = 0;
    for (size_t i = 0; i < count; i++) {
        pp += rows[i][p] * rows[i][p];
        qq += rows[i][q] * rows[i][q];
        pq += rows[i][p] * rows[i][q];
    }
    double angle = 0.5 * atan2(2 * pq, pp - qq), c = cos(angle), s = sin(angle);
    for (size_t i = 0; i < count; i++) {
        double a = rows[i][p], b = rows[i][q];
        rows[i][p] = c * a + s * b;
        rows[i][q] = c * b - s * a;
    }
    for (int k = 0; k < 3; k++) {
        double a = basis[p][k], b = basis[q][k];
        basis[p][k] = c * a + s * b;
        basis[q][k] = c * b - s * a;
    }
}

static void order(oracle_qef *qef, const double values[3], double (*basis)[3])
{
    bool used[3] = {false};
    for (int place = 0; place < 3; place++) {
        int most = -1;
        for (int k = 0; k < 3; k++)
            if (!used[k] && (most < 0 || values[k] > values[most]))
                most = k;
        used[most] = true;
        qef->values[place] = values[most];
        memcpy(qef->vectors[place], basis[most], sizeof qef->vectors[place]);
    }
}

oracle_qef oracle_qef_of(const double (*points)[3], const double (*normals)[3], size_t count, const double mass[3],
                         double cut)
{
    oracle_qef qef = {0};
    double rows[MOST_PLANES][3], basis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, values[3];
    memcpy(rows, normals, count * sizeof *rows);
    memcpy(qef.mass, mass, sizeof qef.mass);
    memcpy(qef.best, mass, sizeof qef.best);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++)
                turn(rows, count, basis, p, q);
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (size_t i = 0; i < count; i++)
            sum += rows[i][k] * rows[i][k];
        values[k] = sqrt(sum);
    }
    order(&qef, values, basis);
    for (int k = 0; k < 3 && qef.values[k] > 0 && qef.values[k] >= cut * qef.values[0]; k++) {
        qef.rank++;
        double sum = 0;
        for (size_t i = 0; i < count; i++) {
            double off[3] = {points[i][0] - mass[0], points[i][1] - mass[1], points[i][2] - mass[2]};
            sum += dot(normals[i], qef.vectors[k]) * dot(normals[i], off);
        }
        for (int axis = 0; axis < 3; axis++)
            qef.best[axis] += qef.vectors[k][axis] * sum / (qef.values[k] * qef.values[k]);
    }
    return qef;
}

double oracle_qef_error(const oracle_qef *qef, const double at[3])
{
    double off[3] = {at[0] - qef->best[0], at[1] - qef->best[1], at[2] - qef->best[2]}, sum = 0;
    for (int k = 0; k < qef->rank; k++) {
        double part = qef->values[k] * dot(qef->vectors[k], off);
        sum += part * part;
    }
    return sqrt(sum);
}

static void keep_in(const double lo[3], const double hi[3], double at[3])
{
    for (int axis = 0; axis < 3; axis++)
        at[axis] = fmin(fmax(at[axis], lo[axis]), hi[axis]);
}

/* Accelerated projected descent (Beck and Teboulle 2009), begun again whenever it runs uphill. */
static void descend(const oracle_qef *qef, const double lo[3], const double hi[3], double at[3])
{
    double ahead[3], weight = 1, step = 1 / (qef->values[0] * qef->values[0]);
    memcpy(ahead, at, sizeof ahead);
    for (int trial = 0; trial < DESCENTS; trial++) {
        double next[3] = {ahead[0], ahead[1], ahead[2]}, off[3], uphill = 0, moved = 0;
        for (int axis = 0; axis < 3; axis++)
            off[axis] = ahead[axis] - qef->best[axis];
        for (int k = 0; k < qef->rank; k++)
            for (int axis = 0; axis < 3; axis++)
                next[axis] -=
                    step * qef->values[k] * qef->values[k] * dot(qef->vectors[k], off) * qef->vectors[k][axis];
        keep_in(lo, hi, next);
        for (int axis = 0; axis < 3; axis++) {
            uphill += (ahead[axis] - next[axis]) * (next[axis] - at[axis]);
            moved = fmax(moved, fabs(next[axis] - ahead[axis]));
        }
        double heavier = uphill > 0 ? 1 : 0.5 * (1 + sqrt(1 + 4 * weight * weight));
        for (int axis = 0; axis < 3; axis++) {
            ahead[axis] = next[axis] + (uphill > 0 ? 0 : (weight - 1) / heavier * (next[axis] - at[axis]));
            at[axis] = next[axis];
        }
        weight = heavier;
        if (moved < 1e-13)
            break;
    }
}

/* The place on a line through `good` within the box that is nearest to the mass point. */
static void nearest_on_line(const oracle_qef *qef, const double lo[3], const double hi[3], const double good[3],
                            double out[3])
{
    const double *along = qef->vectors[2];
    double from = -INFINITY, to = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        if (along[axis] == 0)
            continue;
        double a = (lo[axis] - good[axis]) / along[axis], b = (hi[axis] - good[axis]) / along[axis];
        from = fmax(from, fmin(0, fmin(a, b)));
        to = fmin(to, fmax(0, fmax(a, b)));
    }
    const double off[3] = {qef->mass[0] - good[0], qef->mass[1] - good[1], qef->mass[2] - good[2]};
    double t = fmin(fmax(dot(off, along), from), to);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = good[axis] + t * along[axis];
}

/* Dykstra's projections (1983) onto the plane of points that are as good as `good` and onto the box. */
static void nearest_on_plane(const oracle_qef *qef, const double lo[3], const double hi[3], const double good[3],
                             double out[3])
{
    double plus[3] = {0};
    memcpy(out, qef->mass, sizeof plus);
    for (int trial = 0; trial < PROJECTIONS; trial++) {
        const double off[3] = {out[0] - good[0], out[1] - good[1], out[2] - good[2]};
        double above = dot(qef->vectors[0], off), moved = 0;
        for (int axis = 0; axis < 3; axis++) {
            double wanted = out[axis] - above * qef->vectors[0][axis] + plus[axis];
            double kept = fmin(fmax(wanted, lo[axis]), hi[axis]);
            plus[axis] = wanted - kept;
            moved = fmax(moved, fabs(kept - out[axis]));
            out[axis] = kept;
        }
        if (moved < 1e-13)
            break;
    }
    /* Where the plane only grazes the box they take too long, and there is next to no choice. */
    if (oracle_qef_error(qef, out) > oracle_qef_error(qef, good) + 1e-9)
        memcpy(out, good, sizeof plus);
}

void oracle_qef_in_box(const oracle_qef *qef, const double lo[3], const double hi[3], double out[3])
{
    double good[3];
    memcpy(good, qef->mass, sizeof good);
    keep_in(lo, hi, good);
    if (qef->rank > 0)
        descend(qef, lo, hi, good);
    if (qef->rank == 2)
        nearest_on_line(qef, lo, hi, good, out);
    else if (qef->rank == 1)
        nearest_on_plane(qef, lo, hi, good, out);
    else
        memcpy(out, good, sizeof good);
}
