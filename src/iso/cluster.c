#include "iso/cluster.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/morton.h"

#define NONE HEWN_CLUSTER_NONE

double hewn_dual_coordinate(const hewn_dual_surface *surface, int axis, uint32_t sample)
{
    const struct hewn_grid *grid = &surface->grid;
    if (sample + grid->rim >= grid->cells[axis])
        return grid->far[axis];
    return grid->origin[axis] + (double)grid->cell * (sample > grid->rim ? sample - grid->rim : 0);
}

uint32_t hewn_clusters_ring(const hewn_clusters *clusters, uint32_t quad, uint32_t ring[4])
{
    const uint32_t *corner = &clusters->corners[4 * (size_t)quad];
    uint32_t last = clusters->cluster[corner[3]], count = 0;
    for (int k = 0; k < 4; k++) {
        uint32_t here = clusters->cluster[corner[k]];
        if (here != last)
            ring[count++] = here;
        last = here;
    }
    return count;
}

/* --- boundary ------------------------------------------------------------------------------------------------------
 */

typedef struct boundary {
    uint64_t *sides; /* from << 32 | to, of quads along the bounds; then those that no other quad runs along */
    size_t count, capacity;
    uint32_t *follower; /* a vertex: the one that follows it */
    uint32_t *loop;     /* a vertex: which loop it is in */
    uint32_t loop_count;
} boundary;

static uint8_t bounds_of(const hewn_dual_surface *surface, uint32_t vertex)
{
    uint8_t bits = 0;
    for (int axis = 0; axis < 3 && surface->grid.rim; axis++) {
        uint32_t at = surface->cells[3 * (size_t)vertex + axis];
        bits |= (uint8_t)((at == 0 ? 1 : 0) << 2 * axis);
        bits |= (uint8_t)((at + 1 == surface->grid.cells[axis] ? 2 : 0) << 2 * axis);
    }
    return bits;
}

static bool has_side(const boundary *rim, uint64_t side)
{
    size_t low = 0, high = rim->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (rim->sides[middle] < side)
            low = middle + 1;
        else
            high = middle;
    }
    return low < rim->count && rim->sides[low] == side;
}

static hewn_result collect_sides(const hewn_clusters *clusters, boundary *rim, hewn_error *error)
{
    for (uint32_t i = 0; i < 4 * clusters->quad_count; i++) {
        uint32_t from = clusters->corners[i], to = clusters->corners[i / 4 * 4 + (i + 1) % 4];
        if (!(clusters->bounds[from] & clusters->bounds[to]))
            continue;
        HEWN_TRY(hewn_reserve((void **)&rim->sides, &rim->capacity, rim->count + 1, sizeof *rim->sides, error));
        rim->sides[rim->count++] = (uint64_t)from << 32 | to;
    }
    return hewn_morton_sort(rim->sides, NULL, rim->count, error);
}

/* Follows the sides that have no twin around their loops. */
static hewn_result follow_loops(const hewn_clusters *clusters, boundary *rim, hewn_error *error)
{
    rim->follower = hewn_alloc(clusters->vertex_count, sizeof *rim->follower);
    rim->loop = hewn_alloc(clusters->vertex_count, sizeof *rim->loop);
    if (!rim->follower || !rim->loop)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a boundary of %zu edges", rim->count);
    memset(rim->follower, 0xFF, clusters->vertex_count * sizeof *rim->follower);
    memset(rim->loop, 0xFF, clusters->vertex_count * sizeof *rim->loop);
    size_t count = 0;
    for (size_t i = 0; i < rim->count; i++) {
        uint64_t side = rim->sides[i];
        if (has_side(rim, side << 32 | side >> 32))
            continue;
        if (rim->follower[side >> 32] != NONE)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "two boundaries meet in vertex %u",
                             clusters->order[side >> 32]);
        rim->follower[side >> 32] = (uint32_t)side;
        count++;
    }
    for (uint32_t vertex = 0; vertex < clusters->vertex_count; vertex++) {
        if (rim->follower[vertex] == NONE || rim->loop[vertex] != NONE)
            continue;
        for (uint32_t at = vertex; at != NONE && rim->loop[at] == NONE; at = rim->follower[at])
            rim->loop[at] = rim->loop_count;
        rim->loop_count++;
    }
    rim->count = count;
    return HEWN_OK;
}

