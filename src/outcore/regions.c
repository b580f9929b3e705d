#include "outcore/regions.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { MOST_POINTS = 1 << 16, LEAF = 3 };

/* --- samples ------------------------------------------------------------------------------------------------------ */

/* The finaliser of Steele, Lea and Flood 2014, 'Fast splittable pseudorandom number generators'. */
static uint64_t hash_of(uint64_t number)
{
    number += 0x9e3779b97f4a7c15u;
    number = (number ^ number >> 30) * 0xbf58476d1ce4e5b9u;
    number = (number ^ number >> 27) * 0x94d049bb133111ebu;
    return number ^ number >> 31;
}

/* Half of the points go, those with the greater hashes. */
static void thin(hewn_sample *sample)
{
    size_t kept = 0;
    sample->most = sample->most ? sample->most / 2 : UINT64_MAX / 2;
    for (size_t i = 0; i < sample->count; i++) {
        if (sample->hashes[i] > sample->most)
            continue;
        sample->hashes[kept] = sample->hashes[i];
        memmove(sample->points + 3 * kept, sample->points + 3 * i, 3 * sizeof *sample->points);
        kept++;
    }
    sample->count = kept;
}

bool hewn_sample_takes(const hewn_sample *sample, uint64_t number)
{
    return sample->most == 0 || hash_of(number) <= sample->most;
}

hewn_result hewn_sample_add(hewn_sample *sample, uint64_t number, const double point[3], hewn_error *error)
{
    const uint64_t hash = hash_of(number);
    if (!sample->points) {
        sample->points = hewn_alloc(MOST_POINTS, 3 * sizeof *sample->points);
        sample->hashes = hewn_alloc(MOST_POINTS, sizeof *sample->hashes);
        sample->room = MOST_POINTS;
    }
    if (!sample->points || !sample->hashes)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a sample of points");
    while (sample->count == sample->room && (sample->most == 0 || hash <= sample->most))
        thin(sample);
    if (sample->most != 0 && hash > sample->most)
        return HEWN_OK;
    sample->hashes[sample->count] = hash;
    memcpy(sample->points + 3 * sample->count++, point, 3 * sizeof *point);
    return HEWN_OK;
}

void hewn_sample_free(hewn_sample *sample)
{
    hewn_free(sample->points);
    hewn_free(sample->hashes);
    *sample = (hewn_sample){0};
}

/* --- planes ------------------------------------------------------------------------------------------------------- */

/* Points by one axis, then by the others: no order of equal ones is left to chance. */
static int compare(const void *a, const void *b, void *axis_place)
{
    const double *one = a, *two = b;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t axis = (*(const uint32_t *)axis_place + k) % 3;
        if (one[axis] != two[axis])
            return one[axis] < two[axis] ? -1 : 1;
    }
    return 0;
}

static uint32_t longest_axis(const double *points, size_t count)
{
    double longest = -1;
    uint32_t out = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        double least = points[axis], most = points[axis];
        for (size_t i = 1; i < count; i++) {
            const double at = points[3 * i + axis];
            least = at < least ? at : least;
            most = at > most ? at : most;
        }
        if (most - least > longest) {
            longest = most - least;
            out = axis;
        }
    }
    return out;
}

/* How many of the sorted points go below a plane, if about `wanted` shall: of equal coordinates all go to one side. 0
 * where there is no plane. */
static size_t find_plane(const double *points, size_t count, size_t wanted, uint32_t axis)
{
    size_t below = wanted < 1 ? 1 : wanted < count ? wanted : count - 1;
    while (below > 0 && points[3 * below + axis] <= points[3 * (below - 1) + axis])
        below--;
    if (below > 0)
        return below;
    below = 1;
    while (below < count && points[3 * below + axis] <= points[3 * (below - 1) + axis])
        below++;
    return below < count ? below : 0;
}

/* Cuts points into `count` regions; the recursion is as deep as regions are cut in two. */
static void cut(double *points, size_t point_count, uint32_t count, double shift, hewn_regions *out)
{
    hewn_region_node *node = &out->nodes[out->node_count++];
    const uint32_t first = (count + 1) / 2;
    uint32_t axis = LEAF;
    size_t below = 0;
    if (count > 1 && point_count > 1) {
        axis = longest_axis(points, point_count);
        qsort_r(points, point_count, 3 * sizeof *points, compare, &axis);
        const double wanted = (double)point_count * ((double)first + shift) / (double)count;
        below = find_plane(points, point_count, (size_t)wanted, axis);
    }
    if (below == 0) {
        *node = (hewn_region_node){.axis = LEAF, .second = out->count++};
        return;
    }
    node->axis = axis;
    node->at = points[3 * below + axis];
    cut(points, below, first, shift, out);
    node->second = out->node_count;
    cut(points + 3 * below, point_count - below, count - first, shift, out);
}

hewn_result hewn_regions_make(hewn_sample *sample, uint32_t count, double shift, hewn_regions *out, hewn_error *error)
{
    *out = (hewn_regions){.nodes = hewn_alloc(2 * (size_t)count, sizeof *out->nodes)};
    if (!out->nodes)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the parts of a mesh");
    cut(sample->points, sample->count, count, shift, out);
    return HEWN_OK;
}

void hewn_regions_free(hewn_regions *regions)
{
    hewn_free(regions->nodes);
    *regions = (hewn_regions){0};
}

uint32_t hewn_region_of(const hewn_regions *regions, const double point[3])
{
    uint32_t at = 0;
    while (regions->nodes[at].axis != LEAF)
        at = point[regions->nodes[at].axis] < regions->nodes[at].at ? at + 1 : regions->nodes[at].second;
    return regions->nodes[at].second;
}
