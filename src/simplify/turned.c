#include "simplify/turned.h"

#include "base/alloc.h"
#include "base/error.h"

static double find_most(const simplify_samples *samples)
{
    double most = samples->aim;
    for (uint32_t s = 0; s < samples->count; s++)
        most = fmax(most, (double)samples->items[s].gap);
    return most;
}

/* The edge of a triangle whose collapse does least; `most` becomes what it does. */
static hewn_result choose(simplify_work *work, uint32_t face, simplify_probe *probe, simplify_plan *out, double *most)
{
    out->half = HEWN_NONE;
    for (uint32_t k = 0; k < 3; k++) {
        simplify_plan plan = hewn_simplify_plan(work, simplify_name(work, 3 * face + k));
        if (isinf(plan.cost) || plan.far || simplify_is_tied(work, plan.gone) || !hewn_simplify_allowed(work, &plan))
            continue;
        probe->enough = 0;
        probe->plenty = INFINITY;
        HEWN_TRY(hewn_simplify_probe_collapse(work, &plan, probe));
        const double far = fmax(probe->most, probe->back);
        if (probe->turned || far > *most)
            continue;
        *out = plan;
        *most = far;
    }
    return HEWN_OK;
}

static hewn_result mend(simplify_work *work, uint32_t face, double most, simplify_probe *probe)
{
    simplify_plan plan;
    for (uint32_t k = 0; k < 3; k++)
        if (work->rank[work->tail[3 * (size_t)face + k]] == SIMPLIFY_APART)
            return HEWN_OK;
    HEWN_TRY(choose(work, face, probe, &plan, &most));
    if (plan.half == HEWN_NONE)
        return HEWN_OK;
    HEWN_TRY(hewn_simplify_probe_collapse(work, &plan, probe));
    hewn_simplify_probe_settle(work, probe);
    work->live_faces -= hewn_simplify_collapse(work, &plan);
    work->live_vertices--;
    return HEWN_OK;
}

hewn_result hewn_simplify_right(simplify_work *work, hewn_error *error)
{
    const simplify_samples *samples = work->samples;
    const double most = find_most(samples);
    uint8_t *turned = hewn_alloc(work->face_count, 1);
    simplify_probe probe = {0};
    hewn_result result = turned ? HEWN_OK : HEWN_OUT_OF_MEMORY;
#pragma omp parallel for schedule(dynamic, 64) if (work->vertex_count > SIMPLIFY_FEW / 8)
    for (uint32_t f = 0; f < (turned ? work->face_count : 0); f++)
        turned[f] = hewn_simplify_is_turned(work, f);
    for (uint32_t f = 0; f < work->face_count && result == HEWN_OK; f++)
        if (turned[f] && work->tail[3 * (size_t)f] != HEWN_NONE && hewn_simplify_is_turned(work, f))
            result = mend(work, f, most, &probe);
    hewn_free(turned);
    hewn_simplify_probe_release(&probe);
    return result == HEWN_OK ? hewn_simplify_order(work, 0, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
}
