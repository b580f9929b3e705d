#include "outcore/locks.h"

#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/channels.h"
#include "simplify/vector.h"

/* One side of an edge. */
typedef struct lock_side {
    uint32_t low, high, face;
} lock_side;

static int compare(const void *a, const void *b)
{
    const lock_side *one = a, *two = b;
    if (one->low != two->low)
        return one->low < two->low ? -1 : 1;
    if (one->high != two->high)
        return one->high < two->high ? -1 : 1;
    return one->face < two->face ? -1 : one->face > two->face;
}

static void list_sides(const hewn_model *triangles, lock_side *sides)
{
    for (uint64_t c = 0; c < 3 * triangles->face_count; c++) {
        const uint32_t a = triangles->corners[c], b = triangles->corners[c % 3 == 2 ? c - 2 : c + 1];
        sides[c] = (lock_side){a < b ? a : b, a < b ? b : a, (uint32_t)(c / 3)};
    }
    qsort(sides, 3 * triangles->face_count, sizeof *sides, compare);
}

static void find_normal(const hewn_model *triangles, uint32_t face, double out[3])
{
    const uint32_t *corners = triangles->corners + 3 * (size_t)face;
    simplify_area_vector(triangles->positions + 3 * (size_t)corners[0], triangles->positions + 3 * (size_t)corners[1],
                         triangles->positions + 3 * (size_t)corners[2], out);
}

static bool is_bent(const hewn_model *triangles, const lock_side sides[2], double cosine)
{
    double normals[2][3];
    for (int i = 0; i < 2; i++)
        find_normal(triangles, sides[i].face, normals[i]);
    return simplify_bends(normals[0], normals[1], cosine);
}

hewn_result hewn_locks_find(const hewn_model *triangles, const hewn_simplify_desc *desc, uint32_t preserve,
                            uint8_t *locked, hewn_error *error)
{
    const size_t count = 3 * (size_t)triangles->face_count;
    const double cosine = cos(desc->lock_angle * (M_PI / 180));
    int32_t *labels = NULL;
    if (!desc->lock_boundary && !desc->lock_labels && !(desc->lock_angle > 0))
        return HEWN_OK;
    if (desc->lock_labels)
        HEWN_TRY(hewn_simplify_join_labels(triangles, preserve | HEWN_PRESERVE_LABEL, &labels, error));
    lock_side *sides = hewn_alloc(count, sizeof *sides);
    if (!sides) {
        hewn_free(labels);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory looking for what stays");
    }
    list_sides(triangles, sides);
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && sides[end].low == sides[i].low && sides[end].high == sides[i].high;)
            end++;
        bool stays = end - i == 1 && desc->lock_boundary;
        if (end - i == 2)
            stays = (labels && labels[sides[i].face] != labels[sides[i + 1].face]) ||
                    (desc->lock_angle > 0 && is_bent(triangles, sides + i, cosine));
        if (stays)
            locked[sides[i].low] = locked[sides[i].high] = 1;
    }
    hewn_free(sides);
    hewn_free(labels);
    return HEWN_OK;
}