/* Polygons between each edge of the boundary and the imagined vertex of its loop. */
static hewn_result imagine(hewn_clusters *clusters, boundary *rim, hewn_error *error)
{
    HEWN_TRY(collect_sides(clusters, rim, error));
    HEWN_TRY(follow_loops(clusters, rim, error));
    size_t quads = clusters->quad_count + rim->count;
    if (quads > UINT32_MAX / 4 || rim->loop_count > UINT32_MAX - 1 - clusters->vertex_count)
        return hewn_fail(error, HEWN_LIMIT, "a dual surface of %zu quads is too large to collapse", quads);
    uint32_t *corners = hewn_realloc(clusters->corners, 4 * quads, sizeof *corners);
    if (!corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a boundary of %zu edges", rim->count);
    clusters->corners = corners;
    uint32_t next = clusters->quad_count;
    for (uint32_t vertex = 0; vertex < clusters->vertex_count; vertex++) {
        if (rim->follower[vertex] == NONE)
            continue;
        uint32_t ghost = clusters->vertex_count + rim->loop[vertex];
        memcpy(&corners[4 * (size_t)next++], (uint32_t[4]){rim->follower[vertex], vertex, ghost, ghost}, 16);
    }
    clusters->imagined_count = (uint32_t)rim->count;
    clusters->ghost_count = rim->loop_count;
    return HEWN_OK;
}

static hewn_result find_boundary(hewn_clusters *clusters, hewn_error *error)
{
    boundary rim = {0};
    hewn_result result = clusters->surface->grid.rim ? imagine(clusters, &rim, error) : HEWN_OK;
    hewn_free(rim.sides);
    hewn_free(rim.follower);
    hewn_free(rim.loop);
    return result;
}

/* --- life ----------------------------------------------------------------------------------------------------------
 */

/* Along the curve, with the corners of quads named by it. */
static hewn_result put_in_order(hewn_clusters *clusters, hewn_error *error)
{
    const hewn_dual_surface *surface = clusters->surface;
    uint32_t count = clusters->vertex_count;
    for (uint32_t i = 0; i < count; i++) {
        clusters->keys[i] = hewn_morton_code(&surface->cells[3 * (size_t)i]);
        clusters->order[i] = i;
    }
    HEWN_TRY(hewn_morton_sort(clusters->keys, clusters->order, count, error));
    uint32_t *place = clusters->mark; /* not needed yet */
    for (uint32_t i = 0; i < count; i++)
        place[clusters->order[i]] = i;
    for (uint64_t i = 0; i < 4 * surface->quad_count; i++)
        clusters->corners[i] = place[surface->quads[i]];
    memset(place, 0, count * sizeof *place);
    return HEWN_OK;
}

static void describe_vertices(hewn_clusters *clusters)
{
    const hewn_dual_surface *surface = clusters->surface;
    for (uint32_t i = 0; i < clusters->vertex_count; i++) {
        size_t from = 3 * (size_t)clusters->order[i];
        clusters->bounds[i] = bounds_of(surface, clusters->order[i]);
        for (size_t axis = 0; axis < 3; axis++) {
            clusters->position[i][axis] = surface->positions[from + axis];
            clusters->normal[i][axis] = surface->normals[from + axis];
            clusters->box[i][2 * axis] = clusters->box[i][2 * axis + 1] = (uint16_t)surface->cells[from + axis];
        }
    }
}

/* Whether a vertex may be held against the polygons: where a cell's edges miss a feature it is off the surface. */
static bool is_trusted(const hewn_clusters *clusters, uint32_t vertex)
{
    const hewn_dual_surface *surface = clusters->surface;
    return !surface->residuals || (double)surface->residuals[clusters->order[vertex]] <=
                                      fmax(clusters->tolerance / 4, 1e-3 * (double)surface->grid.cell);
}

static void describe_quads(hewn_clusters *clusters)
{
    const hewn_dual_surface *surface = clusters->surface;
    for (uint32_t i = 0; i < clusters->vertex_count + clusters->ghost_count; i++) {
        clusters->cluster[i] = i;
        clusters->next_member[i] = i;
        clusters->first_use[i] = NONE;
    }
    for (uint32_t quad = clusters->quad_count + clusters->imagined_count; quad-- > 0;) {
        bool real = quad < clusters->quad_count;
        double point[3], normal[3];
        for (size_t axis = 0; axis < 3 && real; axis++) {
            point[axis] = surface->points[3 * (size_t)quad + axis];
            normal[axis] = surface->gradients[3 * (size_t)quad + axis];
        }
        if (real) {
            clusters->first_hosted[quad] = quad;
            clusters->next_hosted[quad] = NONE;
        }
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t corner = 4 * quad + k, vertex = clusters->corners[corner];
            if (!real && k == 3)
                break; /* the imagined vertex twice */
            clusters->next_use[corner] = clusters->first_use[vertex];
            clusters->first_use[vertex] = corner;
            clusters->valence[vertex]++;
            if (real)
                hewn_quadric_add_plane(&clusters->quadric[vertex], point, normal);
        }
    }
    for (uint32_t vertex = 0; vertex < clusters->vertex_count; vertex++) {
        if (clusters->first_use[vertex] == NONE || !is_trusted(clusters, vertex))
            continue;
        uint32_t quad = clusters->first_use[vertex] / 4, point = clusters->quad_count + vertex;
        clusters->next_hosted[point] = clusters->first_hosted[quad];
        clusters->first_hosted[quad] = point;
    }
}

