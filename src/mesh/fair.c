#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/hole.h"

/* The cotangents are those of the shape before it is solved for, so it is solved twice. */
enum { PASSES = 2, MOST_STEPS = 500 };

static const double most_cotangent = 50;

/* The squared Laplacian as a quadratic in the new vertices' positions. All vectors have 3 numbers a vertex. */
typedef struct thin_plate {
    hewn_hole *hole;
    uint32_t edge_count;
    struct plate_edge *edges; /* of the patch, without the rim */
    double *weights;          /* 1 / area, of each vertex; all vectors are in one block */
    double *fixed;            /* the Laplacian's part that does not move, at the rim */
    double *laplacian;
    double *residual, *direction, *product;
} thin_plate;

typedef struct plate_edge {
    uint32_t a, b;
    double weight;
} plate_edge;

double hewn_hole_cotangent(const double *tip, const double *a, const double *b)
{
    double u[3] = {a[0] - tip[0], a[1] - tip[1], a[2] - tip[2]}, v[3] = {b[0] - tip[0], b[1] - tip[1], b[2] - tip[2]};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2], sine = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(fabs(cosine) < 2 * most_cotangent * sine))
        return cosine < 0 ? -most_cotangent : most_cotangent;
    return cosine / sine / 2;
}

double hewn_hole_corner(const double *corner, const double *a, const double *b, double out[3])
{
    double to_a = hewn_hole_cotangent(b, corner, a), to_b = hewn_hole_cotangent(a, b, corner);
    for (int axis = 0; axis < 3; axis++)
        out[axis] += to_a * (a[axis] - corner[axis]) + to_b * (b[axis] - corner[axis]);
    double u[3] = {a[0] - corner[0], a[1] - corner[1], a[2] - corner[2]};
    double v[3] = {b[0] - corner[0], b[1] - corner[1], b[2] - corner[2]};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 6;
}

static hewn_result create_plate(hewn_hole *hole, thin_plate *out, hewn_error *error)
{
    size_t vertices = hole->vertex_count, room = 3 * (size_t)hole->face_count / 2 + 1;
    *out = (thin_plate){.hole = hole, .edges = hewn_alloc(room, sizeof *out->edges)};
    out->weights = hewn_alloc(vertices, 16 * sizeof(double));
    if (!out->edges || !out->weights)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory fairing a hole of %u edges", hole->rim_count);
    out->fixed = out->weights + vertices;
    out->laplacian = out->fixed + 3 * vertices;
    out->residual = out->laplacian + 3 * vertices;
    out->direction = out->residual + 3 * vertices;
    out->product = out->direction + 3 * vertices;
    return HEWN_OK;
}

static double opposite_cotangent(const hewn_hole *hole, uint32_t face, uint32_t edge)
{
    const uint32_t *v = hole->faces[face].vertices;
    return hewn_hole_cotangent(hole->positions + 3 * (size_t)v[(edge + 2) % 3], hole->positions + 3 * (size_t)v[edge],
                               hole->positions + 3 * (size_t)v[(edge + 1) % 3]);
}

/* An edge along the rim gives a constant; an inner edge is listed once, from its lower face. */
static void weigh_edge(thin_plate *plate, uint32_t face, uint32_t k)
{
    const hewn_hole *hole = plate->hole;
    const hewn_patch_face *f = hole->faces + face;
    uint32_t a = f->vertices[k], b = f->vertices[(k + 1) % 3], other = f->near[k];
    if (other == HEWN_NONE) {
        double weight = opposite_cotangent(hole, face, k);
        for (size_t axis = 0; axis < 3; axis++) {
            double difference = hole->positions[3 * (size_t)b + axis] - hole->positions[3 * (size_t)a + axis];
            plate->fixed[3 * (size_t)a + axis] += weight * difference;
            plate->fixed[3 * (size_t)b + axis] -= weight * difference;
        }
    } else if (other > face) {
        const uint32_t *near = hole->faces[other].near;
        uint32_t back = near[0] == face ? 0 : near[1] == face ? 1 : 2;
        double weight = opposite_cotangent(hole, face, k) + opposite_cotangent(hole, other, back);
        plate->edges[plate->edge_count++] = (plate_edge){a, b, weight};
    }
}

