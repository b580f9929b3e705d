#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/hole.h"

/* The cost of a triangulation: its largest dihedral angle first (as 1 - cos, in steps so that rounding does not
 * outweigh area), then its area. */
typedef struct cost {
    uint32_t bend; /* HEWN_NONE: impossible */
    double area;
} cost;

/* The best triangulation of rim vertices i to j: its cost, and the triangle at the edge i, j. */
typedef struct cell {
    cost cost;
    uint32_t middle;
    double normal[3];
} cell;

static const double bend_steps = 0x1p20;

double hewn_hole_normal(const hewn_hole *hole, uint32_t a, uint32_t b, uint32_t c, double out[3])
{
    const double *o = hole->positions + 3 * (size_t)a;
    const double *p = hole->positions + 3 * (size_t)b, *q = hole->positions + 3 * (size_t)c;
    double u[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]}, v[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
    return sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
}

/* A triangle or face without a direction counts as turned right over. */
static uint32_t bend(const double a[3], const double b[3])
{
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    bool blank = (a[0] == 0 && a[1] == 0 && a[2] == 0) || (b[0] == 0 && b[1] == 0 && b[2] == 0);
    double share = blank ? 2 : fmin(2, fmax(0, 1 - cosine));
    return (uint32_t)(share * bend_steps + 0.5);
}

static uint32_t worse(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static bool cheaper(cost a, cost b)
{
    return a.bend != b.bend ? a.bend < b.bend : a.area < b.area;
}

/* The triangle i, middle, j over the best of both sides. */
static cell try_middle(const hewn_hole *hole, const cell *table, uint32_t i, uint32_t middle, uint32_t j)
{
    uint32_t n = hole->rim_count;
    const cell *left = table + (size_t)i * n + middle, *right = table + (size_t)middle * n + j;
    cell made = {{HEWN_NONE, 0}, middle, {0}};
    if (left->cost.bend == HEWN_NONE || right->cost.bend == HEWN_NONE)
        return made;
    double length = hewn_hole_normal(hole, i, middle, j, made.normal);
    for (int axis = 0; axis < 3; axis++)
        made.normal[axis] = length > 0 ? made.normal[axis] / length : 0;
    uint32_t most = worse(left->cost.bend, right->cost.bend);
    most = worse(most, worse(bend(made.normal, left->normal), bend(made.normal, right->normal)));
    if (i == 0 && j == n - 1)
        most = worse(most, bend(made.normal, hole->normals + 3 * (size_t)(n - 1)));
    made.cost = (cost){most, left->cost.area + right->cost.area + length / 2};
    return made;
}

static void fill_table(const hewn_hole *hole, cell *table)
{
    uint32_t n = hole->rim_count;
    for (uint32_t i = 0; i + 1 < n; i++) {
        cell *rim = table + (size_t)i * n + i + 1;
        *rim = (cell){{0, 0}, i, {0}};
        for (int axis = 0; axis < 3; axis++)
            rim->normal[axis] = hole->normals[3 * (size_t)i + axis];
    }
    for (uint32_t span = 2; span < n; span++)
        for (uint32_t i = 0; i + span < n; i++) {
            uint32_t j = i + span;
            cell best = {{HEWN_NONE, 0}, i, {0}};
            bool closing = i == 0 && j == n - 1;
            for (uint32_t middle = i + 1; (closing || !hole->joined[(size_t)i * n + j]) && middle < j; middle++) {
                cell made = try_middle(hole, table, i, middle, j);
                if (cheaper(made.cost, best.cost))
                    best = made;
            }
            table[(size_t)i * n + j] = best;
        }
}

/* A part of the rim still to be cut into triangles, and the face that waits for it across edge i, j. */
typedef struct pending {
    uint32_t i, j, face, edge;
} pending;

static void collect(hewn_hole *hole, const cell *table, pending *stack)
{
    uint32_t height = 0, n = hole->rim_count;
    stack[height++] = (pending){0, n - 1, HEWN_NONE, 0};
    while (height > 0) {
        pending at = stack[--height];
        uint32_t middle = table[(size_t)at.i * n + at.j].middle, face = hole->face_count++;
        hole->faces[face] = (hewn_patch_face){{at.i, middle, at.j}, {HEWN_NONE, HEWN_NONE, at.face}};
        if (at.face != HEWN_NONE)
            hole->faces[at.face].near[at.edge] = face;
        if (at.j - middle > 1)
            stack[height++] = (pending){middle, at.j, face, 1};
        if (middle - at.i > 1)
            stack[height++] = (pending){at.i, middle, face, 0};
    }
}

hewn_result hewn_hole_triangulate(hewn_hole *hole, bool *found, hewn_error *error)
{
    uint32_t n = hole->rim_count;
    *found = false;
    if (n == 3 && hole->pillow)
        return HEWN_OK;
    void *faces = hole->faces;
    hewn_result result = hewn_reserve(&faces, &hole->face_capacity, n - 2, sizeof *hole->faces, error);
    hole->faces = faces;
    HEWN_TRY(result);
    cell *table = hewn_alloc((size_t)n * n, sizeof *table);
    pending *stack = hewn_alloc(n, sizeof *stack);
    if (!table || !stack) {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory filling a hole of %u edges", n);
    } else {
        fill_table(hole, table);
        *found = table[n - 1].cost.bend != HEWN_NONE;
        hole->face_count = 0;
        if (*found)
            collect(hole, table, stack);
    }
    hewn_free(stack);
    hewn_free(table);
    return result;
}
