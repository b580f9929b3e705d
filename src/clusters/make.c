#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/progress.h"
#include "clusters/work.h"

void hewn_clusters_destroy(hewn_clusters *clusters)
{
    if (!clusters)
        return;
    hewn_free(clusters->clusters);
    hewn_free(clusters->vertices);
    hewn_free(clusters->corners);
    hewn_free(clusters->faces);
    hewn_free(clusters->vertex_origins);
    hewn_free(clusters->corner_origins);
    *clusters = (hewn_clusters){0};
}

static hewn_result no_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for clusters");
}

/* --- what is given ------------------------------------------------------------------------------------------------ */

static hewn_result choose_desc(const hewn_clusters_desc *desc, hewn_clusters_desc *out, hewn_error *error)
{
    *out = desc ? *desc : (hewn_clusters_desc){0};
    out->vertices = out->vertices ? out->vertices : 64;
    out->triangles = out->triangles ? out->triangles : 124;
    out->group = out->group ? out->group : 8;
    if (out->vertices < 3 || out->vertices > 255 || out->triangles > 512)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "a cluster has 3 to 255 vertices and at most 512 triangles, not %u and %u", out->vertices,
                         out->triangles);
    if (out->group < 2 || out->group > 32)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "2 to 32 clusters make a group, not %u", out->group);
    return HEWN_OK;
}

static hewn_result begin(clusters_work *work, hewn_error *error)
{
    HEWN_TRY(hewn_fold_begin(work->model, work->desc.progress, &work->whole, error));
    const fold *whole = &work->whole;
    hewn_clusters *out = work->out;
    out->unique_count = whole->wedge_count;
    out->vertex_origins = hewn_alloc(whole->wedge_count, sizeof *out->vertex_origins);
    out->corner_origins = hewn_alloc(whole->wedge_count, sizeof *out->corner_origins);
    work->stamps = hewn_alloc_zero(whole->wedge_count, sizeof *work->stamps);
    work->labels = whole->labels ? hewn_alloc_zero(work->model->face_count, sizeof *work->labels) : NULL;
    if (!out->vertex_origins || !out->corner_origins || !work->stamps || (whole->labels && !work->labels))
        return no_memory(error);
    memcpy(out->vertex_origins, whole->wedge_vertices, whole->wedge_count * sizeof *out->vertex_origins);
    memcpy(out->corner_origins, whole->wedge_places, whole->wedge_count * sizeof *out->corner_origins);
    for (uint32_t t = 0; whole->labels && t < whole->triangle_count; t++)
        work->labels[whole->faces[t]] = whole->labels[t];
    return HEWN_OK;
}

/* Clusters of the input's triangles. */
static hewn_result cut_input(clusters_work *work, hewn_error *error)
{
    const hewn_cluster_bound none = {0};
    clusters_soup soup = {
        .wedges = work->whole.triangles, .faces = work->whole.faces, .count = work->whole.triangle_count};
    HEWN_TRY(hewn_clusters_cut(work, &soup, 0, &none, error));
    work->active_count = work->out->count;
    work->active = hewn_alloc(work->active_count, sizeof *work->active);
    if (!work->active)
        return no_memory(error);
    for (uint32_t i = 0; i < work->out->count; i++)
        work->active[i] = i;
    return HEWN_OK;
}

/* --- one level ---------------------------------------------------------------------------------------------------- */

typedef struct level {
    uint32_t *groups; /* of each active cluster */
    uint32_t group_count;
    uint32_t *first, *members; /* the clusters of each group */
    uint8_t *border;           /* of the model's vertices */
    clusters_coarse *coarse;   /* of each group */
} level;

static void release_level(level *of)
{
    for (uint32_t g = 0; of->coarse && g < of->group_count; g++)
        hewn_clusters_soup_release(&of->coarse[g].soup);
    hewn_free(of->groups);
    hewn_free(of->first);
    hewn_free(of->members);
    hewn_free(of->border);
    hewn_free(of->coarse);
}

/* Vertices that clusters of several groups use. */
static hewn_result mark_border(const clusters_work *work, level *of, hewn_error *error)
{
    uint32_t *owners = hewn_alloc(work->model->vertex_count, sizeof *owners);
    of->border = hewn_alloc_zero(work->model->vertex_count, sizeof *of->border);
    if (!owners || !of->border) {
        hewn_free(owners);
        return no_memory(error);
    }
    for (size_t v = 0; v < work->model->vertex_count; v++)
        owners[v] = HEWN_NONE;
    for (size_t i = 0; i < work->active_count; i++) {
        const hewn_cluster *cluster = &work->out->clusters[work->active[i]];
        for (uint32_t k = 0; k < cluster->vertex_count; k++) {
            const uint32_t v = work->whole.wedge_vertices[work->out->vertices[cluster->first_vertex + k]];
            of->border[v] |= owners[v] != HEWN_NONE && owners[v] != of->groups[i];
            owners[v] = of->groups[i];
        }
    }
    hewn_free(owners);
    return HEWN_OK;
}

