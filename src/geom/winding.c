#include "geom/winding.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

static const double pi = 3.14159265358979323846;

/* How many radii a part is away where it counts as a whole. */
static const double far_enough = 2.3;

/* --- parts -------------------------------------------------------------------------------------------------------- */

/* The same in double, and what centres are weighed with. */
typedef struct wide_part {
    double centre[3], radius, normal[3], moment[3][3], area;
} wide_part;

static wide_part of_triangle(const hewn_triangle_view *mesh, uint32_t triangle)
{
    wide_part out = {0};
    double p[3][3], square = 0;
    for (int k = 0; k < 3; k++)
        hewn_triangle_point(mesh, mesh->corners[3 * (uint64_t)triangle + (uint64_t)k], p[k]);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.normal[i] = 0.5 * ((p[1][j] - p[0][j]) * (p[2][k] - p[0][k]) - (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]));
        out.area += out.normal[i] * out.normal[i];
        out.centre[i] = (p[0][i] + p[1][i] + p[2][i]) / 3;
    }
    out.area = sqrt(out.area);
    for (int k = 0; k < 3; k++) {
        double d = 0;
        for (int i = 0; i < 3; i++)
            d += (p[k][i] - out.centre[i]) * (p[k][i] - out.centre[i]);
        square = d > square ? d : square;
    }
    out.radius = sqrt(square);
    return out;
}

static void join(const wide_part *parts, int count, wide_part *out)
{
    *out = (wide_part){0};
    double weight = 0;
    for (int n = 0; n < count; n++) {
        double own = parts[n].area > 0 ? parts[n].area : 1e-300; /* parts without area still have a place */
        weight += own;
        out->area += parts[n].area;
        for (int i = 0; i < 3; i++) {
            out->centre[i] += own * parts[n].centre[i];
            out->normal[i] += parts[n].normal[i];
        }
    }
    for (int i = 0; i < 3; i++)
        out->centre[i] = (double)(float)(out->centre[i] / weight);
    for (int n = 0; n < count; n++) {
        double d[3], square = 0;
        for (int i = 0; i < 3; i++) {
            d[i] = parts[n].centre[i] - out->centre[i];
            square += d[i] * d[i];
        }
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                out->moment[i][j] += parts[n].moment[i][j] + d[i] * parts[n].normal[j];
        double reach = sqrt(square) + parts[n].radius;
        out->radius = reach > out->radius ? reach : out->radius;
    }
}

static hewn_winding_part packed(const wide_part *p)
{
    hewn_winding_part out;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        out.centre[i] = (float)p->centre[i];
        out.normal[i] = (float)p->normal[i];
        out.moment[i] = (float)p->moment[i][i];
        out.moment[3 + i] = (float)(p->moment[i][j] + p->moment[j][i]);
    }
    out.radius = (float)(p->radius * (1 + 1e-6));
    return out;
}

static uint64_t child_count(const hewn_bvh *bvh, const hewn_triangle_view *mesh, uint32_t level)
{
    return level == 0 ? mesh->triangle_count : bvh->block_count[level - 1];
}

static void build_level(const hewn_winding *winding, uint32_t level, const wide_part *below, wide_part *own)
{
    const hewn_bvh *bvh = winding->bvh;
    uint64_t children = child_count(bvh, winding->mesh, level);
#pragma omp parallel for schedule(static)
    for (uint64_t block = 0; block < bvh->block_count[level]; block++) {
        wide_part parts[4];
        int count = 0;
        for (uint64_t child = 4 * block; child < 4 * block + 4 && child < children; child++)
            parts[count++] = level == 0 ? of_triangle(winding->mesh, bvh->order[child]) : below[child];
        join(parts, count, &own[block]);
        winding->level[level][block] = packed(&own[block]);
    }
}

