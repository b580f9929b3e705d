#include "denoise.h"

#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"

static int by_value(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

/* The normal of a face, as long as twice its area, which is returned. */
static double face_normal(const hewn_model *model, const double *positions, uint64_t face, double out[3])
{
    const uint32_t *corner = model->corners + 3 * face;
    const double *a = positions + 3 * (size_t)corner[0], *b = positions + 3 * (size_t)corner[1],
                 *c = positions + 3 * (size_t)corner[2];
    for (int k = 0; k < 3; k++) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        out[k] = (b[x] - a[x]) * (c[y] - a[y]) - (b[y] - a[y]) * (c[x] - a[x]);
    }
    return sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
}

static double angle_between(const hewn_model *model, const double *positions, const uint32_t faces[2])
{
    double a[3], b[3];
    double lengths = face_normal(model, positions, faces[0], a) * face_normal(model, positions, faces[1], b);
    double cosine = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / lengths;
    return acos(fmax(-1, fmin(1, cosine))) * 180 / M_PI;
}

static int by_edge(const void *a, const void *b)
{
    const sharp_edge *left = a, *right = b;
    for (int i = 0; i < 2; i++)
        if (left->vertices[i] != right->vertices[i])
            return left->vertices[i] < right->vertices[i] ? -1 : 1;
    return 0;
}

sharp_edge *sharp_edges_find(const hewn_model *model, double least, size_t *count)
{
    size_t sides = 3 * (size_t)model->face_count;
    sharp_edge *all = hewn_alloc(sides, sizeof *all);
    *count = 0;
    if (!all)
        return NULL;
    for (size_t c = 0; c < sides; c++) {
        uint32_t a = model->corners[c], b = model->corners[c % 3 == 2 ? c - 2 : c + 1];
        all[c] = (sharp_edge){{a < b ? a : b, a < b ? b : a}, {(uint32_t)(c / 3), 0}, 0};
    }
    qsort(all, sides, sizeof *all, by_edge);
    for (size_t i = 0; i + 1 < sides; i++) {
        if (by_edge(all + i, all + i + 1) != 0)
            continue;
        sharp_edge edge = all[i];
        edge.faces[1] = all[i + 1].faces[0];
        edge.angle = angle_between(model, model->positions, edge.faces);
        if (edge.angle > least)
            all[(*count)++] = edge;
    }
    return all;
}

double sharp_edges_change(const hewn_model *model, const double *positions, const sharp_edge *edges, size_t count)
{
    double *changes = hewn_alloc(count + 1, sizeof *changes), median = NAN;
    if (changes) {
        for (size_t i = 0; i < count; i++)
            changes[i] = fabs(angle_between(model, positions, edges[i].faces) - edges[i].angle);
        qsort(changes, count, sizeof *changes, by_value);
        median = count > 0 ? changes[count / 2] : 0;
    }
    hewn_free(changes);
    return median;
}

double noise_left(const hewn_model *clean, const double *positions)
{
    double sum = 0;
    for (uint64_t c = 0; c < 3 * clean->face_count; c++) {
        const double *p = clean->positions + 3 * (size_t)clean->corners[c / 3 * 3];
        const double *at = positions + 3 * (size_t)clean->corners[c];
        double n[3], length = face_normal(clean, clean->positions, c / 3, n), apart = 0;
        for (int k = 0; k < 3 && length > 0; k++)
            apart += n[k] / length * (at[k] - p[k]);
        sum += apart * apart;
    }
    return sqrt(sum / (3 * (double)clean->face_count));
}