static void weigh(thin_plate *plate)
{
    const hewn_hole *hole = plate->hole;
    size_t rim = hole->rim_count, vertices = hole->vertex_count;
    memset(plate->weights, 0, 4 * vertices * sizeof(double));
    memcpy(plate->fixed, hole->outer, 3 * rim * sizeof(double));
    memcpy(plate->weights, hole->outer_area, rim * sizeof(double));
    plate->edge_count = 0;
    double whole = 0;
    for (uint32_t f = 0; f < hole->face_count; f++) {
        const uint32_t *v = hole->faces[f].vertices;
        double normal[3], area = hewn_hole_normal(hole, v[0], v[1], v[2], normal) / 6;
        whole += 3 * area;
        for (uint32_t k = 0; k < 3; k++) {
            plate->weights[v[k]] += area;
            weigh_edge(plate, f, k);
        }
    }
    for (size_t v = 0; v < vertices; v++)
        plate->weights[v] = 1 / fmax(plate->weights[v], 1e-6 * whole / (double)vertices);
}

/* out[v] += sum over the patch's inner edges at v of weight (x[other] - x[v]). */
static void add_laplacian(const thin_plate *plate, const double *x, double *out)
{
    for (uint32_t e = 0; e < plate->edge_count; e++) {
        const plate_edge *edge = plate->edges + e;
        size_t a = 3 * (size_t)edge->a, b = 3 * (size_t)edge->b;
        for (size_t axis = 0; axis < 3; axis++) {
            double pull = edge->weight * (x[b + axis] - x[a + axis]);
            out[a + axis] += pull;
            out[b + axis] -= pull;
        }
    }
}

/* From the Laplacian to the gradient at the new vertices; the rim's stays 0. */
static void fold_back(thin_plate *plate, double *out)
{
    size_t vertices = plate->hole->vertex_count, rim = 3 * (size_t)plate->hole->rim_count;
    for (size_t i = 0; i < 3 * vertices; i++)
        plate->laplacian[i] *= plate->weights[i / 3];
    memset(out, 0, 3 * vertices * sizeof *out);
    add_laplacian(plate, plate->laplacian, out);
    memset(out, 0, rim * sizeof *out);
}

static double square(const double *x, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += x[i] * x[i];
    return sum;
}

/* The residual at the positions as they are. */
static void begin(thin_plate *plate)
{
    size_t count = 3 * (size_t)plate->hole->vertex_count;
    memcpy(plate->laplacian, plate->fixed, count * sizeof(double));
    add_laplacian(plate, plate->hole->positions, plate->laplacian);
    fold_back(plate, plate->residual);
    for (size_t i = 0; i < count; i++)
        plate->residual[i] = -plate->residual[i];
    memcpy(plate->direction, plate->residual, count * sizeof(double));
}

static void solve(thin_plate *plate)
{
    size_t count = 3 * (size_t)plate->hole->vertex_count;
    begin(plate);
    double now = square(plate->residual, count), goal = now * 1e-16;
    for (int step = 0; step < MOST_STEPS && now > goal && isfinite(now); step++) {
        memset(plate->laplacian, 0, count * sizeof(double));
        add_laplacian(plate, plate->direction, plate->laplacian);
        fold_back(plate, plate->product);
        double curvature = 0;
        for (size_t i = 0; i < count; i++)
            curvature += plate->direction[i] * plate->product[i];
        if (!(curvature > 0))
            break;
        double stride = now / curvature;
        for (size_t i = 0; i < count; i++) {
            plate->hole->positions[i] += stride * plate->direction[i];
            plate->residual[i] -= stride * plate->product[i];
        }
        double next = square(plate->residual, count), keep = next / now;
        for (size_t i = 0; i < count; i++)
            plate->direction[i] = plate->residual[i] + keep * plate->direction[i];
        now = next;
    }
}

hewn_result hewn_hole_fair(hewn_hole *hole, hewn_error *error)
{
    if (hole->vertex_count == hole->rim_count)
        return HEWN_OK;
    thin_plate plate;
    hewn_result result = create_plate(hole, &plate, error);
    for (int pass = 0; result == HEWN_OK && pass < PASSES; pass++) {
        weigh(&plate);
        solve(&plate);
    }
    hewn_free(plate.edges);
    hewn_free(plate.weights);
    return result;
}
