/* A group of clusters with half of its triangles. */
#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"
#include "clusters/work.h"
#include "hewn/distance.h"

/* A group that keeps more than this share of its triangles stays as it is: little is gained, and other neighbours may
 * let more go. */
static const double MOST_LEFT = 0.8;

/* The group's triangles as a model of its own. Its corners know the whole's wedges, its faces the whole's labels. */
typedef struct part {
    hewn_model model;
    uint32_t *vertices; /* of the whole, in order */
    uint32_t *faces;    /* of the whole */
} part;

static int compare_numbers(const void *a, const void *b)
{
    const uint32_t one = *(const uint32_t *)a, two = *(const uint32_t *)b;
    return (one > two) - (one < two);
}

static void list_vertices(const clusters_work *work, const uint32_t *members, size_t count, part *out)
{
    size_t all = 0, kept = 0;
    for (size_t m = 0; m < count; m++) {
        const hewn_cluster *cluster = &work->out->clusters[members[m]];
        for (uint32_t i = 0; i < cluster->vertex_count; i++)
            out->vertices[all++] = work->whole.wedge_vertices[work->out->vertices[cluster->first_vertex + i]];
    }
    qsort(out->vertices, all, sizeof *out->vertices, compare_numbers);
    for (size_t i = 0; i < all; i++)
        if (kept == 0 || out->vertices[kept - 1] != out->vertices[i])
            out->vertices[kept++] = out->vertices[i];
    out->model.vertex_count = kept;
}

static uint32_t find_local(const part *in, uint32_t vertex)
{
    const uint32_t *found = bsearch(&vertex, in->vertices, in->model.vertex_count, sizeof vertex, compare_numbers);
    return (uint32_t)(found - in->vertices);
}

static void fill(const clusters_work *work, const uint32_t *members, size_t count, part *out, int32_t *wedges,
                 int32_t *labels)
{
    size_t face = 0;
    for (size_t v = 0; v < out->model.vertex_count; v++)
        for (size_t axis = 0; axis < 3; axis++)
            out->model.positions[3 * v + axis] = work->model->positions[3 * (size_t)out->vertices[v] + axis];
    for (size_t m = 0; m < count; m++) {
        const hewn_cluster *cluster = &work->out->clusters[members[m]];
        for (uint32_t t = 0; t < cluster->triangle_count; t++, face++) {
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t wedge = clusters_wedge(work->out, cluster, t, k);
                wedges[3 * face + k] = (int32_t)wedge;
                out->model.corners[3 * face + k] = find_local(out, work->whole.wedge_vertices[wedge]);
            }
            out->faces[face] = work->out->faces[cluster->first_triangle + t];
            labels[face] = work->labels ? work->labels[out->faces[face]] : 0;
        }
    }
}

