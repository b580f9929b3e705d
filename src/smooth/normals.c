/* Normals of moved faces: the mean of the faces around, weighted by their angles (Thuermer and Wuethrich 1998). */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "smooth/work.h"

typedef struct renewer {
    const hewn_model *model;
    smooth_rows corners; /* at each vertex */
    uint32_t *face_of;   /* of each corner */
    hewn_channel *channel;
} renewer;

/* The normal at a corner times its angle; zero where there is none. */
static void corner_normal(const renewer *renew, uint32_t corner, double out[3])
{
    const hewn_model *model = renew->model;
    uint64_t face = renew->face_of[corner], begin = model->first ? model->first[face] : 3 * face,
             end = model->first ? model->first[face + 1] : 3 * face + 3;
    uint32_t before = model->corners[corner > begin ? corner - 1 : end - 1];
    uint32_t after = model->corners[corner + 1ull < end ? corner + 1ull : begin];
    const double *at = model->positions + 3 * (size_t)model->corners[corner];
    double u[3], v[3], n[3], sum[3] = {0, 0, 0};
    smooth_between(at, model->positions + 3 * (size_t)after, u);
    smooth_between(at, model->positions + 3 * (size_t)before, v);
    smooth_cross(u, v, n);
    double angle = atan2(sqrt(smooth_dot(n, n)), smooth_dot(u, v));
    const double *origin = model->positions + 3 * (size_t)model->corners[begin];
    for (uint64_t c = begin + 1; c + 1 < end; c++) {
        smooth_between(origin, model->positions + 3 * (size_t)model->corners[c], u);
        smooth_between(origin, model->positions + 3 * (size_t)model->corners[c + 1], v);
        smooth_cross(u, v, n);
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += n[axis];
    }
    double length = sqrt(smooth_dot(sum, sum));
    for (int axis = 0; axis < 3; axis++)
        out[axis] = length > 0 ? sum[axis] / length * angle : 0;
}

static void store(const renewer *renew, size_t element, const double sum[3])
{
    double length = sqrt(smooth_dot(sum, sum));
    for (size_t axis = 0; length > 0 && axis < 3; axis++) {
        if (renew->channel->info.scalar == HEWN_SCALAR_FLOAT)
            ((float *)renew->channel->values)[3 * element + axis] = (float)(sum[axis] / length);
        else
            ((double *)renew->channel->values)[3 * element + axis] = sum[axis] / length;
    }
}

static bool same_value(const renewer *renew, const unsigned char *old, uint32_t a, uint32_t b)
{
    size_t stride = 3 * hewn_scalar_size(renew->channel->info.scalar);
    return memcmp(old + a * stride, old + b * stride, stride) == 0;
}

/* Corners of a vertex take the mean over those that had the same normal; a vertex channel takes that over all. */
static void renew_vertex(const renewer *renew, const unsigned char *old, uint32_t v)
{
    const uint32_t *row = renew->corners.items + renew->corners.first[v];
    uint32_t count = renew->corners.first[v + 1] - renew->corners.first[v];
    bool whole = renew->channel->info.domain == HEWN_DOMAIN_VERT;
    for (uint32_t i = 0; i < (whole && count > 0 ? 1 : count); i++) {
        double sum[3] = {0, 0, 0}, one[3];
        for (uint32_t j = 0; j < count; j++) {
            if (!whole && !same_value(renew, old, row[i], row[j]))
                continue;
            corner_normal(renew, row[j], one);
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += one[axis];
        }
        store(renew, whole ? v : row[i], sum);
    }
}

static hewn_result renew_channel(renewer *renew, hewn_error *error)
{
    const hewn_model *model = renew->model;
    size_t bytes =
        hewn_model_domain_count(model, renew->channel->info.domain) * 3 * hewn_scalar_size(renew->channel->info.scalar);
    unsigned char *old = hewn_alloc(bytes, 1);
    if (!old)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for normals");
    memcpy(old, renew->channel->values, bytes);
#pragma omp parallel for schedule(static)
    for (uint64_t v = 0; v < model->vertex_count; v++)
        renew_vertex(renew, old, (uint32_t)v);
    hewn_free(old);
    return HEWN_OK;
}

static bool is_normal(const hewn_channel *channel)
{
    return strcmp(channel->info.name, "normal") == 0 && channel->info.components == 3 &&
           channel->info.domain != HEWN_DOMAIN_FACE &&
           (channel->info.scalar == HEWN_SCALAR_FLOAT || channel->info.scalar == HEWN_SCALAR_DOUBLE);
}

hewn_result hewn_smooth_renew_normals(hewn_model *model, hewn_error *error)
{
    bool any = false;
    for (uint32_t i = 0; i < model->channel_count; i++)
        any = any || is_normal(&model->channels[i]);
    if (!any)
        return HEWN_OK;
    renewer renew = {.model = model};
    hewn_polygons polygons = hewn_model_polygons(model);
    HEWN_TRY(hewn_smooth_corners(&polygons, &renew.corners, error));
    renew.face_of = hewn_alloc(hewn_model_corner_count(model), sizeof *renew.face_of);
    hewn_result result = HEWN_OK;
    if (!renew.face_of)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for normals");
    for (uint64_t f = 0; result == HEWN_OK && f < model->face_count; f++)
        for (uint64_t c = smooth_face_begin(&polygons, f); c < smooth_face_begin(&polygons, f + 1); c++)
            renew.face_of[c] = (uint32_t)f;
    for (uint32_t i = 0; result == HEWN_OK && i < model->channel_count; i++) {
        renew.channel = &model->channels[i];
        if (is_normal(renew.channel))
            result = renew_channel(&renew, error);
    }
    hewn_free(renew.face_of);
    hewn_smooth_rows_free(&renew.corners);
    return result;
}
