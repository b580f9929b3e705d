#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/hole.h"

enum { MOST_STEPS = 1000 };

/* The squared umbrella vectors as a quadratic in the new vertices' positions. All vectors have 3 numbers a vertex. */
typedef struct thin_plate {
    hewn_hole *hole;
    uint32_t edge_count;
    uint32_t (*edges)[2]; /* of the patch, without the rim */
    double *weights;      /* 1 / number of neighbours, of each vertex */
    double *umbrella;     /* the five are in one block */
    double *residual, *direction, *product;
} thin_plate;

static bool is_inner(const hewn_patch_face *faces, uint32_t face, int k)
{
    return faces[face].near[k] != HEWN_NONE && faces[face].near[k] > face;
}

static hewn_result create_plate(hewn_hole *hole, thin_plate *out, hewn_error *error)
{
    size_t vertices = hole->vertex_count, room = 3 * (size_t)hole->face_count / 2 + 1;
    *out = (thin_plate){.hole = hole, .edges = hewn_alloc(room, sizeof *out->edges)};
    out->weights = hewn_alloc_zero(vertices, 13 * sizeof(double));
    if (!out->edges || !out->weights)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory fairing a hole of %u edges", hole->rim_count);
    out->umbrella = out->weights + vertices;
    out->residual = out->umbrella + 3 * vertices;
    out->direction = out->residual + 3 * vertices;
    out->product = out->direction + 3 * vertices;
    for (uint32_t v = 0; v < hole->rim_count; v++)
        out->weights[v] = hole->outer_count[v];
    for (uint32_t f = 0; f < hole->face_count; f++)
        for (int k = 0; k < 3; k++) {
            if (!is_inner(hole->faces, f, k))
                continue;
            uint32_t a = hole->faces[f].vertices[k], b = hole->faces[f].vertices[(k + 1) % 3];
            out->edges[out->edge_count][0] = a;
            out->edges[out->edge_count++][1] = b;
            out->weights[a]++;
            out->weights[b]++;
        }
    for (size_t v = 0; v < vertices; v++)
        out->weights[v] = 1 / out->weights[v];
    return HEWN_OK;
}

/* out[v] += sum over the patch's edges at v of (x[other] - x[v]). */
static void add_umbrellas(const thin_plate *plate, const double *x, double *out)
{
    for (uint32_t e = 0; e < plate->edge_count; e++) {
        size_t a = 3 * (size_t)plate->edges[e][0], b = 3 * (size_t)plate->edges[e][1];
        for (size_t axis = 0; axis < 3; axis++) {
            double difference = x[b + axis] - x[a + axis];
            out[a + axis] += difference;
            out[b + axis] -= difference;
        }
    }
}

/* From umbrella vectors to the gradient at the new vertices; the rim's stays 0. */
static void fold_back(thin_plate *plate, double *out)
{
    size_t vertices = plate->hole->vertex_count, fixed = 3 * (size_t)plate->hole->rim_count;
    for (size_t i = 0; i < 3 * vertices; i++)
        plate->umbrella[i] *= plate->weights[i / 3];
    memset(out, 0, 3 * vertices * sizeof *out);
    add_umbrellas(plate, plate->umbrella, out);
    memset(out, 0, fixed * sizeof *out);
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
    const hewn_hole *hole = plate->hole;
    size_t count = 3 * (size_t)hole->vertex_count;
    memset(plate->umbrella, 0, count * sizeof(double));
    for (size_t i = 0; i < 3 * (size_t)hole->rim_count; i++)
        plate->umbrella[i] = hole->outer_sums[i] - hole->outer_count[i / 3] * hole->positions[i];
    add_umbrellas(plate, hole->positions, plate->umbrella);
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
        memset(plate->umbrella, 0, count * sizeof(double));
        add_umbrellas(plate, plate->direction, plate->umbrella);
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
    if (result == HEWN_OK)
        solve(&plate);
    hewn_free(plate.edges);
    hewn_free(plate.weights);
    return result;
}