static hewn_result list_members(const clusters_work *work, level *of, hewn_error *error)
{
    of->first = hewn_alloc_zero(of->group_count + 2ull, sizeof *of->first);
    of->members = hewn_alloc(work->active_count, sizeof *of->members);
    of->coarse = hewn_alloc_zero(of->group_count, sizeof *of->coarse);
    if (!of->first || !of->members || !of->coarse)
        return no_memory(error);
    for (size_t i = 0; i < work->active_count; i++)
        of->first[of->groups[i] + 2]++;
    for (uint32_t g = 0; g < of->group_count; g++)
        of->first[g + 2] += of->first[g + 1];
    for (size_t i = 0; i < work->active_count; i++)
        of->members[of->first[of->groups[i] + 1]++] = work->active[i];
    return HEWN_OK;
}

/* Groups are simplified at the same time; which thread has which makes no difference. */
static hewn_result coarsen_all(const clusters_work *work, level *of, hewn_error *error)
{
    hewn_result worst = HEWN_OK;
    uint32_t worst_at = of->group_count;
#pragma omp parallel for schedule(dynamic, 1)
    for (uint32_t g = 0; g < of->group_count; g++) {
        hewn_error own = {0};
        const hewn_result result = hewn_clusters_coarsen(
            work, of->members + of->first[g], of->first[g + 1] - of->first[g], of->border, &of->coarse[g], &own);
        if (result != HEWN_OK)
#pragma omp critical(hewn_clusters)
            if (g < worst_at) {
                worst_at = g;
                worst = result;
                if (error)
                    *error = own;
            }
    }
    return worst;
}

/* Coarse groups become clusters, the others' members stay active. `*made` tells whether there were any. */
static hewn_result take_level(clusters_work *work, const level *of, uint32_t number, bool *made, hewn_error *error)
{
    size_t count = 0, room = work->active_count;
    *made = false;
    for (uint32_t g = 0; g < of->group_count; g++) {
        const clusters_coarse *coarse = &of->coarse[g];
        const uint32_t begin = work->out->count;
        if (coarse->soup.count > 0)
            HEWN_TRY(hewn_clusters_cut(work, &coarse->soup, number, &coarse->bound, error));
        const size_t more = coarse->soup.count > 0 ? work->out->count - begin : of->first[g + 1] - of->first[g];
        /* Never more than before: a half of the triangles needs fewer clusters but where these were nearly empty. */
        HEWN_TRY(hewn_reserve((void **)&work->active, &room, count + more, sizeof *work->active, error));
        for (size_t i = 0; i < more; i++)
            work->active[count++] = coarse->soup.count > 0 ? begin + (uint32_t)i : of->members[of->first[g] + i];
        for (uint32_t i = of->first[g]; coarse->soup.count > 0 && i < of->first[g + 1]; i++)
            work->out->clusters[of->members[i]].parent = coarse->bound;
        *made |= coarse->soup.count > 0;
    }
    work->active_count = count;
    return HEWN_OK;
}

static hewn_result make_level(clusters_work *work, uint32_t number, bool *made, hewn_error *error)
{
    level of = {0};
    hewn_result result = hewn_clusters_group(work, &of.groups, &of.group_count, error);
    if (result == HEWN_OK)
        result = list_members(work, &of, error);
    if (result == HEWN_OK)
        result = mark_border(work, &of, error);
    if (result == HEWN_OK)
        result = coarsen_all(work, &of, error);
    if (result == HEWN_OK)
        result = take_level(work, &of, number, made, error);
    release_level(&of);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result make(clusters_work *work, hewn_error *error)
{
    bool made = true;
    HEWN_TRY(begin(work, error));
    HEWN_TRY(cut_input(work, error));
    work->out->level_count = work->out->count > 0 ? 1 : 0;
    for (uint32_t number = 1; made && work->active_count > 1; number++) {
        HEWN_TRY(hewn_progress_report(work->desc.progress, "simplify", 1 - 1 / (double)number, error));
        HEWN_TRY(make_level(work, number, &made, error));
        work->out->level_count += made;
    }
    return HEWN_OK;
}

hewn_result hewn_clusters_make(const hewn_model *model, const hewn_clusters_desc *desc, hewn_clusters *out,
                               hewn_error *error)
{
    clusters_work work = {.model = model, .out = out};
    *out = (hewn_clusters){0};
    HEWN_TRY(choose_desc(desc, &work.desc, error));
    HEWN_TRY(hewn_model_check(model, error));
    hewn_result result = make(&work, error);
    hewn_fold_release(&work.whole);
    hewn_free(work.active);
    hewn_free(work.stamps);
    hewn_free(work.labels);
    if (result != HEWN_OK)
        hewn_clusters_destroy(out);
    return result;
}

/* --- cuts --------------------------------------------------------------------------------------------------------- */

bool hewn_cluster_bound_holds(const hewn_cluster_bound *bound, const hewn_cluster_view *view)
{
    double square = 0;
    if (isinf(bound->error))
        return false;
    for (int axis = 0; axis < 3; axis++) {
        const double d = (double)bound->center[axis] - view->eye[axis];
        square += d * d;
    }
    const double distance = sqrt(square) - (double)bound->radius;
    return (double)bound->error * view->pixels <= view->tolerance * fmax(distance, 0);
}

bool hewn_cluster_drawn(const hewn_cluster *cluster, const hewn_cluster_view *view)
{
    return hewn_cluster_bound_holds(&cluster->self, view) && !hewn_cluster_bound_holds(&cluster->parent, view);
}
