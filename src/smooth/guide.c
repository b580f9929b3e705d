#include "smooth/guide.h"

#include <math.h>

#include "base/alloc.h"
#include "smooth/work.h"

enum { MOST_NEAR = 64 }; /* of a triangle; further ones at a vertex with very many triangles are left out */

/* --- patches ------------------------------------------------------------------------------------------------------ */

typedef struct patch_finder {
    const hewn_polygons *cut;
    const smooth_rows *fans;
} patch_finder;

static uint32_t find_near(const patch_finder *finder, uint32_t t, uint32_t *near)
{
    uint32_t count = 1;
    near[0] = t;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t v = finder->cut->corners[3 * (size_t)t + k];
        for (uint32_t i = finder->fans->first[v]; i < finder->fans->first[v + 1] && count < MOST_NEAR; i++) {
            uint32_t other = finder->fans->items[i] / 3, at = 0;
            while (at < count && near[at] != other)
                at++;
            if (at == count)
                near[count++] = other;
        }
    }
    return count;
}

static int shared_vertices(const hewn_polygons *cut, uint32_t a, uint32_t b)
{
    int shared = 0;
    for (uint32_t i = 0; i < 3; i++)
        for (uint32_t k = 0; k < 3; k++)
            shared += cut->corners[3 * (size_t)a + i] == cut->corners[3 * (size_t)b + k];
    return shared;
}

static void find_beside(const smooth_guide *guide, const hewn_polygons *cut, uint32_t t)
{
    uint32_t *beside = guide->beside + 3 * (size_t)t, count = 0;
    for (uint32_t i = guide->near.first[t]; i < guide->near.first[t + 1] && count < 3; i++)
        if (guide->near.items[i] != t && shared_vertices(cut, t, guide->near.items[i]) >= 2)
            beside[count++] = guide->near.items[i];
    while (count < 3)
        beside[count++] = t;
}

static void find_patches(smooth_guide *guide, const patch_finder *finder)
{
#pragma omp parallel for schedule(dynamic, 1024)
    for (uint32_t t = 0; t < guide->near.count; t++) {
        uint32_t near[MOST_NEAR], count = find_near(finder, t, near);
        for (uint32_t i = 0; i < count; i++)
            guide->near.items[guide->near.first[t] + i] = near[i];
        find_beside(guide, finder->cut, t);
    }
}

/* Where the rows of near triangles begin; returns their sum, with which `first` ends where it fits. */
static uint64_t count_near(const patch_finder *finder, uint32_t *first, uint32_t count)
{
    uint64_t sum = 0;
#pragma omp parallel for schedule(dynamic, 1024)
    for (uint32_t t = 0; t < count; t++) {
        uint32_t near[MOST_NEAR];
        first[t] = find_near(finder, t, near);
    }
    for (uint32_t t = 0; t < count; t++) {
        const uint32_t length = first[t];
        first[t] = (uint32_t)sum;
        sum += length;
    }
    first[count] = (uint32_t)sum;
    return sum;
}

hewn_result hewn_smooth_guide_init(smooth_guide *guide, const hewn_polygons *cut, const smooth_rows *fans,
                                   hewn_error *error)
{
    const uint32_t count = (uint32_t)cut->face_count;
    patch_finder finder = {.cut = cut, .fans = fans};
    *guide =
        (smooth_guide){.near = {.count = count, .first = hewn_alloc((size_t)count + 1, sizeof *guide->near.first)}};
    guide->beside = hewn_alloc(count, 3 * sizeof *guide->beside);
    guide->means = hewn_alloc(count, 3 * sizeof *guide->means);
    guide->roughness = hewn_alloc(count, sizeof *guide->roughness);
    uint64_t sum = guide->near.first ? count_near(&finder, guide->near.first, count) : 0;
    hewn_result result = HEWN_OK;
    if (sum > UINT32_MAX)
        result = hewn_fail(error, HEWN_LIMIT, "%u triangles have more than 2^32 neighbours", count);
    else
        guide->near.items = hewn_alloc(sum, sizeof *guide->near.items);
    if (result == HEWN_OK &&
        !(guide->near.first && guide->near.items && guide->beside && guide->means && guide->roughness))
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u triangles", count);
    if (result != HEWN_OK) {
        hewn_smooth_guide_free(guide);
        return result;
    }
    find_patches(guide, &finder);
    return HEWN_OK;
}

