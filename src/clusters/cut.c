/* Triangles into clusters. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "clusters/work.h"

void hewn_clusters_soup_release(clusters_soup *soup)
{
    hewn_free(soup->wedges);
    hewn_free(soup->faces);
    *soup = (clusters_soup){0};
}

hewn_result hewn_clusters_soup_add(clusters_soup *soup, const uint32_t wedges[3], uint32_t face, hewn_error *error)
{
    if (soup->count == soup->room) {
        const size_t room = soup->room ? 2 * soup->room : 64;
        uint32_t *more = hewn_realloc(soup->wedges, room, 3 * sizeof *more);
        soup->wedges = more ? more : soup->wedges;
        uint32_t *faces = more ? hewn_realloc(soup->faces, room, sizeof *faces) : NULL;
        soup->faces = faces ? faces : soup->faces;
        if (!faces)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
        soup->room = room;
    }
    memcpy(soup->wedges + 3 * soup->count, wedges, 3 * sizeof *wedges);
    soup->faces[soup->count++] = face;
    return HEWN_OK;
}

float hewn_clusters_round_up(double value)
{
    const float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

/* --- neighbours --------------------------------------------------------------------------------------------------- */

/* A side of a triangle by its vertices; those of neighbours are equal. */
typedef struct side {
    uint32_t lo, hi, triangle, k;
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *one = a, *two = b;
    if (one->lo != two->lo)
        return one->lo < two->lo ? -1 : 1;
    if (one->hi != two->hi)
        return one->hi < two->hi ? -1 : 1;
    if (one->triangle != two->triangle)
        return one->triangle < two->triangle ? -1 : 1;
    return (one->k > two->k) - (one->k < two->k);
}

/* Three neighbours a triangle, HEWN_NONE where there is none; the caller's. */
static uint32_t *find_neighbours(const clusters_work *work, const clusters_soup *soup)
{
    const uint32_t *vertex = work->whole.wedge_vertices;
    side *sides = hewn_alloc(3 * soup->count, sizeof *sides);
    uint32_t *out = hewn_alloc(3 * soup->count, sizeof *out);
    for (size_t c = 0; sides && out && c < 3 * soup->count; c++) {
        const uint32_t a = vertex[soup->wedges[c]], b = vertex[soup->wedges[c % 3 == 2 ? c - 2 : c + 1]];
        sides[c] = (side){a < b ? a : b, a < b ? b : a, (uint32_t)(c / 3), (uint32_t)(c % 3)};
        out[c] = HEWN_NONE;
    }
    if (sides && out)
        qsort(sides, 3 * soup->count, sizeof *sides, compare_sides);
    for (size_t i = 1; sides && out && i < 3 * soup->count; i++)
        if (sides[i].lo == sides[i - 1].lo && sides[i].hi == sides[i - 1].hi) {
            out[3 * (size_t)sides[i].triangle + sides[i].k] = sides[i - 1].triangle;
            out[3 * (size_t)sides[i - 1].triangle + sides[i - 1].k] = sides[i].triangle;
        }
    hewn_free(sides);
    if (!sides) {
        hewn_free(out);
        return NULL;
    }
    return out;
}

/* --- growing ------------------------------------------------------------------------------------------------------ */

/* A cluster that grows. Triangles beside it wait in `fringe`. */
typedef struct growth {
    const clusters_soup *soup;
    const uint32_t *neighbours;
    uint8_t *taken; /* of triangles: 1 in a cluster, 2 in the fringe */
    uint32_t *fringe;
    size_t fringe_count;
    uint32_t vertex_count, triangle_count;
    double sum[3]; /* of its triangles' middles */
} growth;

static hewn_result make_room(clusters_work *work, hewn_error *error)
{
    hewn_clusters *out = work->out;
    if (out->count >= UINT32_MAX / 512 || out->triangle_count >= UINT32_MAX - 1024)
        return hewn_fail(error, HEWN_LIMIT, "too many triangles for clusters");
    HEWN_TRY(
        hewn_reserve((void **)&out->clusters, &work->cluster_room, out->count + 1ull, sizeof *out->clusters, error));
    HEWN_TRY(hewn_reserve((void **)&out->vertices, &work->vertex_room, out->vertex_count + 256, sizeof *out->vertices,
                          error));
    if (work->triangle_room >= out->triangle_count + 512)
        return HEWN_OK;
    const size_t room = 2 * work->triangle_room + 1024;
    uint8_t *corners = hewn_realloc(out->corners, room, 3);
    out->corners = corners ? corners : out->corners;
    uint32_t *faces = corners ? hewn_realloc(out->faces, room, sizeof *faces) : NULL;
    out->faces = faces ? faces : out->faces;
    if (!faces)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
    work->triangle_room = room;
    return HEWN_OK;
}

