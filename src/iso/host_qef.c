#include "iso/host_qef.h"

/* The same as the shader's. */
static const float CUT = 0.05f, NOISE = 1.0e-5f, NEAR = 1.0e-9f;

static bool finite3(vec v)
{
    return fabsf(v[0]) <= 1.0e30f && fabsf(v[1]) <= 1.0e30f && fabsf(v[2]) <= 1.0e30f;
}

void hewn_qef_begin(hewn_qef *qef)
{
    qef->points = (vec){0};
    qef->count = 0;
    qef->taken = ~0u;
}

void hewn_qef_add_plane(hewn_qef *qef, vec point, vec normal)
{
    float size = length3(normal);
    if (!finite3(point) || !(size > 1.0e-20f && size < 1.0e20f) || qef->count == HEWN_QEF_MOST)
        return;
    vec unit = normal / size;
    unit[3] = dot3(unit, point);
    qef->planes[qef->count++] = unit;
}

void hewn_qef_add_crossing(hewn_qef *qef, vec point, vec normal)
{
    if (finite3(point))
        qef->points += (vec){point[0], point[1], point[2], 1};
    hewn_qef_add_plane(qef, point, normal);
}

vec hewn_qef_mass_point(const hewn_qef *qef, vec lo, vec hi)
{
    vec mean = qef->points[3] > 0 ? qef->points / qef->points[3] : 0.5f * (lo + hi);
    return clamp3(mean, lo, hi);
}

static vec normal_of(const hewn_qef *qef, uint32_t i)
{
    vec plane = qef->planes[i];
    plane[3] = 0;
    return plane;
}

static bool is_taken(const hewn_qef *qef, uint32_t i)
{
    return qef->taken >> i & 1;
}

/* --- directions --------------------------------------------------------------------------------------------------- */

/* A symmetric matrix and the columns of a basis. */
typedef struct spectrum {
    float diagonal[3], beside[3]; /* of the second: y z, x z, x y */
    vec basis[3];
} spectrum;

/* One Jacobi rotation: takes the entry between axes p and q to 0; r is the third one. */
static void rotate(spectrum *of, int p, int q, int r)
{
    float between = of->beside[r];
    if (!(fabsf(between) > 1.0e-30f)) {
        of->beside[r] = 0;
        return;
    }
    float ratio = 0.5f * (of->diagonal[q] - of->diagonal[p]) / between;
    float tangent = (ratio < 0 ? -1.0f : 1.0f) / (fabsf(ratio) + sqrtf(ratio * ratio + 1));
    float cosine = 1 / sqrtf(1 + tangent * tangent), sine = tangent * cosine;
    of->diagonal[p] -= tangent * between;
    of->diagonal[q] += tangent * between;
    of->beside[r] = 0;
    float rp = of->beside[q], rq = of->beside[p]; /* what r has with p and with q */
    of->beside[q] = cosine * rp - sine * rq;
    of->beside[p] = sine * rp + cosine * rq;
    vec first = of->basis[p], second = of->basis[q];
    of->basis[p] = cosine * first - sine * second;
    of->basis[q] = sine * first + cosine * second;
}

