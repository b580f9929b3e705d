#include <float.h>

#include "base/error.h"
#include "geom/nearest.h"
#include "simplify/samples.h"

/* What the greatest distance counts beside the mean, both as logarithms, and what a triangle that faces away does. */
static const double most_share = 0.5, turned_cost = 1;

/* Points of a triangle, by what its corners count there. */
enum { POINTS = 7 };
static const double points[POINTS][3] = {{1.0 / 3, 1.0 / 3, 1.0 / 3},
                                         {2.0 / 3, 1.0 / 6, 1.0 / 6},
                                         {1.0 / 6, 2.0 / 3, 1.0 / 6},
                                         {1.0 / 6, 1.0 / 6, 2.0 / 3},
                                         {0.5, 0.5, 0},
                                         {0, 0.5, 0.5},
                                         {0.5, 0, 0.5}};

typedef struct score_sum {
    double mean, weight, most;
} score_sum;

static void add(score_sum *sum, double weight, double gap)
{
    sum->mean += weight * gap;
    sum->weight += weight;
    sum->most = fmax(sum->most, gap);
}

/* From samples to the mesh: to all of it, for what a sample lies with need not be what is nearest. */
static hewn_result sum_samples(const simplify_work *work, score_sum *sum)
{
    const simplify_samples *samples = work->samples;
    const hewn_triangle_view mesh = {.vertex_count = work->vertex_count,
                                     .triangle_count = work->face_count,
                                     .doubles = work->positions,
                                     .corners = work->tail};
    hewn_bvh bvh;
    HEWN_TRY(hewn_bvh_build(&mesh, &bvh, NULL));
    for (uint32_t f = 0; f < work->face_count; f++)
        for (uint32_t s = samples->first[f]; s != HEWN_NONE; s = samples->items[s].next) {
            double gap;
            (void)hewn_bvh_nearest(&bvh, &mesh, samples->items[s].at, f, &gap);
            add(sum, (double)samples->items[s].weight, gap);
        }
    hewn_bvh_free(&bvh);
    return HEWN_OK;
}

/* And back. */
static void sum_faces(const simplify_work *work, score_sum *sum)
{
    const simplify_samples *samples = work->samples;
    for (uint32_t f = 0; f < work->face_count; f++) {
        const uint32_t *corner = work->tail + 3 * (size_t)f;
        const double *a = simplify_at(work, corner[0]), *b = simplify_at(work, corner[1]),
                     *c = simplify_at(work, corner[2]);
        double n[3];
        simplify_area_vector(a, b, c, n);
        const double weight = sqrt(simplify_dot(n, n));
        uint32_t near = work->face_origins[f];
        for (int i = 0; i < POINTS; i++) {
            double at[3], gap;
            for (int axis = 0; axis < 3; axis++)
                at[axis] = points[i][0] * a[axis] + points[i][1] * b[axis] + points[i][2] * c[axis];
            near = hewn_bvh_nearest(&samples->bvh, &samples->input, at, near, &gap);
            add(sum, weight, gap);
        }
    }
}

hewn_result hewn_simplify_score(const simplify_work *work, double *score)
{
    score_sum to = {0}, back = {0};
    HEWN_TRY(sum_samples(work, &to));
    sum_faces(work, &back);
    const double mean = fmax(to.weight > 0 ? to.mean / to.weight : 0, back.weight > 0 ? back.mean / back.weight : 0);
    double turned = 0;
    for (uint32_t f = 0; f < work->face_count; f++)
        turned += hewn_simplify_how_turned(work, f) / 2.0;
    *score =
        log(fmax(mean, DBL_MIN)) + most_share * log(fmax(fmax(to.most, back.most), DBL_MIN)) + turned_cost * turned;
    return HEWN_OK;
}
