#include <float.h>

#include "geom/nearest.h"
#include "simplify/samples.h"

/* What the greatest distance counts beside the mean, both as logarithms, and what a triangle that faces away does. */
static const double most_share = 0.5, turned_cost = 0.2;

/* Points of a triangle, by what its corners count there. */
static const double points[4][3] = {
    {1.0 / 3, 1.0 / 3, 1.0 / 3}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}};

typedef struct score_sum {
    double mean, weight, most;
} score_sum;

/* From samples to the mesh. */
static score_sum sum_samples(const simplify_samples *samples)
{
    score_sum sum = {0};
    for (uint32_t s = 0; s < samples->count; s++) {
        const double weight = (double)samples->items[s].weight, gap = (double)samples->items[s].gap;
        sum.mean += weight * gap;
        sum.weight += weight;
        sum.most = fmax(sum.most, gap);
    }
    return sum;
}

/* And back. */
static score_sum sum_faces(const simplify_work *work)
{
    const simplify_samples *samples = work->samples;
    score_sum sum = {0};
    for (uint32_t f = 0; f < work->face_count; f++) {
        const uint32_t *corner = work->tail + 3 * (size_t)f;
        const double *a = simplify_at(work, corner[0]), *b = simplify_at(work, corner[1]),
                     *c = simplify_at(work, corner[2]);
        double n[3];
        simplify_area_vector(a, b, c, n);
        const double weight = sqrt(simplify_dot(n, n));
        uint32_t near = work->face_origins[f];
        for (int i = 0; i < 4; i++) {
            double at[3], gap;
            for (int axis = 0; axis < 3; axis++)
                at[axis] = points[i][0] * a[axis] + points[i][1] * b[axis] + points[i][2] * c[axis];
            near = hewn_bvh_nearest(&samples->bvh, &samples->input, at, near, &gap);
            sum.mean += weight * gap;
            sum.weight += weight;
            sum.most = fmax(sum.most, gap);
        }
    }
    return sum;
}

double hewn_simplify_score(const simplify_work *work)
{
    const score_sum to = sum_samples(work->samples), back = sum_faces(work);
    const double mean = fmax(to.weight > 0 ? to.mean / to.weight : 0, back.weight > 0 ? back.mean / back.weight : 0);
    double turned = 0;
    for (uint32_t f = 0; f < work->face_count; f++)
        turned += hewn_simplify_is_turned(work, f);
    return log(fmax(mean, DBL_MIN)) + most_share * log(fmax(fmax(to.most, back.most), DBL_MIN)) + turned_cost * turned;
}
