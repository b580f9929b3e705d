#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/renew_normals.h"
#include "simplify/channels.h"
#include "simplify/vector.h"

/* The cosine of 40 degrees: faces that bend by more are not shaded as one. */
static const double smooth_cosine = 0.766;

/* Unit normals of triangles; zero where there is no area. */
static void find_normals(const hewn_model *model, double *normals)
{
    for (uint64_t f = 0; f < model->face_count; f++) {
        const uint32_t *corner = model->corners + 3 * f;
        double *n = normals + 3 * f;
        simplify_area_vector(model->positions + 3 * (size_t)corner[0], model->positions + 3 * (size_t)corner[1],
                             model->positions + 3 * (size_t)corner[2], n);
        const double length = sqrt(simplify_dot(n, n));
        for (int axis = 0; axis < 3; axis++)
            n[axis] = length > 0 ? n[axis] / length : 0;
    }
}

static double angle_at(const hewn_model *model, uint64_t corner)
{
    const uint64_t first = corner - corner % 3;
    const double *at = model->positions + 3 * (size_t)model->corners[corner];
    double u[3], v[3], n[3];
    simplify_between(at, model->positions + 3 * (size_t)model->corners[first + (corner + 1) % 3], u);
    simplify_between(at, model->positions + 3 * (size_t)model->corners[first + (corner + 2) % 3], v);
    simplify_cross(u, v, n);
    return atan2(sqrt(simplify_dot(n, n)), simplify_dot(u, v));
}

/* The mean over the corners at a vertex whose triangles bend little from this one's, weighted by their angles. */
static void smooth_corner(const hewn_model *model, const double *normals, const uint32_t *list, uint32_t count,
                          uint32_t corner, double out[3])
{
    const double *own = normals + 3 * (size_t)(corner / 3);
    double sum[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        const double *other = normals + 3 * (size_t)(list[i] / 3);
        if (simplify_dot(own, other) < smooth_cosine)
            continue;
        const double angle = angle_at(model, list[i]);
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += angle * other[axis];
    }
    const double length = sqrt(simplify_dot(sum, sum));
    for (int axis = 0; axis < 3; axis++)
        out[axis] = length > 0 ? sum[axis] / length : own[axis];
}

static hewn_result renew_corners(const hewn_model *model, hewn_channel *channel, hewn_error *error)
{
    const uint64_t count = 3 * model->face_count;
    double *normals = hewn_alloc(model->face_count, 3 * sizeof *normals);
    uint32_t *first = hewn_alloc_zero(model->vertex_count + 1, sizeof *first), *list = hewn_alloc(count, sizeof *list);
    const bool done = normals && first && list;
    if (done) {
        find_normals(model, normals);
        for (uint64_t c = 0; c < count; c++)
            first[model->corners[c]]++;
        for (uint64_t v = 1; v <= model->vertex_count; v++)
            first[v] += first[v - 1];
        for (uint64_t c = count; c-- > 0;)
            list[--first[model->corners[c]]] = (uint32_t)c;
        for (uint64_t c = 0; c < count; c++) {
            const uint32_t v = model->corners[c];
            double n[3];
            smooth_corner(model, normals, list + first[v], first[v + 1] - first[v], (uint32_t)c, n);
            for (size_t axis = 0; axis < 3; axis++)
                if (channel->info.scalar == HEWN_SCALAR_FLOAT)
                    ((float *)channel->values)[3 * c + axis] = (float)n[axis];
                else
                    ((double *)channel->values)[3 * c + axis] = n[axis];
        }
    }
    hewn_free(normals);
    hewn_free(first);
    hewn_free(list);
    return done ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for normals");
}

hewn_result hewn_simplify_renew_normals(hewn_model *model, hewn_error *error)
{
    HEWN_TRY(hewn_model_renew_normals(model, error));
    hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_CORNER, "normal");
    if (!channel || channel->info.components != 3 ||
        (channel->info.scalar != HEWN_SCALAR_FLOAT && channel->info.scalar != HEWN_SCALAR_DOUBLE))
        return HEWN_OK;
    return renew_corners(model, channel, error);
}
