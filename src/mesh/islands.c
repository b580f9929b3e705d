#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* What is known of a component, at its lowest vertex. */
typedef struct island {
    uint64_t faces;
    double lo[3], hi[3];
    bool removed;
} island;

static void grow(island *at, const double *p)
{
    for (int axis = 0; axis < 3; axis++) {
        at->lo[axis] = fmin(at->lo[axis], p[axis]);
        at->hi[axis] = fmax(at->hi[axis], p[axis]);
    }
}

static double diagonal(const island *at)
{
    return hypot(hypot(at->hi[0] - at->lo[0], at->hi[1] - at->lo[1]), at->hi[2] - at->lo[2]);
}

static const island nowhere = {0, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, false};

static void measure(const hewn_soup *soup, uint32_t *parent, island *islands, island *all)
{
    *all = nowhere;
    for (uint32_t v = 0; v < soup->vertex_count; v++)
        islands[v] = nowhere;
    for (uint32_t f = 0; f < soup->face_count; f++) {
        island *at = islands + hewn_sets_find(parent, soup->corners[soup->first[f]]);
        at->faces++;
        for (uint64_t c = soup->first[f]; c < soup->first[f + 1]; c++) {
            grow(at, soup->positions + 3 * (size_t)soup->corners[c]);
            grow(all, soup->positions + 3 * (size_t)soup->corners[c]);
        }
    }
}

static void remove_marked(hewn_soup *soup, uint32_t *parent, const island *islands, uint8_t *keep,
                          hewn_repair_report *report)
{
    for (uint32_t f = 0; f < soup->face_count; f++) {
        keep[f] = !islands[hewn_sets_find(parent, soup->corners[soup->first[f]])].removed;
        report->removed_faces += !keep[f];
    }
    hewn_soup_keep_faces(soup, keep);
}

hewn_result hewn_soup_drop_islands(hewn_soup *soup, uint64_t least_faces, double least_share, bool strict,
                                   hewn_repair_report *report, hewn_error *error)
{
    uint32_t *parent = hewn_sets_create(soup->vertex_count);
    island *islands = hewn_alloc(soup->vertex_count, sizeof *islands), all;
    uint8_t *keep = hewn_alloc(soup->face_count, 1);
    hewn_result result = HEWN_OK;
    if (!parent || !islands || !keep)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory measuring components");
    if (result == HEWN_OK) {
        hewn_soup_join_faces(soup, parent);
        measure(soup, parent, islands, &all);
    }
    for (uint32_t v = 0; result == HEWN_OK && v < soup->vertex_count; v++) {
        island *at = islands + v;
        at->removed = at->faces > 0 && (at->faces < least_faces || diagonal(at) < least_share * diagonal(&all));
        report->removed_components += at->removed;
        if (at->removed && strict)
            result = hewn_fail(error, HEWN_BAD_INPUT, "the component of vertex %u is too small, with %llu faces",
                               soup->vertex_origins[v], (unsigned long long)at->faces);
    }
    if (result == HEWN_OK)
        remove_marked(soup, parent, islands, keep, report);
    hewn_free(keep);
    hewn_free(islands);
    hewn_free(parent);
    return result;
}