static hewn_result make_part(const clusters_work *work, const uint32_t *members, size_t count, part *out,
                             hewn_error *error)
{
    size_t vertices = 0;
    hewn_channel *wedges, *labels;
    for (size_t m = 0; m < count; m++) {
        vertices += work->out->clusters[members[m]].vertex_count;
        out->model.face_count += work->out->clusters[members[m]].triangle_count;
    }
    out->vertices = hewn_alloc(vertices, sizeof *out->vertices);
    out->faces = hewn_alloc(out->model.face_count, sizeof *out->faces);
    out->model.positions = hewn_alloc(vertices, 3 * sizeof *out->model.positions);
    out->model.corners = hewn_alloc(out->model.face_count, 3 * sizeof *out->model.corners);
    if (!out->vertices || !out->faces || !out->model.positions || !out->model.corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
    list_vertices(work, members, count, out);
    const hewn_attribute_info wedge = {"wedge", HEWN_DOMAIN_CORNER, HEWN_SCALAR_INT32, 1};
    const hewn_attribute_info label = {"label", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_model_add_channel(&out->model, &wedge, &wedges, error));
    void *wedge_values = wedges->values;
    HEWN_TRY(hewn_model_add_channel(&out->model, &label, &labels, error));
    fill(work, members, count, out, wedge_values, labels->values);
    return HEWN_OK;
}

/* --- simplified --------------------------------------------------------------------------------------------------- */

/* What is left, as wedges of the whole. */
static hewn_result collect(const part *from, const fold *folded, clusters_coarse *out, hewn_error *error)
{
    const int32_t *wedges = from->model.channels[0].values;
    for (uint32_t t = 0; t < folded->triangle_count; t++) {
        uint32_t corner[3];
        if (folded->removed[t])
            continue;
        for (size_t k = 0; k < 3; k++)
            corner[k] = (uint32_t)wedges[folded->wedge_places[folded->triangles[3 * (size_t)t + k]]];
        HEWN_TRY(hewn_clusters_soup_add(&out->soup, corner, from->faces[folded->faces[t]], error));
    }
    return HEWN_OK;
}

static hewn_result measure(const part *from, const fold *folded, double *out, hewn_error *error)
{
    const hewn_distance_desc desc = {.tolerance = 0.05};
    hewn_distance distance;
    hewn_polygons before = hewn_model_polygons(&from->model), after = before;
    uint32_t *corners = hewn_alloc(folded->live_triangles, 3 * sizeof *corners);
    if (!corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
    after.face_count = 0;
    for (uint32_t t = 0; t < folded->triangle_count; t++) {
        for (size_t k = 0; k < 3 && !folded->removed[t]; k++)
            corners[3 * after.face_count + k] = folded->wedge_vertices[folded->triangles[3 * (size_t)t + k]];
        after.face_count += !folded->removed[t];
    }
    after.corners = corners;
    hewn_result result = hewn_polygons_distance(&before, &after, &desc, &distance, error);
    *out = result == HEWN_OK ? distance.high : 0;
    hewn_free(corners);
    return result;
}

/* Errors add up, and the sphere holds those of the members, all rounded outward. */
static void find_bound(const clusters_work *work, const uint32_t *members, size_t count, double distance,
                       hewn_cluster_bound *out)
{
    double error = 0, middle[3] = {0}, radius = 0;
    for (size_t m = 0; m < count; m++) {
        const hewn_cluster_bound *self = &work->out->clusters[members[m]].self;
        error = fmax(error, (double)self->error);
        for (int axis = 0; axis < 3; axis++)
            middle[axis] += (double)self->center[axis] / (double)count;
    }
    for (int axis = 0; axis < 3; axis++)
        out->center[axis] = (float)middle[axis];
    for (size_t m = 0; m < count; m++) {
        const hewn_cluster_bound *self = &work->out->clusters[members[m]].self;
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double d = (double)self->center[axis] - (double)out->center[axis];
            square += d * d;
        }
        radius = fmax(radius, sqrt(square) + (double)self->radius);
    }
    out->error = hewn_clusters_round_up((error + distance) * (1 + 1e-9));
    out->radius = hewn_clusters_round_up(radius * (1 + 1e-6));
}

static hewn_result simplify(const clusters_work *work, const uint32_t *members, size_t count, const part *from,
                            const uint8_t *border, fold *folded, clusters_coarse *out, hewn_error *error)
{
    double distance = 0;
    HEWN_TRY(hewn_fold_begin(&from->model, NULL, folded, error));
    hewn_fold_weigh(folded);
    for (uint32_t v = 0; v < folded->vertex_count; v++)
        if (border[from->vertices[v]] && folded->states[v] == FOLD_FREE)
            folded->states[v] = FOLD_BORDER;
    HEWN_TRY(hewn_fold_run(folded, folded->triangle_count / 2, NULL, error));
    if ((double)folded->live_triangles > MOST_LEFT * (double)folded->triangle_count)
        return HEWN_OK;
    HEWN_TRY(measure(from, folded, &distance, error));
    find_bound(work, members, count, distance, &out->bound);
    return collect(from, folded, out, error);
}

hewn_result hewn_clusters_coarsen(const clusters_work *work, const uint32_t *members, size_t count,
                                  const uint8_t *border, clusters_coarse *out, hewn_error *error)
{
    part from = {0};
    fold folded = {0};
    *out = (clusters_coarse){0};
    hewn_result result = make_part(work, members, count, &from, error);
    if (result == HEWN_OK)
        result = simplify(work, members, count, &from, border, &folded, out, error);
    hewn_fold_release(&folded);
    hewn_model_destroy(&from.model);
    hewn_free(from.vertices);
    hewn_free(from.faces);
    if (result != HEWN_OK)
        hewn_clusters_soup_release(&out->soup);
    return result;
}