/* Where a wedge stands in the list of the cluster that grows; the list's end where it does not. */
static uint32_t find_vertex(const clusters_work *work, const growth *of, uint32_t wedge)
{
    const uint32_t at = work->stamps[wedge];
    const uint32_t *list = work->out->vertices + work->out->vertex_count;
    return at < of->vertex_count && list[at] == wedge ? at : of->vertex_count;
}

static uint32_t count_new(const clusters_work *work, const growth *of, uint32_t triangle)
{
    uint32_t new = 0;
    for (size_t k = 0; k < 3; k++)
        new += find_vertex(work, of, of->soup->wedges[3 * (size_t)triangle + k]) == of->vertex_count;
    return new;
}

static void find_middle(const clusters_work *work, const clusters_soup *soup, uint32_t triangle, double out[3])
{
    for (size_t axis = 0; axis < 3; axis++) {
        out[axis] = 0;
        for (size_t k = 0; k < 3; k++)
            out[axis] +=
                fold_at(&work->whole, work->whole.wedge_vertices[soup->wedges[3 * (size_t)triangle + k]])[axis] / 3;
    }
}

static void take(clusters_work *work, growth *of, uint32_t triangle)
{
    hewn_clusters *out = work->out;
    const size_t at = out->triangle_count + of->triangle_count++;
    double middle[3];
    for (size_t k = 0; k < 3; k++) {
        const uint32_t wedge = of->soup->wedges[3 * (size_t)triangle + k], place = find_vertex(work, of, wedge);
        if (place == of->vertex_count) {
            out->vertices[out->vertex_count + of->vertex_count] = wedge;
            work->stamps[wedge] = of->vertex_count++;
        }
        out->corners[3 * at + k] = (uint8_t)place;
    }
    out->faces[at] = of->soup->faces[triangle];
    of->taken[triangle] = 1;
    find_middle(work, of->soup, triangle, middle);
    for (int axis = 0; axis < 3; axis++)
        of->sum[axis] += middle[axis];
    for (size_t k = 0; k < 3; k++) {
        const uint32_t next = of->neighbours[3 * (size_t)triangle + k];
        if (next != HEWN_NONE && of->taken[next] == 0) {
            of->taken[next] = 2;
            of->fringe[of->fringe_count++] = next;
        }
    }
}

/* The place in the fringe of the triangle that brings the fewest vertices, and of those the nearest; the fringe's count
 * where none fits. */
static size_t choose(const clusters_work *work, const growth *of)
{
    size_t best = of->fringe_count;
    uint32_t least = 4;
    double nearest = INFINITY;
    for (size_t i = 0; i < of->fringe_count; i++) {
        const uint32_t new = count_new(work, of, of->fringe[i]);
        double middle[3], distance = 0;
        if (new > least || of->vertex_count + new > work->desc.vertices)
            continue;
        find_middle(work, of->soup, of->fringe[i], middle);
        for (int axis = 0; axis < 3; axis++) {
            const double d = middle[axis] - of->sum[axis] / of->triangle_count;
            distance += d * d;
        }
        if (new == least && !(distance < nearest))
            continue;
        best = i;
        least = new;
        nearest = distance;
    }
    return best;
}

/* --- clusters ----------------------------------------------------------------------------------------------------- */

