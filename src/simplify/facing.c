#include "geom/nearest.h"
#include "simplify/probe_mark.h"

/* Whether the place nearest to a point is within a triangle that is `distance` away: else others meet there. */
static bool is_within(const simplify_samples *samples, uint32_t face, const double n[3], const double at[3],
                      double distance)
{
    double away[3];
    simplify_between(samples->positions + 3 * (size_t)samples->input.corners[3 * (size_t)face], at, away);
    const double height = simplify_dot(away, n);
    return height * height >= (1 - HEWN_AS_NEAR) * (1 - HEWN_AS_NEAR) * distance * distance * simplify_dot(n, n);
}

/* Whether any triangle that is as near faces away. */
static bool any_faces_away(const simplify_samples *samples, const double at[3], const double normal[3], double distance)
{
    const double reach = (1 + HEWN_AS_NEAR) * distance;
    float lo[3], hi[3];
    uint64_t block;
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = nextafterf((float)(at[axis] - reach), -INFINITY);
        hi[axis] = nextafterf((float)(at[axis] + reach), INFINITY);
    }
    hewn_bvh_walk walk = hewn_bvh_walk_begin(&samples->bvh, lo, hi, 0);
    while (hewn_bvh_walk_next(&walk, &block))
        for (uint64_t slot = 4 * block; slot < 4 * block + 4; slot++) {
            const uint32_t face = samples->bvh.order[slot];
            double n[3];
            hewn_triangle_normal(&samples->input, face, n);
            if (simplify_dot(normal, n) < 0 && hewn_view_reach(&samples->input, face, at) <= reach)
                return true;
        }
    return false;
}

/* How much what is nearest to a point, in all of the input, faces away from a normal: 2, or 1 where several triangles
 * are as near, at an edge or a corner, and another one does than was found first. */
static int faces_away(const simplify_samples *samples, const double at[3], const double normal[3], uint32_t guess)
{
    const hewn_side side = hewn_bvh_nearest_side(&samples->bvh, &samples->facing, &samples->input, at, guess, normal);
    double distance, n[3];
    if (side != HEWN_SIDE_UNSURE) /* mostly all that are near face alike */
        return side == HEWN_SIDE_AWAY ? 2 : 0;
    const uint32_t near = hewn_bvh_nearest(&samples->bvh, &samples->input, at, guess, &distance);
    hewn_triangle_normal(&samples->input, near, n);
    if (simplify_dot(normal, n) < 0)
        return 2;
    return !is_within(samples, near, n, at, distance) && any_faces_away(samples, at, normal, distance);
}

/* A triangle of the input near a point of a triangle: one around the nearest of its samples. */
static uint32_t guess_near(const simplify_work *work, uint32_t face, const double at[3])
{
    const simplify_samples *samples = work->samples;
    uint32_t near = work->face_origins[face];
    double least = INFINITY;
    for (uint32_t s = samples->first[face]; s != HEWN_NONE; s = samples->items[s].next) {
        double away[3];
        simplify_between(at, samples->items[s].at, away);
        const double square = simplify_dot(away, away);
        near = square < least ? samples->faces[samples->rings[s]] : near;
        least = square < least ? square : least;
    }
    return near;
}

static void middle_of(const double a[3], const double b[3], const double c[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (a[axis] + b[axis] + c[axis]) / 3;
}

uint32_t hewn_simplify_nearest(const simplify_work *work, uint32_t face)
{
    const simplify_samples *samples = work->samples;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    double middle[3], distance;
    middle_of(simplify_at(work, corner[0]), simplify_at(work, corner[1]), simplify_at(work, corner[2]), middle);
    return hewn_bvh_nearest(&samples->bvh, &samples->input, middle, guess_near(work, face, middle), &distance);
}

hewn_side hewn_simplify_side(const simplify_work *work, const double a[3], const double b[3], const double c[3],
                             uint32_t guess)
{
    const simplify_samples *samples = work->samples;
    double middle[3], n[3];
    middle_of(a, b, c, middle);
    simplify_area_vector(a, b, c, n);
    return hewn_bvh_nearest_side(&samples->bvh, &samples->facing, &samples->input, middle, guess, n);
}

int hewn_simplify_how_turned(const simplify_work *work, uint32_t face)
{
    const simplify_samples *samples = work->samples;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    const double *a = simplify_at(work, corner[0]), *b = simplify_at(work, corner[1]),
                 *c = simplify_at(work, corner[2]);
    double middle[3], n[3];
    middle_of(a, b, c, middle);
    simplify_area_vector(a, b, c, n);
    return faces_away(samples, middle, n, guess_near(work, face, middle));
}

bool hewn_simplify_is_turned(const simplify_work *work, uint32_t face)
{
    return hewn_simplify_how_turned(work, face) > 0;
}

uint32_t hewn_simplify_count_turned(const simplify_work *work, uint32_t v, uint32_t but)
{
    const uint32_t first = work->half[v];
    uint32_t h = first, count = 0;
    do {
        const uint32_t in = simplify_prev(h);
        if (simplify_head(work, h) != but && work->tail[in] != but)
            count += hewn_simplify_is_turned(work, h / 3);
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return count;
}

uint32_t hewn_simplify_probe_turns(const simplify_work *work, const simplify_probe *probe, uint32_t most)
{
    const simplify_samples *samples = work->samples;
    uint32_t turned = 0;
    for (size_t i = 0; i < probe->mark_count && turned <= most; i++) {
        const simplify_mark_block *block = &probe->blocks[i / SIMPLIFY_FOUR];
        const uint32_t lane = i % SIMPLIFY_FOUR, f = probe->marks[i].face;
        const uint32_t sample = probe->points[block->nearest[lane]].sample;
        double place[3], normal[3];
        if (probe->marks[i].kind != MARK_MIDDLE)
            continue;
        simplify_fan_vector(block->at[0], lane, place);
        for (int axis = 0; axis < 3; axis++)
            place[axis] += probe->place[axis];
        simplify_fan_vector(probe->fan.blocks[f / SIMPLIFY_FOUR].across[3][0], f % SIMPLIFY_FOUR, normal);
        turned += faces_away(samples, place, normal, samples->faces[samples->rings[sample]]) > 0;
    }
    return turned;
}
