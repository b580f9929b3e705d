/* Where the vertex of a new cluster goes, and whether the surface stays where it is. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "geom/near_triangle.h"
#include "iso/cluster.h"

/* A triangle may lean this far from the surface at its crossing (cosine), if it did not lean more before. */
#define LEAST_FACING 0.1

enum { MOST_PARTS = 10 };

/* --- the vertex ----------------------------------------------------------------------------------------------------
 */

static hewn_box box_of(const hewn_clusters *clusters, const hewn_merge *merge)
{
    hewn_box box;
    const hewn_dual_surface *surface = clusters->surface;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t side = merge->bounds >> 2 * axis & 3;
        uint32_t low = merge->box[2 * axis], high = merge->box[2 * axis + 1] + 1u + merge->slack;
        box.lo[axis] = hewn_dual_coordinate(surface, axis, low > merge->slack ? low - merge->slack : 0);
        box.hi[axis] = hewn_dual_coordinate(surface, axis, high);
        if (side == 1)
            box.hi[axis] = box.lo[axis] = surface->grid.origin[axis];
        else if (side == 2)
            box.lo[axis] = box.hi[axis] = surface->grid.far[axis];
    }
    return box;
}

double hewn_merge_place(const hewn_clusters *clusters, hewn_merge *merge)
{
    hewn_box box = box_of(clusters, merge);
    double extent = 0;
    for (int axis = 0; axis < 3; axis++)
        extent = fmax(extent, box.hi[axis] - box.lo[axis]);
    hewn_quadric_centre(&merge->quadric, merge->position);
    /* What the hold adds to the distance to the planes is at most a hundredth of the tolerance, or normals off by
     * 3e-5: less than that is no feature. */
    double share = extent > 0 ? 0.01 * clusters->tolerance / extent : 0;
    hewn_quadric_minimise(&merge->quadric, 1e-9 + share * share, &box, merge->position);
    return hewn_quadric_distance(&merge->quadric, merge->position);
}

/* --- the polygons around it ----------------------------------------------------------------------------------------
 */

