/* Mean curvature flow by backward Euler: (M / t + L) x' = (M / t) x, with the weights and areas of the start kept for
 * all steps, or as many as are asked for, so that one factorisation serves steps and axes. M and L are symmetric; with
 * M / t > 0 the sum is positive definite for any step. Vertices that do not move are no unknowns.
 *
 * CHOLMOD (Chen, Davis, Hager, Rajamanickam 2008) factors by supernodes, with the order of METIS: its products are
 * BLAS', so bytes are the same for one BLAS and its number of threads. */
#include <cholmod.h>
#include <float.h>
#include <string.h>

#include "base/alloc.h"
#include "smooth/cotangent.h"

typedef struct implicit_solve {
    smooth_work *work;
    uint32_t *unknown; /* of each vertex, or HEWN_NONE */
    uint32_t unknowns;
    smooth_triangle *triangles;
    double *mass; /* M / t of each unknown */
    cholmod_common common;
    cholmod_sparse *matrix;
    cholmod_factor *factor;
    cholmod_dense *right;
} implicit_solve;

static hewn_result explain(const implicit_solve *solve, hewn_error *error)
{
    switch (solve->common.status) {
    case CHOLMOD_OUT_OF_MEMORY:
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory solving for %u vertices", solve->unknowns);
    case CHOLMOD_TOO_LARGE:
        return hewn_fail(error, HEWN_LIMIT, "the equations of %u vertices are too many to solve", solve->unknowns);
    default:
        return hewn_fail(error, HEWN_INTERNAL, "the equations could not be factored (CHOLMOD says %d)",
                         solve->common.status);
    }
}

static void number_unknowns(implicit_solve *solve)
{
    const smooth_work *work = solve->work;
    for (uint32_t v = 0; v < work->count; v++) {
        bool moves = work->flags[v] == SMOOTH_USED && smooth_freedom(work, v) > 0;
        solve->unknown[v] = moves ? solve->unknowns++ : HEWN_NONE;
    }
}

/* --- the matrix --------------------------------------------------------------------------------------------------- */

/* One column: its unknown neighbours of lower number in ascending order, then itself. */
typedef struct column {
    int *rows;
    double *values;
    int length;
} column;

static void add_entry(column *to, int row, double value)
{
    int at = to->length;
    while (at > 0 && to->rows[at - 1] > row)
        at--;
    if (at > 0 && to->rows[at - 1] == row) {
        to->values[at - 1] += value;
        return;
    }
    for (int i = to->length++; i > at; i--) {
        to->rows[i] = to->rows[i - 1];
        to->values[i] = to->values[i - 1];
    }
    to->rows[at] = row;
    to->values[at] = value;
}

/* What the triangle of a corner at v gives to v, and the vertices at its other corners. */
static smooth_corner corner_at(const implicit_solve *solve, uint32_t v, uint32_t corner, uint32_t other[2])
{
    const smooth_work *work = solve->work;
    double u[3], w[3];
    smooth_others(work->cut.corners, corner, &other[0], &other[1]);
    smooth_between(work->at + 3 * (size_t)v, work->at + 3 * (size_t)other[0], u);
    smooth_between(work->at + 3 * (size_t)v, work->at + 3 * (size_t)other[1], w);
    return smooth_corner_of(solve->triangles + corner / 3, corner % 3, u, w);
}

/* Fills a column in and returns the vertex' mixed area. */
static double fill_column(const implicit_solve *solve, uint32_t v, column *to)
{
    const smooth_work *work = solve->work;
    double diagonal = 0, area = 0;
    int self = (int)solve->unknown[v];
    to->length = 0;
    for (uint32_t i = work->fans.first[v]; i < work->fans.first[v + 1]; i++) {
        uint32_t other[2];
        smooth_corner corner = corner_at(solve, v, work->fans.items[i], other);
        const double weights[2] = {corner.ab, corner.ac};
        for (int k = 0; k < 2; k++)
            if (solve->unknown[other[k]] < solve->unknown[v])
                add_entry(to, (int)solve->unknown[other[k]], -weights[k]);
        diagonal += corner.ab + corner.ac;
        area += corner.area;
    }
    add_entry(to, self, diagonal);
    return area;
}