void hewn_smooth_guide_free(smooth_guide *guide)
{
    hewn_smooth_rows_free(&guide->near);
    hewn_free(guide->beside);
    hewn_free(guide->means);
    hewn_free(guide->roughness);
    *guide = (smooth_guide){0};
}

/* --- guides ------------------------------------------------------------------------------------------------------- */

static double squared_distance(const double *a, const double *b)
{
    double d[3];
    smooth_between(a, b, d);
    return smooth_dot(d, d);
}

static bool is_in_patch(const uint32_t *items, uint32_t count, uint32_t t)
{
    for (uint32_t i = 0; i < count; i++)
        if (items[i] == t)
            return true;
    return false;
}

/* The widest difference of two normals of the patch, times the share that its sharpest inner edge has of all of them: a
 * patch with one crease is less even than one that is noisy everywhere. */
static double find_roughness(const smooth_guide *guide, uint32_t t, const double *normals)
{
    const uint32_t *items = guide->near.items + guide->near.first[t];
    uint32_t count = guide->near.first[t + 1] - guide->near.first[t];
    double widest = 0, sharpest = 0, sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double *normal = normals + 3 * (size_t)items[i];
        for (uint32_t k = i + 1; k < count; k++) {
            const double square = squared_distance(normal, normals + 3 * (size_t)items[k]);
            widest = square > widest ? square : widest;
        }
        for (int side = 0; side < 3; side++) {
            uint32_t other = guide->beside[3 * (size_t)items[i] + (size_t)side];
            if (other <= items[i] || !is_in_patch(items, count, other))
                continue;
            const double bend = sqrt(squared_distance(normal, normals + 3 * (size_t)other));
            sharpest = bend > sharpest ? bend : sharpest;
            sum += bend;
        }
    }
    return sqrt(widest) * (1e-9 + sharpest / (1e-9 + sum));
}

static void find_mean(const smooth_guide *guide, uint32_t t, const double *normals, const double *areas)
{
    double *mean = guide->means + 3 * (size_t)t, sum[3] = {0, 0, 0};
    for (uint32_t i = guide->near.first[t]; i < guide->near.first[t + 1]; i++)
        for (uint32_t axis = 0; axis < 3; axis++)
            sum[axis] += areas[guide->near.items[i]] * normals[3 * (size_t)guide->near.items[i] + axis];
    double length = sqrt(smooth_dot(sum, sum));
    for (uint32_t axis = 0; axis < 3; axis++)
        mean[axis] = length > 0 ? sum[axis] / length : normals[3 * (size_t)t + axis];
}

void hewn_smooth_guide_find(const smooth_guide *guide, const double *normals, const double *areas, double *guides)
{
#pragma omp parallel for schedule(dynamic, 1024)
    for (uint32_t t = 0; t < guide->near.count; t++) {
        guide->roughness[t] = find_roughness(guide, t, normals);
        find_mean(guide, t, normals, areas);
    }
#pragma omp parallel for schedule(dynamic, 1024)
    for (uint32_t t = 0; t < guide->near.count; t++) { /* the patches that hold t are those of its near triangles */
        uint32_t best = t;
        for (uint32_t i = guide->near.first[t]; i < guide->near.first[t + 1]; i++) {
            uint32_t other = guide->near.items[i];
            if (guide->roughness[other] < guide->roughness[best])
                best = other;
        }
        for (uint32_t axis = 0; axis < 3; axis++)
            guides[3 * (size_t)t + axis] = guide->means[3 * (size_t)best + axis];
    }
}