double hewn_clusters_facing(const hewn_clusters *clusters, uint32_t quad, const double a[3], const double b[3],
                            const double c[3])
{
    const float *normal = &clusters->surface->gradients[3 * (size_t)quad];
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = b[axis] - a[axis];
        v[axis] = c[axis] - a[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    /* Less area than that of a triangle 1e-6 as high as long counts as none. */
    double longest = u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (!(length > 1e-6 * longest))
        return -1;
    return (n[0] * (double)normal[0] + n[1] * (double)normal[1] + n[2] * (double)normal[2]) / length;
}

/* How far from the planes of both ends the middle of an edge is, and its squared length. */
static double edge_error(const hewn_quadric *p, const hewn_quadric *q, const double *a, const double *b, double *length)
{
    double middle[3];
    *length = 0;
    for (int axis = 0; axis < 3; axis++) {
        middle[axis] = (a[axis] + b[axis]) / 2;
        *length += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    }
    return hewn_quadric_distance(p, middle) + hewn_quadric_distance(q, middle);
}

uint32_t hewn_clusters_diagonal(const hewn_clusters *clusters, uint32_t quad, const double *const at[4],
                                const hewn_quadric *const quadric[4])
{
    double facing[2], lengths[2], errors[2];
    for (uint32_t cut = 0; cut < 2; cut++) {
        const double *a = at[cut], *b = at[cut + 1], *c = at[cut + 2], *d = at[(cut + 3) % 4];
        facing[cut] =
            fmin(hewn_clusters_facing(clusters, quad, a, b, c), hewn_clusters_facing(clusters, quad, a, c, d));
        errors[cut] = edge_error(quadric[cut], quadric[cut + 2], a, c, &lengths[cut]);
    }
    if ((facing[0] < LEAST_FACING) != (facing[1] < LEAST_FACING))
        return facing[0] < facing[1];
    /* Along a sharp edge the diagonal is on its planes; where both are as near, the shorter one makes better angles. */
    if (fabs(errors[0] - errors[1]) > 0.02 * clusters->tolerance)
        return errors[1] < errors[0];
    return lengths[1] < lengths[0];
}

/* The corners of a polygon; where `merge` is given, as they are with its set as one cluster at its position. */
typedef struct outline {
    uint32_t count;
    bool given; /* a quad of the uniform surface as it was */
    const double *at[4];
    const hewn_quadric *quadric[4];
} outline;

static outline outline_of(const hewn_clusters *clusters, const hewn_merge *merge, uint32_t quad)
{
    uint32_t ring[4], count = hewn_clusters_ring(clusters, quad, ring);
    outline out = {.given = count == 4};
    bool in_set[4];
    for (uint32_t i = 0; i < count; i++)
        in_set[i] = merge && clusters->mark[ring[i]] == 1;
    for (uint32_t i = 0; i < count; i++) {
        if (in_set[i] && in_set[(i + count - 1) % count])
            continue; /* its arc of the ring is one corner */
        out.given &= !in_set[i] && clusters->next_member[ring[i]] == ring[i];
        out.at[out.count] = in_set[i] ? merge->position : clusters->position[ring[i]];
        out.quadric[out.count++] = in_set[i] ? &merge->quadric : &clusters->quadric[ring[i]];
    }
    return out;
}

/* Its triangles, 3 corners each; how many. */
static uint32_t cut(const hewn_clusters *clusters, const hewn_merge *merge, uint32_t quad, const double *corners[2][3])
{
    outline polygon = outline_of(clusters, merge, quad);
    uint32_t turn = 0;
    if (polygon.count < 3)
        return 0;
    if (polygon.count == 4 && !polygon.given)
        turn = hewn_clusters_diagonal(clusters, quad, polygon.at, polygon.quadric);
    for (uint32_t i = 0; i < polygon.count - 2; i++) {
        corners[i][0] = polygon.at[turn];
        corners[i][1] = polygon.at[turn + 1 + i];
        corners[i][2] = polygon.at[(turn + 2 + i) % polygon.count];
    }
    return polygon.count - 2;
}

static void put_triangle(const hewn_clusters *clusters, hewn_merge *merge, uint32_t quad, const double *corners[3])
{
    hewn_merge_triangle *out = &merge->triangles[merge->triangle_count++];
    out->quad = quad;
    for (int axis = 0; axis < 3; axis++) {
        double lo = corners[0][axis], hi = lo;
        for (int k = 0; k < 3; k++) {
            out->at[k][axis] = corners[k][axis];
            lo = corners[k][axis] < lo ? corners[k][axis] : lo;
            hi = corners[k][axis] > hi ? corners[k][axis] : hi;
        }
        out->lo[axis] = lo - clusters->tolerance;
        out->hi[axis] = hi + clusters->tolerance;
    }
}

/* Cuts the polygons that remain. False where one is turned against the surface more than any of the set was. */
static bool cut_remaining(const hewn_clusters *clusters, hewn_merge *merge, double least_facing)
{
    const double *corners[2][3];
    merge->triangle_count = 0;
    for (size_t i = 0; i < merge->remaining_count; i++) {
        uint32_t quad = merge->quads[i];
        uint32_t count = quad < clusters->quad_count ? cut(clusters, merge, quad, corners) : 0;
        for (uint32_t t = 0; t < count; t++) {
            if (hewn_clusters_facing(clusters, quad, corners[t][0], corners[t][1], corners[t][2]) < least_facing)
                return false;
            put_triangle(clusters, merge, quad, corners[t]);
        }
    }
    return merge->triangle_count > 0;
}

/* The least facing of the polygons as they are now. */
static double facing_now(const hewn_clusters *clusters, const hewn_merge *merge)
{
    const double *corners[2][3];
    double least = 1;
    for (size_t i = 0; i < merge->quad_count; i++) {
        uint32_t quad = merge->quads[i];
        uint32_t count = quad < clusters->quad_count ? cut(clusters, NULL, quad, corners) : 0;
        for (uint32_t t = 0; t < count; t++)
            least = fmin(least, hewn_clusters_facing(clusters, quad, corners[t][0], corners[t][1], corners[t][2]));
    }
    return least;
}

/* --- how far the surface moves -------------------------------------------------------------------------------------
 */

static void point_at(const hewn_clusters *clusters, uint32_t point, double out[3])
{
    const hewn_dual_surface *surface = clusters->surface;
    const float *from = point < clusters->quad_count
                            ? &surface->points[3 * (size_t)point]
                            : &surface->positions[3 * (size_t)clusters->order[point - clusters->quad_count]];
    for (int axis = 0; axis < 3; axis++)
        out[axis] = from[axis];
}

static bool collect_points(const hewn_clusters *clusters, hewn_merge *merge)
{
    merge->point_count = 0;
    for (size_t i = 0; i < merge->quad_count; i++) {
        if (merge->quads[i] >= clusters->quad_count)
            continue;
        for (uint32_t p = clusters->first_hosted[merge->quads[i]]; p != HEWN_CLUSTER_NONE;
             p = clusters->next_hosted[p]) {
            size_t needed = merge->point_count + 1;
            if (hewn_reserve((void **)&merge->points, &merge->point_capacity, needed, sizeof *merge->points, NULL) !=
                    HEWN_OK ||
                hewn_reserve((void **)&merge->hosts, &merge->host_capacity, needed, sizeof *merge->hosts, NULL) !=
                    HEWN_OK) {
                merge->out_of_memory = true;
                return false;
            }
            merge->points[merge->point_count++] = p;
        }
    }
    return true;
}

static bool in_box(const hewn_merge_triangle *triangle, const double at[3])
{
    return at[0] >= triangle->lo[0] && at[0] <= triangle->hi[0] && at[1] >= triangle->lo[1] &&
           at[1] <= triangle->hi[1] && at[2] >= triangle->lo[2] && at[2] <= triangle->hi[2];
}

/* Each point goes to the nearest of the new triangles, or to one that is much nearer than it need be. */
static bool rehost(const hewn_clusters *clusters, hewn_merge *merge)
{
    double most = clusters->tolerance * clusters->tolerance, near = most / 64;
    size_t guess = 0;
    for (size_t i = 0; i < merge->point_count; i++) {
        double at[3], least = INFINITY;
        size_t best = 0;
        point_at(clusters, merge->points[i], at);
        for (size_t k = 0; k < merge->triangle_count && least > near; k++) {
            size_t here = guess + k < merge->triangle_count ? guess + k : guess + k - merge->triangle_count;
            const hewn_merge_triangle *triangle = &merge->triangles[here];
            if (!in_box(triangle, at))
                continue;
            double square = hewn_triangle_distance_squared(at, triangle->at[0], triangle->at[1], triangle->at[2]);
            if (square < least) {
                least = square;
                best = here;
            }
        }
        if (!(least <= most))
            return false;
        guess = best;
        merge->hosts[i] = merge->triangles[best].quad;
    }
    return true;
}

/* How far the uniform surface itself may be off at a triangle: where a cell lost a feature, its vertex says so. What is
 * won back there lies farther off: a corner several times as far as its nearest plane. */
static double doubt(const hewn_clusters *clusters, const uint32_t corners[3])
{
    const float *residuals = clusters->surface->residuals;
    double most = 0;
    for (int k = 0; k < 3 && residuals; k++)
        most = fmax(most, 4 * (double)residuals[corners[k]]);
    return fmin(most, 0.5 * (double)clusters->surface->grid.cell);
}

/* Whether a point is within the tolerance of the uniform surface, or of that and what it may be off. */
static bool is_within(const hewn_clusters *clusters, const double at[3], bool doubted)
{
    double most = clusters->tolerance + (doubted ? 0.5 * (double)clusters->surface->grid.cell : 0);
    float lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = (float)(at[axis] - most);
        hi[axis] = (float)(at[axis] + most);
    }
    hewn_bvh_walk walk = hewn_bvh_walk_begin(&clusters->bvh, lo, hi, 0);
    const float *positions = clusters->surface->positions;
    uint64_t block;
    while (hewn_bvh_walk_next(&walk, &block)) {
        for (uint64_t slot = 4 * block; slot < 4 * block + 4; slot++) {
            const uint32_t *corner = &clusters->triangles[3 * (size_t)clusters->bvh.order[slot]];
            double p[3][3], reach = clusters->tolerance + (doubted ? doubt(clusters, corner) : 0);
            if (doubted && reach == clusters->tolerance)
                continue;
            for (int k = 0; k < 9; k++)
                p[k / 3][k % 3] = positions[3 * (size_t)corner[k / 3] + (size_t)(k % 3)];
            if (hewn_triangle_distance_squared(at, p[0], p[1], p[2]) <= reach * reach)
                return true;
        }
    }
    return false;
}

