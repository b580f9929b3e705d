/* Mean curvature flow in explicit steps. */
#include "base/alloc.h"
#include "smooth/cotangent.h"

/* A vertex of area A and weights w moves by t / A of its pull. Gershgorin's circles keep the eigenvalues of the step
 * within 2 where t / A is at most 1 / sum |w|, so no vertex goes further. */
static uint64_t step(smooth_work *work, const smooth_triangle *triangles, double time)
{
    uint64_t clamped = 0;
#pragma omp parallel for schedule(static) reduction(+ : clamped)
    for (uint32_t v = 0; v < work->count; v++) {
        const double *x = work->at + 3 * (size_t)v;
        double *to = work->next + 3 * (size_t)v, free = work->flags[v] & SMOOTH_RIM ? 0 : smooth_freedom(work, v);
        double factor = 0;
        smooth_star star = {{0, 0, 0}, 0, 0};
        if (free > 0)
            star = smooth_star_of(work, triangles, v);
        if (star.weight > 0) {
            bool far = time * star.weight > star.area;
            factor = free * (far ? 1 / star.weight : time / star.area);
            clamped += far;
        }
        for (int axis = 0; axis < 3; axis++)
            to[axis] = x[axis] + factor * star.pull[axis];
    }
    return clamped;
}

hewn_result hewn_smooth_flow(smooth_work *work, hewn_error *error)
{
    const hewn_smooth_desc *desc = work->desc;
    smooth_triangle *triangles = hewn_alloc(work->cut.face_count, sizeof *triangles);
    if (!triangles)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; i < desc->iterations && result == HEWN_OK; i++) {
        result = hewn_progress_report(desc->progress, "smooth", (double)i / desc->iterations, error);
        if (result != HEWN_OK)
            break;
        smooth_measure_triangles(work, triangles);
        work->report->clamped_vertices = step(work, triangles, desc->step * desc->step / 2);
        smooth_swap(work);
    }
    hewn_free(triangles);
    return result;
}