static bool take_vertices(hewn_clusters *clusters)
{
    size_t count = clusters->vertex_count, quads = clusters->quad_count;
    clusters->keys = hewn_alloc(count, sizeof *clusters->keys);
    clusters->order = hewn_alloc(count, sizeof *clusters->order);
    clusters->mark = hewn_alloc_zero(count, sizeof *clusters->mark);
    clusters->corners = hewn_alloc(4 * quads, sizeof *clusters->corners);
    clusters->bounds = hewn_alloc(count, sizeof *clusters->bounds);
    clusters->position = hewn_alloc(count, sizeof *clusters->position);
    clusters->normal = hewn_alloc(count, sizeof *clusters->normal);
    clusters->box = hewn_alloc(count, sizeof *clusters->box);
    clusters->quadric = hewn_alloc_zero(count, sizeof *clusters->quadric);
    clusters->triangles = hewn_alloc(6 * quads, sizeof *clusters->triangles);
    return clusters->keys && clusters->order && clusters->mark && clusters->corners && clusters->bounds &&
           clusters->position && clusters->normal && clusters->box && clusters->quadric && clusters->triangles;
}

static bool take_quads(hewn_clusters *clusters)
{
    size_t vertices = (size_t)clusters->vertex_count + clusters->ghost_count;
    size_t quads = (size_t)clusters->quad_count + clusters->imagined_count;
    clusters->cluster = hewn_alloc(vertices, sizeof *clusters->cluster);
    clusters->next_member = hewn_alloc(vertices, sizeof *clusters->next_member);
    clusters->valence = hewn_alloc_zero(vertices, sizeof *clusters->valence);
    clusters->first_use = hewn_alloc(vertices, sizeof *clusters->first_use);
    clusters->next_use = hewn_alloc(4 * quads, sizeof *clusters->next_use);
    clusters->first_hosted = hewn_alloc(clusters->quad_count, sizeof *clusters->first_hosted);
    clusters->next_hosted =
        hewn_alloc((size_t)clusters->quad_count + clusters->vertex_count, sizeof *clusters->next_hosted);
    return clusters->cluster && clusters->next_member && clusters->valence && clusters->first_use &&
           clusters->next_use && clusters->first_hosted && clusters->next_hosted;
}

static hewn_result build_bvh(hewn_clusters *clusters, hewn_error *error)
{
    static const uint32_t cut[6] = {0, 1, 2, 0, 2, 3};
    const hewn_dual_surface *surface = clusters->surface;
    for (size_t i = 0; i < 6 * (size_t)clusters->quad_count; i++)
        clusters->triangles[i] = surface->quads[4 * (i / 6) + cut[i % 6]];
    hewn_triangle_view view = {.vertex_count = surface->vertex_count,
                               .triangle_count = 2 * surface->quad_count,
                               .floats = surface->positions,
                               .corners = clusters->triangles};
    return hewn_bvh_build(&view, &clusters->bvh, error);
}

static hewn_result fill(hewn_clusters *clusters, hewn_error *error)
{
    static const char *const short_of = "out of memory collapsing a surface of %u vertices";
    if (!take_vertices(clusters))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, short_of, clusters->vertex_count);
    HEWN_TRY(put_in_order(clusters, error));
    describe_vertices(clusters);
    HEWN_TRY(find_boundary(clusters, error));
    if (!take_quads(clusters))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, short_of, clusters->vertex_count);
    describe_quads(clusters);
    return build_bvh(clusters, error);
}

hewn_result hewn_clusters_create(const hewn_dual_surface *surface, double tolerance, hewn_clusters *out,
                                 hewn_error *error)
{
    *out = (hewn_clusters){.surface = surface, .tolerance = tolerance};
    if (surface->quad_count >= UINT32_MAX / 8 || surface->vertex_count >= UINT32_MAX / 8)
        return hewn_fail(error, HEWN_LIMIT, "a dual surface of %llu quads is too large to collapse",
                         (unsigned long long)surface->quad_count);
    out->vertex_count = (uint32_t)surface->vertex_count;
    out->quad_count = (uint32_t)surface->quad_count;
    hewn_result result = fill(out, error);
    if (result != HEWN_OK)
        hewn_clusters_free(out);
    return result;
}

void hewn_clusters_free(hewn_clusters *clusters)
{
    void *blocks[] = {clusters->keys,        clusters->order,    clusters->corners,      clusters->cluster,
                      clusters->next_member, clusters->mark,     clusters->valence,      clusters->first_use,
                      clusters->next_use,    clusters->position, clusters->first_hosted, clusters->next_hosted,
                      clusters->normal,      clusters->quadric,  clusters->box,          clusters->bounds,
                      clusters->triangles};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        hewn_free(blocks[i]);
    hewn_bvh_free(&clusters->bvh);
    *clusters = (hewn_clusters){0};
}