static bool is_near_uniform(const hewn_clusters *clusters, const double at[3])
{
    return is_within(clusters, at, false) || (clusters->surface->residuals && is_within(clusters, at, true));
}

/* The other way: polygons do not stray. Looked at on a lattice, from the corners and the middles of sides of a small
 * triangle to `MOST_PARTS` steps a side of a large one. */
static bool stays_near(const hewn_clusters *clusters, const hewn_merge *merge)
{
    for (size_t i = 0; i < merge->triangle_count; i++) {
        const double(*p)[3] = (const double(*)[3])merge->triangles[i].at;
        double longest = 0;
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                longest = fmax(longest, fabs(p[k][axis] - p[(k + 1) % 3][axis]));
        int parts = (int)fmin(MOST_PARTS, fmax(2, ceil(longest / (2 * (double)clusters->surface->grid.cell))));
        for (int u = 0; u <= parts; u++)
            for (int v = 0; u + v <= parts; v++) {
                double at[3];
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = p[0][axis] + ((p[1][axis] - p[0][axis]) * u + (p[2][axis] - p[0][axis]) * v) / parts;
                if (!is_near_uniform(clusters, at))
                    return false;
            }
    }
    return true;
}

/* --- together ------------------------------------------------------------------------------------------------------
 */

static hewn_merge_verdict try_position(const hewn_clusters *clusters, hewn_merge *merge, double least_facing)
{
    if (!cut_remaining(clusters, merge, least_facing))
        return HEWN_MERGE_FOLD;
    return rehost(clusters, merge) && stays_near(clusters, merge) ? HEWN_MERGE_DONE : HEWN_MERGE_FAR;
}