/* Directions in which the planes' normals vary independently: eigenvectors of the sum of their squares. */
static void find_directions(const hewn_qef *qef, vec out[3])
{
    spectrum of = {.basis = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (uint32_t i = 0; i < qef->count; i++) {
        if (!is_taken(qef, i))
            continue;
        vec n = qef->planes[i];
        for (int k = 0; k < 3; k++)
            of.diagonal[k] += n[k] * n[k];
        of.beside[0] += n[1] * n[2];
        of.beside[1] += n[0] * n[2];
        of.beside[2] += n[0] * n[1];
    }
    for (int sweep = 0; sweep < 5; sweep++) {
        rotate(&of, 0, 1, 2);
        rotate(&of, 0, 2, 1);
        rotate(&of, 1, 2, 0);
    }
    for (int k = 0; k < 3; k++)
        out[k] = of.basis[k];
}

/* --- in the box --------------------------------------------------------------------------------------------------- */

/* The error |root (x - best)|^2; `root` has a row for each direction, and here are its columns, which belong to the
 * axes. */
typedef struct error_form {
    vec columns[3], best;
    float noise;
} error_form;

static vec times_root(const error_form *form, vec v)
{
    return form->columns[0] * v[0] + form->columns[1] * v[1] + form->columns[2] * v[2];
}

/* The step from `from` along the open axes to the least error: fixing a coordinate takes a column out. */
static vec step_along(const error_form *form, const bool open[3], vec from)
{
    vec columns[3], rest = times_root(form, form->best - from), step = {0};
    float sizes[3];
    for (int i = 0; i < 3; i++) {
        columns[i] = open[i] ? form->columns[i] : (vec){0};
        sizes[i] = dot3(columns[i], columns[i]);
    }
    int first = sizes[0] >= sizes[1] && sizes[0] >= sizes[2] ? 0 : sizes[1] >= sizes[2] ? 1 : 2;
    int second = (first + 1) % 3, third = (first + 2) % 3;
    second = sizes[second] >= sizes[third] ? second : third;
    if (!(sizes[first] > form->noise))
        return step;
    vec a = columns[first], b = columns[second];
    float size = most(sizes[first], 1.0e-30f), share = dot3(a, b) / size;
    vec other = b - share * a;
    float apart = dot3(other, other);
    if (apart > form->noise) {
        step[second] = dot3(other, rest) / apart;
        step[first] = dot3(a, rest - step[second] * b) / size;
    } else {
        step[first] = dot3(a, rest) / (size * (1 + share * share));
        step[second] = share * step[first];
    }
    return step;
}

/* The best point of the box if the best anywhere lies outside it: the best one of each face, edge and corner, in so far
 * as it lies there, is tried. */
static vec solve_on_box(const error_form *form, float greatest, vec mass, vec lo, vec hi)
{
    const vec slack = {1.0e-6f, 1.0e-6f, 1.0e-6f, 0};
    vec found = mass;
    float lowest = 3.0e38f;
    for (uint32_t place = 1; place < 27; place++) {
        const uint32_t side[3] = {place % 3, place / 3 % 3, place / 9}; /* 0: anywhere between, 1: low, 2: high */
        bool open[3];
        vec from = {0};
        for (int i = 0; i < 3; i++) {
            open[i] = side[i] == 0;
            from[i] = open[i] ? mass[i] : side[i] == 2 ? hi[i] : lo[i];
        }
        vec at = from + step_along(form, open, from), off = times_root(form, form->best - at);
        float score = dot3(off, off) + NEAR * greatest * dot3(at - mass, at - mass);
        if (within3(at, lo - slack, hi + slack) && score < lowest) {
            lowest = score;
            found = clamp3(at, lo, hi);
        }
    }
    return found;
}

/* --- all of it ---------------------------------------------------------------------------------------------------- */

/* How much the planes say along each direction, 0 where that is too little, and where they meet along these, from the
 * mass point. Measuring the planes along the directions, instead of taking the eigenvalues, keeps the digits of small
 * singular values: their squares drown in the rounding of the great ones. The second round takes off what the first
 * left. */
static void measure(const hewn_qef *qef, const vec directions[3], vec mass, float squares[3], vec *along)
{
    *along = (vec){0};
    for (int again = 0; again < 2; again++) {
        vec sum = {0},
            from = mass + directions[0] * (*along)[0] + directions[1] * (*along)[1] + directions[2] * (*along)[2];
        vec found = {0};
        for (uint32_t i = 0; i < qef->count; i++) {
            if (!is_taken(qef, i))
                continue;
            vec normal = normal_of(qef, i);
            vec n = vec3(dot3(normal, directions[0]), dot3(normal, directions[1]), dot3(normal, directions[2]));
            float off = qef->planes[i][3] - dot3(normal, from);
            found += n * n;
            sum += n * off;
        }
        float greatest = most(most(found[0], found[1]), found[2]);
        for (int k = 0; k < 3; k++) {
            bool counts = found[k] > CUT * CUT * greatest;
            (*along)[k] += counts ? sum[k] / most(found[k], 1.0e-30f) : 0;
            squares[k] = counts ? found[k] : 0;
        }
    }
}

hewn_qef_solution hewn_qef_solve(const hewn_qef *qef, vec lo, vec hi)
{
    hewn_qef_solution result = {.rank = 0};
    vec directions[3], along, mass = hewn_qef_mass_point(qef, lo, hi);
    float squares[3];
    find_directions(qef, directions);
    measure(qef, directions, mass, squares, &along);
    for (int i = 0; i < 3; i++) {
        result.rank += squares[i] > 0;
        result.free = squares[i] > 0 ? result.free : directions[i];
    }
    result.best = mass + directions[0] * along[0] + directions[1] * along[1] + directions[2] * along[2];
    result.at = result.best;
    bool outside = false;
    for (int i = 0; i < 3; i++)
        outside = outside || result.at[i] < lo[i] || result.at[i] > hi[i];
    if (outside) {
        error_form form = {.best = result.best};
        float greatest = 0;
        for (int axis = 0; axis < 3; axis++) {
            for (int k = 0; k < 3; k++)
                form.columns[axis][k] = directions[k][axis] * sqrtf(squares[k]);
            greatest = most(greatest, dot3(form.columns[axis], form.columns[axis]));
        }
        form.noise = NOISE * NOISE * greatest;
        result.at = solve_on_box(&form, greatest, mass, lo, hi);
    }
    if (!within3(result.at, lo, hi))
        result.at = mass;
    return result;
}
