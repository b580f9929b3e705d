/* Normals of moved faces: the mean of the faces around, weighted by their angles (Thuermer and Wuethrich 1998). */
#include "mesh/renew_normals.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

typedef struct renewer {
    const hewn_model *model;
    uint32_t *first;   /* of each vertex in `corners`, and one more */
    uint32_t *corners; /* at each vertex */
    uint32_t *face_of; /* of each corner */
    hewn_channel *channel;
} renewer;

static void between(const double *a, const double *b, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = b[i] - a[i];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

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
    between(at, model->positions + 3 * (size_t)after, u);
    between(at, model->positions + 3 * (size_t)before, v);
    cross(u, v, n);
    double angle = atan2(sqrt(dot(n, n)), dot(u, v));
    const double *origin = model->positions + 3 * (size_t)model->corners[begin];
    for (uint64_t c = begin + 1; c + 1 < end; c++) {
        between(origin, model->positions + 3 * (size_t)model->corners[c], u);
        between(origin, model->positions + 3 * (size_t)model->corners[c + 1], v);
        cross(u, v, n);
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += n[axis];
    }
    double length = sqrt(dot(sum, sum));
    for (int axis = 0; axis < 3; axis++)
        out[axis] = length > 0 ? sum[axis] / length * angle : 0;
}

static void store(const renewer *renew, size_t element, const double sum[3])
{
    double length = sqrt(dot(sum, sum));
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
    const uint32_t *row = renew->corners + renew->first[v];
    uint32_t count = renew->first[v + 1] - renew->first[v];
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

static hewn_result sort_corners(renewer *renew, hewn_error *error)
{
    const hewn_model *model = renew->model;
    uint64_t count = hewn_model_corner_count(model);
    renew->first = hewn_alloc_zero(model->vertex_count + 1, sizeof *renew->first);
    renew->corners = hewn_alloc(count, sizeof *renew->corners);
    renew->face_of = hewn_alloc(count, sizeof *renew->face_of);
    if (!renew->first || !renew->corners || !renew->face_of)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for normals");
    for (uint64_t c = 0; c < count; c++)
        renew->first[model->corners[c] + 1ull]++;
    for (uint64_t v = 0, sum = 0; v < model->vertex_count; v++) { /* beginnings, one place late */
        uint32_t length = renew->first[v + 1];
        renew->first[v + 1] = (uint32_t)sum;
        sum += length;
    }
    for (uint64_t f = 0; f < model->face_count; f++) {
        uint64_t begin = model->first ? model->first[f] : 3 * f, end = model->first ? model->first[f + 1] : 3 * f + 3;
        for (uint64_t c = begin; c < end; c++) {
            renew->face_of[c] = (uint32_t)f;
            renew->corners[renew->first[model->corners[c] + 1ull]++] = (uint32_t)c;
        }
    }
    return HEWN_OK;
}

hewn_result hewn_model_renew_normals(hewn_model *model, hewn_error *error)
{
    bool any = false;
    for (uint32_t i = 0; i < model->channel_count; i++)
        any = any || is_normal(&model->channels[i]);
    if (!any)
        return HEWN_OK;
    renewer renew = {.model = model};
    hewn_result result = sort_corners(&renew, error);
    for (uint32_t i = 0; result == HEWN_OK && i < model->channel_count; i++) {
        renew.channel = &model->channels[i];
        if (is_normal(renew.channel))
            result = renew_channel(&renew, error);
    }
    hewn_free(renew.first);
    hewn_free(renew.corners);
    hewn_free(renew.face_of);
    return result;
}