hewn_result hewn_winding_build(const hewn_bvh *bvh, const hewn_triangle_view *mesh, hewn_winding *out,
                               hewn_error *error)
{
    *out = (hewn_winding){.bvh = bvh, .mesh = mesh};
    uint64_t blocks = 0;
    for (uint32_t level = 0; level < bvh->level_count; level++)
        blocks += bvh->block_count[level];
    wide_part *parts = hewn_alloc(blocks, sizeof *parts);
    out->level[0] = hewn_alloc(blocks, sizeof *out->level[0]);
    if (!parts || !out->level[0]) {
        hewn_free(parts);
        hewn_winding_free(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for winding numbers");
    }
    wide_part *below = NULL, *own = parts;
    for (uint32_t level = 0; level < bvh->level_count; level++) {
        if (level > 0)
            out->level[level] = out->level[level - 1] + bvh->block_count[level - 1];
        build_level(out, level, below, own);
        below = own;
        own += bvh->block_count[level];
    }
    hewn_free(parts);
    return HEWN_OK;
}

void hewn_winding_free(hewn_winding *winding)
{
    hewn_free(winding->level[0]);
    *winding = (hewn_winding){0};
}

/* --- numbers ------------------------------------------------------------------------------------------------------ */

/* The solid angle of a triangle. A point on the triangle sees half a turn of either sign, or none. */
static double solid_angle(const hewn_triangle_view *mesh, uint32_t triangle, const double at[3])
{
    double p[3][3], length[3];
    for (int k = 0; k < 3; k++) {
        hewn_triangle_point(mesh, mesh->corners[3 * (uint64_t)triangle + (uint64_t)k], p[k]);
        for (int i = 0; i < 3; i++)
            p[k][i] -= at[i];
        length[k] = sqrt(p[k][0] * p[k][0] + p[k][1] * p[k][1] + p[k][2] * p[k][2]);
    }
    const double *a = p[0], *b = p[1], *c = p[2];
    double triple =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    double ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2], bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
    double ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2];
    return 2 * atan2(triple, length[0] * length[1] * length[2] + ab * length[2] + bc * length[0] + ca * length[1]);
}

/* 4 pi times what a part adds, for a point at offset d from its centre. */
static double from_afar(const hewn_winding_part *part, const double d[3], double square)
{
    double inverse = 1 / square, cube = inverse / sqrt(square);
    const float *n = part->normal, *m = part->moment;
    double along = (double)n[0] * d[0] + (double)n[1] * d[1] + (double)n[2] * d[2];
    double trace = (double)m[0] + (double)m[1] + (double)m[2];
    double twice = (double)m[0] * d[0] * d[0] + (double)m[1] * d[1] * d[1] + (double)m[2] * d[2] * d[2] +
                   (double)m[3] * d[0] * d[1] + (double)m[4] * d[1] * d[2] + (double)m[5] * d[2] * d[0];
    return cube * (along + trace - 3 * twice * inverse);
}

static double sum_under(const hewn_winding *winding, uint32_t level, uint64_t block, const double at[3])
{
    uint64_t children = child_count(winding->bvh, winding->mesh, level);
    double sum = 0;
    for (uint64_t child = 4 * block; child < 4 * block + 4 && child < children; child++) {
        if (level == 0) {
            sum += solid_angle(winding->mesh, winding->bvh->order[child], at);
            continue;
        }
        const hewn_winding_part *part = &winding->level[level - 1][child];
        double d[3], square = 0, reach = far_enough * (double)part->radius;
        for (int i = 0; i < 3; i++) {
            d[i] = (double)part->centre[i] - at[i];
            square += d[i] * d[i];
        }
        sum += square > reach * reach ? from_afar(part, d, square) : sum_under(winding, level - 1, child, at);
    }
    return sum;
}

double hewn_winding_number(const hewn_winding *winding, const double at[3])
{
    return sum_under(winding, winding->bvh->level_count - 1, 0, at) / (4 * pi);
}

double hewn_winding_number_exactly(const hewn_triangle_view *mesh, const double at[3])
{
    double sum = 0;
    for (uint64_t t = 0; t < mesh->triangle_count; t++)
        sum += solid_angle(mesh, (uint32_t)t, at);
    return sum / (4 * pi);
}
