#include "labels/cut.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* How a polygon is cut. */
enum { ALONG_0_2, ALONG_1_3, FAN, WHOLE };

enum { BLOCK = 4096 /* polygons that are counted together */ };

typedef struct cutter {
    const hewn_label_nets *nets;
    const double *to_world;
    hewn_label_mesh *mesh;
    uint8_t *cuts;
    uint64_t *triangles, *centres; /* of each block, and then of all before it */
} cutter;

/* A corner seen from the low end of the grid edge: across, across, along. */
typedef struct seen {
    double u, v, height;
} seen;

static double cross(seen a, seen b)
{
    return a.u * b.v - a.v * b.u;
}

/* Whether two triangles that a quad is cut into along a and c stay in its envelope: the grid edge, which is upright at
 * the origin and 1 long, pierces its triangle between its ends, and the diagonal passes between the edge and the other
 * corner. As shaders/iso/quad.h. */
static bool stays_in(seen a, seen b, seen c, seen d)
{
    double turn = cross(a, b) + cross(b, c) + cross(c, d) + cross(d, a);
    seen along = {c.u - a.u, c.v - a.v, c.height - a.height}, back = {-a.u, -a.v, 0};
    bool beside_b = cross(along, back) * turn <= 0;
    seen near = beside_b ? b : d, far = beside_b ? d : b;
    double of_a = cross(near, c), of_near = cross(c, a), of_c = cross(a, near);
    double pierced = (of_a * a.height + of_near * near.height + of_c * c.height) / (of_a + of_near + of_c);
    seen minus = {-along.u, -along.v, 0};
    double t = cross(a, far) / cross(minus, far);
    seen over = {a.u + t * along.u, a.v + t * along.v, a.height + t * along.height};
    double s = (over.u * far.u + over.v * far.v) / (far.u * far.u + far.v * far.v);
    double lo = s * far.height, hi = lo + 1 - s;
    return pierced > 1e-5 && pierced < 1 - 1e-5 && over.height >= lo && over.height <= hi && s <= 1; /* not for NaN */
}

static double length_squared(const cutter *by, uint32_t a, uint32_t b)
{
    const double *p = by->nets->positions + 3 * (size_t)a, *q = by->nets->positions + 3 * (size_t)b;
    double sum = 0;
    for (int row = 0; row < 3; row++) {
        double part = 0;
        for (int axis = 0; axis < 3; axis++)
            part += by->to_world[4 * row + axis] * (q[axis] - p[axis]);
        sum += part * part;
    }
    return sum;
}

static uint8_t choose(const cutter *by, uint64_t polygon)
{
    const hewn_label_nets *nets = by->nets;
    const uint32_t *corners = nets->corners + nets->first[polygon];
    uint32_t count = nets->first[polygon + 1] - nets->first[polygon];
    unsigned axis = nets->axis[polygon];
    if (count != 4 || axis == 3) /* two of four corners in one cell may have the same diagonal */
        return count == 3 ? WHOLE : FAN;
    bool first_shorter = length_squared(by, corners[0], corners[2]) <= length_squared(by, corners[1], corners[3]);
    seen at[4];
    const double *own = nets->positions + 3 * (size_t)corners[0];
    for (int i = 0; i < 4; i++) {
        const double *p = nets->positions + 3 * (size_t)corners[i];
        unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
        at[i] = (seen){p[u] - floor(own[u]), p[v] - floor(own[v]), p[axis] - floor(own[axis])};
    }
    if (first_shorter && stays_in(at[0], at[1], at[2], at[3]))
        return ALONG_0_2;
    if (stays_in(at[1], at[2], at[3], at[0]))
        return ALONG_1_3;
    return !first_shorter && stays_in(at[0], at[1], at[2], at[3]) ? ALONG_0_2 : FAN;
}

static void count_block(cutter *by, uint64_t block)
{
    const hewn_label_nets *nets = by->nets;
    uint64_t begin = block * BLOCK, end = begin + BLOCK < nets->polygon_count ? begin + BLOCK : nets->polygon_count;
    uint64_t triangles = 0, centres = 0;
    for (uint64_t n = begin; n < end; n++) {
        by->cuts[n] = choose(by, n);
        triangles += by->cuts[n] == FAN ? nets->first[n + 1] - nets->first[n] : by->cuts[n] == WHOLE ? 1 : 2;
        centres += by->cuts[n] == FAN;
    }
    by->triangles[block] = triangles;
    by->centres[block] = centres;
}