/* Room for a column is two entries a corner and one more, so columns can be filled by threads; then they move up. */
static hewn_result build_matrix(implicit_solve *solve, hewn_error *error)
{
    const smooth_work *work = solve->work;
    size_t room = 0;
    for (uint32_t v = 0; v < work->count; v++)
        if (solve->unknown[v] != HEWN_NONE)
            room += 2 * (size_t)(work->fans.first[v + 1] - work->fans.first[v]) + 1;
    solve->matrix =
        cholmod_allocate_sparse(solve->unknowns, solve->unknowns, room, 1, 1, 1, CHOLMOD_REAL, &solve->common);
    if (!solve->matrix)
        return explain(solve, error);
    int *begin = solve->matrix->p, *rows = solve->matrix->i;
    double *values = solve->matrix->x, time = work->desc->step * work->desc->step / 2, whole = 0;
    int used = 0;
    for (uint32_t v = 0; v < work->count; v++) {
        if (solve->unknown[v] == HEWN_NONE)
            continue;
        column next = {rows + used, values + used, 0};
        uint32_t u = solve->unknown[v];
        begin[u] = used;
        solve->mass[u] = fill_column(solve, v, &next);
        whole += solve->mass[u];
        used += next.length;
    }
    begin[solve->unknowns] = used;
    for (uint32_t v = 0; v < work->count; v++) {
        uint32_t u = solve->unknown[v];
        if (u == HEWN_NONE)
            continue;
        double *diagonal = &values[begin[u + 1] - 1];
        double least = 1e-9 * whole / solve->unknowns; /* vertices without area would have no equation */
        double mass = (solve->mass[u] > least ? solve->mass[u] : least) / (time * smooth_freedom(work, v));
        mass += 1e-12 * fabs(*diagonal) + DBL_MIN; /* more than L loses of its rows' zero sums by rounding */
        solve->mass[u] = mass;
        *diagonal += mass;
    }
    return HEWN_OK;
}

/* --- steps -------------------------------------------------------------------------------------------------------- */

/* What neighbours that stay put on the right side. */
static void add_fixed(const implicit_solve *solve, uint32_t v, double right[3])
{
    const smooth_work *work = solve->work;
    for (uint32_t i = work->fans.first[v]; i < work->fans.first[v + 1]; i++) {
        uint32_t other[2];
        smooth_others(work->cut.corners, work->fans.items[i], &other[0], &other[1]);
        if (solve->unknown[other[0]] != HEWN_NONE && solve->unknown[other[1]] != HEWN_NONE)
            continue;
        smooth_corner corner = corner_at(solve, v, work->fans.items[i], other);
        const double weights[2] = {corner.ab, corner.ac};
        for (int k = 0; k < 2; k++)
            for (size_t axis = 0; axis < 3 && solve->unknown[other[k]] == HEWN_NONE; axis++)
                right[axis] += weights[k] * work->at[3 * (size_t)other[k] + axis];
    }
}

/* `fixed` is three numbers an unknown, the same in every step. */
static hewn_result take_step(implicit_solve *solve, const double *fixed, hewn_error *error)
{
    smooth_work *work = solve->work;
    double *right = solve->right->x;
    size_t n = solve->unknowns;
    for (uint32_t v = 0; v < work->count; v++)
        for (size_t axis = 0, u = solve->unknown[v]; axis < 3 && u != HEWN_NONE; axis++)
            right[axis * n + u] = solve->mass[u] * work->at[3 * (size_t)v + axis] + fixed[axis * n + u];
    cholmod_dense *solution = cholmod_solve(CHOLMOD_A, solve->factor, solve->right, &solve->common);
    if (!solution)
        return explain(solve, error);
    const double *x = solution->x;
    for (uint32_t v = 0; v < work->count; v++)
        for (size_t axis = 0, u = solve->unknown[v]; axis < 3 && u != HEWN_NONE; axis++)
            work->at[3 * (size_t)v + axis] = x[axis * n + u];
    cholmod_free_dense(&solution, &solve->common);
    return HEWN_OK;
}