/* The sphere around the middle of the box of a cluster's vertices, in the model's coordinates, rounded outward. */
static void bound_cluster(const clusters_work *work, hewn_cluster *cluster)
{
    const uint32_t *list = work->out->vertices + cluster->first_vertex;
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0;
    for (uint32_t i = 0; i < cluster->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double at = work->model->positions[3 * (size_t)work->whole.wedge_vertices[list[i]] + (size_t)axis];
            lo[axis] = fmin(lo[axis], at);
            hi[axis] = fmax(hi[axis], at);
        }
    for (int axis = 0; axis < 3; axis++)
        cluster->center[axis] = (float)(lo[axis] / 2 + hi[axis] / 2);
    for (uint32_t i = 0; i < cluster->vertex_count; i++) {
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double d = work->model->positions[3 * (size_t)work->whole.wedge_vertices[list[i]] + (size_t)axis] -
                             (double)cluster->center[axis];
            square += d * d;
        }
        most = fmax(most, square);
    }
    cluster->radius = hewn_clusters_round_up(sqrt(most) * (1 + 1e-9));
}

static void finish(clusters_work *work, const growth *of, uint32_t level, const hewn_cluster_bound *self)
{
    hewn_clusters *out = work->out;
    hewn_cluster *cluster = &out->clusters[out->count++];
    *cluster = (hewn_cluster){.first_vertex = (uint32_t)out->vertex_count,
                              .vertex_count = of->vertex_count,
                              .first_triangle = (uint32_t)out->triangle_count,
                              .triangle_count = of->triangle_count,
                              .level = level,
                              .parent = {.error = INFINITY}};
    bound_cluster(work, cluster);
    cluster->self = *self;
    if (level == 0) {
        memcpy(cluster->self.center, cluster->center, sizeof cluster->center);
        cluster->self.radius = cluster->radius;
    }
    cluster->parent.radius = cluster->self.radius;
    memcpy(cluster->parent.center, cluster->self.center, sizeof cluster->self.center);
    out->vertex_count += of->vertex_count;
    out->triangle_count += of->triangle_count;
}

/* A cluster from this triangle on; what its fringe has left over is where the next begin. */
static void grow(clusters_work *work, growth *of, uint32_t seed)
{
    of->fringe_count = 0;
    of->vertex_count = of->triangle_count = 0;
    memset(of->sum, 0, sizeof of->sum);
    take(work, of, seed);
    while (of->triangle_count < work->desc.triangles) {
        const size_t i = choose(work, of);
        if (i == of->fringe_count)
            break;
        const uint32_t triangle = of->fringe[i];
        of->fringe[i] = of->fringe[--of->fringe_count];
        take(work, of, triangle);
    }
    for (size_t i = 0; i < of->fringe_count; i++)
        of->taken[of->fringe[i]] = 0;
}

/* Where the next cluster begins: beside the last one, at the triangle with the fewest free neighbours, so that no
 * scraps are left behind. */
static uint32_t choose_seed(const growth *of)
{
    uint32_t best = HEWN_NONE, least = 4;
    for (size_t i = 0; i < of->fringe_count; i++) {
        uint32_t open = 0;
        for (size_t k = 0; k < 3; k++) {
            const uint32_t next = of->neighbours[3 * (size_t)of->fringe[i] + k];
            open += next != HEWN_NONE && !of->taken[next];
        }
        if (open < least || (open == least && of->fringe[i] < best)) {
            best = of->fringe[i];
            least = open;
        }
    }
    return best;
}

static hewn_result cut(clusters_work *work, growth *of, uint32_t level, const hewn_cluster_bound *self,
                       hewn_error *error)
{
    uint32_t next = HEWN_NONE;
    for (uint32_t scan = 0;;) {
        while (scan < of->soup->count && of->taken[scan])
            scan++;
        if (scan == of->soup->count)
            return HEWN_OK;
        HEWN_TRY(make_room(work, error));
        grow(work, of, next != HEWN_NONE && !of->taken[next] ? next : scan);
        next = choose_seed(of);
        finish(work, of, level, self);
    }
}

hewn_result hewn_clusters_cut(clusters_work *work, const clusters_soup *soup, uint32_t level,
                              const hewn_cluster_bound *self, hewn_error *error)
{
    growth of = {.soup = soup, .neighbours = find_neighbours(work, soup)};
    of.taken = hewn_alloc_zero(soup->count, sizeof *of.taken);
    of.fringe = hewn_alloc(soup->count, sizeof *of.fringe);
    hewn_result result = of.neighbours && of.taken && of.fringe
                             ? cut(work, &of, level, self, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
    hewn_free((void *)of.neighbours);
    hewn_free(of.taken);
    hewn_free(of.fringe);
    return result;
}