/* The vertex of the set that is nearest to all planes: where a feature was found that no crossing tells of, it is one
 * of them. */
static bool take_best_of_set(const hewn_clusters *clusters, hewn_merge *merge)
{
    double least = clusters->tolerance;
    uint32_t best = HEWN_CLUSTER_NONE;
    for (uint32_t i = 0; i < merge->count; i++) {
        double distance = hewn_quadric_distance(&merge->quadric, clusters->position[merge->set[i]]);
        if (distance <= least && clusters->bounds[merge->set[i]] == merge->bounds) {
            least = distance;
            best = merge->set[i];
        }
    }
    if (best == HEWN_CLUSTER_NONE)
        return false;
    memcpy(merge->position, clusters->position[best], sizeof merge->position);
    return true;
}

hewn_merge_verdict hewn_merge_fit(const hewn_clusters *clusters, hewn_merge *merge)
{
    if (!(hewn_merge_place(clusters, merge) <= clusters->tolerance))
        return HEWN_MERGE_QUADRIC;
    if (hewn_reserve((void **)&merge->triangles, &merge->triangle_capacity, 2 * merge->remaining_count,
                     sizeof *merge->triangles, NULL) != HEWN_OK) {
        merge->out_of_memory = true;
        return HEWN_MERGE_MEMORY;
    }
    if (!collect_points(clusters, merge))
        return HEWN_MERGE_MEMORY;
    double least_facing = fmin(LEAST_FACING, facing_now(clusters, merge));
    hewn_merge_verdict verdict = try_position(clusters, merge, least_facing);
    if (verdict != HEWN_MERGE_DONE && take_best_of_set(clusters, merge))
        verdict = try_position(clusters, merge, least_facing);
    return verdict;
}
