#include "labels/relax.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

/* In cells. Vertices keep so far off the faces of their cell that no two of different cells come together; those that
 * share a cell stay near their places, which are at least 1 / 12 apart (tests/unit/test_labels.c). */
static const double margin = 1.0 / 32, nearness = 1.0 / 32;

/* Neighbours of vertex v: neighbours[first[v]] to neighbours[first[v + 1] - 1]. */
typedef struct neighbourhoods {
    uint32_t *first;
    uint32_t *neighbours;
} neighbourhoods;

static bool counts(const uint8_t *on_curve, const hewn_label_nets *nets, uint64_t link, uint32_t vertex)
{
    return nets->junction[link] || !on_curve[vertex];
}

static bool gather(const hewn_label_nets *nets, uint8_t *on_curve, neighbourhoods *out)
{
    uint32_t *fill = out->first = hewn_alloc_zero(nets->vertex_count + 2, sizeof *out->first);
    out->neighbours = hewn_alloc(nets->link_count, 2 * sizeof *out->neighbours);
    if (!out->first || !out->neighbours)
        return false;
    for (uint64_t i = 0; i < nets->link_count; i++)
        if (nets->junction[i])
            on_curve[nets->links[2 * i]] = on_curve[nets->links[2 * i + 1]] = 1;
    for (uint64_t i = 0; i < 2 * nets->link_count; i++)
        if (counts(on_curve, nets, i / 2, nets->links[i]))
            fill[nets->links[i] + 2]++;
    for (uint64_t v = 0; v < nets->vertex_count; v++)
        fill[v + 2] += fill[v + 1];
    for (uint64_t i = 0; i < 2 * nets->link_count; i++)
        if (counts(on_curve, nets, i / 2, nets->links[i]))
            out->neighbours[fill[nets->links[i] + 1]++] = nets->links[i ^ 1];
    return true;
}

/* The room of a vertex about where it was made. */
static void find_room(const hewn_label_nets *nets, const double *made, uint64_t vertex, double lo[3], double hi[3])
{
    unsigned room = nets->room[vertex];
    for (unsigned axis = 0; axis < 3; axis++) {
        double at = made[3 * vertex + axis], reach = room == HEWN_NET_FACE + axis ? 0 : nearness;
        lo[axis] = room == HEWN_NET_CELL ? floor(at) + margin : at - reach;
        hi[axis] = room == HEWN_NET_CELL ? floor(at) + 1 - margin : at + reach;
    }
}

static void relax_one(const hewn_label_nets *nets, const neighbourhoods *all, const double *made, const double *from,
                      uint64_t vertex, double *to)
{
    double sum[3] = {0}, lo[3], hi[3];
    uint32_t begin = all->first[vertex], end = all->first[vertex + 1];
    for (uint32_t i = begin; i < end; i++)
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += from[3 * (size_t)all->neighbours[i] + axis];
    find_room(nets, made, vertex, lo, hi);
    for (int axis = 0; axis < 3; axis++) {
        double at = from[3 * vertex + axis], moved = end > begin ? (at + sum[axis] / (end - begin)) / 2 : at;
        to[3 * vertex + axis] = moved < lo[axis] ? lo[axis] : moved > hi[axis] ? hi[axis] : moved;
    }
}

static hewn_result relax(hewn_label_nets *nets, const neighbourhoods *all, const double *made, double **spare,
                         uint32_t passes, const hewn_progress *progress, hewn_error *error)
{
    for (uint32_t pass = 0; pass < passes; pass++) {
        const double *from = nets->positions;
        double *to = *spare;
#pragma omp parallel for schedule(static)
        for (uint64_t v = 0; v < nets->vertex_count; v++)
            relax_one(nets, all, made, from, v, to);
        *spare = nets->positions;
        nets->positions = to;
        HEWN_TRY(hewn_progress_report(progress, "relax", (pass + 1.0) / passes, error));
    }
    return HEWN_OK;
}

hewn_result hewn_label_nets_relax(hewn_label_nets *nets, uint32_t passes, const hewn_progress *progress,
                                  hewn_error *error)
{
    if (passes == 0)
        return HEWN_OK;
    neighbourhoods all = {0};
    uint8_t *on_curve = hewn_alloc_zero(nets->vertex_count, sizeof *on_curve);
    double *made = hewn_alloc(nets->vertex_count, 3 * sizeof *made);
    double *spare = hewn_alloc(nets->vertex_count, 3 * sizeof *spare);
    hewn_result result;
    if (!on_curve || !made || !spare || !gather(nets, on_curve, &all)) {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for smoothing labels");
    } else {
        memcpy(made, nets->positions, nets->vertex_count * 3 * sizeof *made);
        result = relax(nets, &all, made, &spare, passes, progress, error);
    }
    hewn_free(on_curve);
    hewn_free(made);
    hewn_free(spare);
    hewn_free(all.first);
    hewn_free(all.neighbours);
    return result;
}