static void find_fixed(const implicit_solve *solve, double *fixed)
{
    const smooth_work *work = solve->work;
    const size_t n = solve->unknowns;
    for (uint32_t v = 0; v < work->count; v++) {
        double sum[3] = {0, 0, 0};
        if (solve->unknown[v] == HEWN_NONE)
            continue;
        add_fixed(solve, v, sum);
        for (size_t axis = 0; axis < 3; axis++)
            fixed[axis * n + solve->unknown[v]] = sum[axis];
    }
}

static hewn_result report(const implicit_solve *solve, double steps, hewn_error *error)
{
    const hewn_smooth_desc *desc = solve->work->desc;
    return hewn_progress_report(desc->progress, "smooth", fmin(steps / desc->iterations, 1), error);
}

static hewn_result factor(implicit_solve *solve, uint32_t done, hewn_error *error)
{
    solve->factor = cholmod_analyze(solve->matrix, &solve->common);
    if (!solve->factor)
        return explain(solve, error);
    HEWN_TRY(report(solve, done + 0.2, error));
    if (!cholmod_factorize(solve->matrix, solve->factor, &solve->common) || solve->common.status != CHOLMOD_OK)
        return explain(solve, error);
    return report(solve, done + 0.6, error);
}

/* Steps by weights that are measured before the first of them. */
static hewn_result run_round(implicit_solve *solve, uint32_t begin, uint32_t end, double *fixed, hewn_error *error)
{
    smooth_measure_triangles(solve->work, solve->triangles);
    HEWN_TRY(build_matrix(solve, error));
    find_fixed(solve, fixed);
    HEWN_TRY(factor(solve, begin, error));
    cholmod_free_sparse(&solve->matrix, &solve->common);
    for (uint32_t i = begin; i < end; i++) {
        HEWN_TRY(take_step(solve, fixed, error));
        HEWN_TRY(report(solve, i + 1.0, error));
    }
    cholmod_free_factor(&solve->factor, &solve->common);
    return HEWN_OK;
}

static hewn_result run_steps(implicit_solve *solve, double *fixed, hewn_error *error)
{
    const size_t n = solve->unknowns;
    const uint32_t steps = solve->work->desc->iterations, again = solve->work->desc->remeasure;
    solve->right = cholmod_allocate_dense(n, 3, n, CHOLMOD_REAL, &solve->common);
    if (!solve->right)
        return explain(solve, error);
    for (uint32_t begin = 0, end; begin < steps; begin = end) {
        end = again > 0 && again < steps - begin ? begin + again : steps;
        HEWN_TRY(run_round(solve, begin, end, fixed, error));
    }
    return HEWN_OK;
}

hewn_result hewn_smooth_implicit(smooth_work *work, hewn_error *error)
{
    hewn_smooth_sides_free(&work->sides);
    implicit_solve solve = {.work = work, .unknown = hewn_alloc(work->count, sizeof *solve.unknown)};
    if (!solve.unknown)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    number_unknowns(&solve);
    cholmod_start(&solve.common);
    solve.common.supernodal = CHOLMOD_AUTO;
    solve.common.nmethods = 1;
    solve.common.method[0].ordering = CHOLMOD_METIS;
    solve.common.print = 0;
    solve.mass = hewn_alloc(solve.unknowns, 4 * sizeof *solve.mass);
    hewn_result result = HEWN_OK;
    solve.triangles = hewn_alloc(work->cut.face_count, sizeof *solve.triangles);
    if (!solve.mass || !solve.triangles)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    else if (solve.unknowns > 0)
        result = run_steps(&solve, solve.mass + solve.unknowns, error);
    cholmod_free_dense(&solve.right, &solve.common);
    cholmod_free_factor(&solve.factor, &solve.common);
    cholmod_free_sparse(&solve.matrix, &solve.common);
    cholmod_finish(&solve.common);
    hewn_free(solve.triangles);
    hewn_free(solve.mass);
    hewn_free(solve.unknown);
    return result;
}