/* A fan's middle: on the grid edge where its corners are on average, but off the edge's ends. */
static void place_centre(const cutter *by, uint64_t polygon, double out[3])
{
    const hewn_label_nets *nets = by->nets;
    const uint32_t *corners = nets->corners + nets->first[polygon];
    uint32_t count = nets->first[polygon + 1] - nets->first[polygon];
    unsigned axis = nets->axis[polygon];
    const double *own = nets->positions + 3 * (size_t)corners[0];
    double sum[3] = {0};
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += nets->positions[3 * (size_t)corners[i] + (size_t)k];
    for (unsigned k = 0; k < 3; k++)
        out[k] = axis == 3 ? sum[k] / count : floor(own[k]);
    if (axis == 3)
        return;
    double along = sum[axis] / count - out[axis];
    out[axis] += fmin(fmax(along, 1.0 / 16), 15.0 / 16);
}

/* The label of the higher number comes behind, so that what lies alone in the outside is oriented in itself. */
static void put(hewn_label_mesh *mesh, uint64_t *at, const uint16_t *sides, uint32_t a, uint32_t b, uint32_t c)
{
    uint64_t t = (*at)++;
    bool turned = sides[0] < sides[1];
    mesh->indices[3 * t] = a;
    mesh->indices[3 * t + 1] = turned ? c : b;
    mesh->indices[3 * t + 2] = turned ? b : c;
    mesh->sides[2 * t] = turned ? sides[1] : sides[0];
    mesh->sides[2 * t + 1] = turned ? sides[0] : sides[1];
}

static void emit_block(const cutter *by, uint64_t block)
{
    const hewn_label_nets *nets = by->nets;
    hewn_label_mesh *mesh = by->mesh;
    uint64_t begin = block * BLOCK, end = begin + BLOCK < nets->polygon_count ? begin + BLOCK : nets->polygon_count;
    uint64_t at = by->triangles[block], centre = nets->vertex_count + by->centres[block];
    for (uint64_t n = begin; n < end; n++) {
        const uint32_t *corner = nets->corners + nets->first[n];
        const uint16_t *sides = nets->sides + 2 * n;
        uint32_t count = nets->first[n + 1] - nets->first[n];
        if (by->cuts[n] == FAN) {
            place_centre(by, n, mesh->positions + 3 * centre);
            for (uint32_t i = 0; i < count; i++)
                put(mesh, &at, sides, (uint32_t)centre, corner[i], corner[i + 1 < count ? i + 1 : 0]);
            centre++;
        } else if (by->cuts[n] == ALONG_1_3) {
            put(mesh, &at, sides, corner[0], corner[1], corner[3]);
            put(mesh, &at, sides, corner[1], corner[2], corner[3]);
        } else {
            put(mesh, &at, sides, corner[0], corner[1], corner[2]);
            if (by->cuts[n] == ALONG_0_2)
                put(mesh, &at, sides, corner[0], corner[2], corner[3]);
        }
    }
}

static hewn_result cut(cutter *by, uint64_t blocks, hewn_error *error)
{
    const hewn_label_nets *nets = by->nets;
    hewn_label_mesh *mesh = by->mesh;
    uint64_t triangles = 0, centres = 0;
#pragma omp parallel for schedule(static)
    for (uint64_t block = 0; block < blocks; block++)
        count_block(by, block);
    for (uint64_t block = 0; block < blocks; block++) {
        uint64_t more = by->triangles[block], more_centres = by->centres[block];
        by->triangles[block] = triangles;
        by->centres[block] = centres;
        triangles += more;
        centres += more_centres;
    }
    mesh->vertex_count = nets->vertex_count + centres;
    mesh->triangle_count = triangles;
    if (3 * triangles >= UINT32_MAX || mesh->vertex_count >= UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the labels have more corners than indices can name");
    mesh->positions = hewn_alloc(mesh->vertex_count, 3 * sizeof *mesh->positions);
    mesh->indices = hewn_alloc(triangles, 3 * sizeof *mesh->indices);
    mesh->sides = hewn_alloc(triangles, 2 * sizeof *mesh->sides);
    if (!mesh->positions || !mesh->indices || !mesh->sides)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the mesh of labels");
    memcpy(mesh->positions, nets->positions, nets->vertex_count * 3 * sizeof *mesh->positions);
#pragma omp parallel for schedule(static)
    for (uint64_t block = 0; block < blocks; block++)
        emit_block(by, block);
    return HEWN_OK;
}

hewn_result hewn_label_nets_cut(const hewn_label_nets *nets, const double to_world[16], hewn_label_mesh *out,
                                hewn_error *error)
{
    uint64_t blocks = (nets->polygon_count + BLOCK - 1) / BLOCK;
    cutter by = {.nets = nets, .to_world = to_world, .mesh = out};
    by.cuts = hewn_alloc(nets->polygon_count, sizeof *by.cuts);
    by.triangles = hewn_alloc(blocks, sizeof *by.triangles);
    by.centres = hewn_alloc(blocks, sizeof *by.centres);
    bool all_there = by.cuts && by.triangles && by.centres;
    hewn_result result = all_there ? cut(&by, blocks, error)
                                   : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the mesh of labels");
    hewn_free(by.cuts);
    hewn_free(by.triangles);
    hewn_free(by.centres);
    return result;
}
