#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"
#include "simplify/samples.h"

/* The cosine between triangles that meet in a ridge, and the square of one between what faces the same way. */
static const double ridge_cosine = 0.92, least_along = 0.25;

/* A triangle with its plane and those across its sides, unit normals that point outward and offsets. */
typedef struct probe_face {
    uint32_t face;
    bool flat; /* without area: there are no planes */
    double corners[3][3], planes[4][4];
} probe_face;

typedef struct probe_place {
    uint32_t sample, face; /* of the probe */
    float gap;
} probe_place;

/* A point of the mesh as it would be, and the sample nearest to it. */
typedef struct probe_point {
    double at[3], square;
    uint32_t sample;
} probe_point;

void hewn_simplify_probe_release(simplify_probe *probe)
{
    hewn_free(probe->faces);
    hewn_free(probe->places);
    hewn_free(probe->points);
    *probe = (simplify_probe){0};
}

/* --- distances ---------------------------------------------------------------------------------------------------- */

static void set_plane(double plane[4], const double normal[3], double length, const double at[3])
{
    for (int axis = 0; axis < 3; axis++)
        plane[axis] = normal[axis] / length;
    plane[3] = -simplify_dot(plane, at);
}

static void set_planes(probe_face *face)
{
    double n[3];
    simplify_area_vector(face->corners[0], face->corners[1], face->corners[2], n);
    const double square = simplify_dot(n, n);
    face->flat = !(square > 0);
    if (face->flat)
        return;
    set_plane(face->planes[3], n, sqrt(square), face->corners[0]);
    for (int k = 0; k < 3; k++) {
        const double *from = face->corners[k], *to = face->corners[k == 2 ? 0 : k + 1];
        double along[3], out[3];
        simplify_between(from, to, along);
        simplify_cross(along, n, out);
        const double length = sqrt(simplify_dot(out, out));
        face->flat |= !(length > 0);
        set_plane(face->planes[k], out, length, from);
    }
}

static double above(const double plane[4], const double at[3])
{
    return simplify_dot(plane, at) + plane[3];
}

static double square_to_side(const double at[3], const double from[3], const double to[3])
{
    double along[3], away[3];
    simplify_between(from, to, along);
    simplify_between(from, at, away);
    const double length = simplify_dot(along, along);
    double share = length > 0 ? simplify_dot(along, away) / length : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    for (int axis = 0; axis < 3; axis++)
        away[axis] -= share * along[axis];
    return simplify_dot(away, away);
}

/* The squared distance of a point to a triangle, or something not below `enough` where it is not less than that. What
 * is nearest in the plane is on a side that the point is beyond. */
static double square_to(const probe_face *face, const double at[3], double enough)
{
    double beyond[3], square = INFINITY;
    if (!face->flat) {
        const double height = above(face->planes[3], at), high = height * height;
        double most = 0;
        for (int k = 0; k < 3; k++) {
            beyond[k] = above(face->planes[k], at);
            most = beyond[k] > most ? beyond[k] : most;
        }
        if (!(most > 0) || high + most * most >= enough)
            return high + most * most;
    }
    for (int k = 0; k < 3; k++)
        if (face->flat || beyond[k] > 0) {
            const double found = square_to_side(at, face->corners[k], face->corners[k == 2 ? 0 : k + 1]);
            square = found < square ? found : square;
        }
    return square;
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* The triangles around `v` with `to` in its place, but for those with `other`. */
static hewn_result take_fan(const simplify_work *work, uint32_t v, uint32_t other, const double to[3],
                            simplify_probe *probe)
{
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        const uint32_t in = simplify_prev(h), p = simplify_head(work, h), q = work->tail[in];
        if (p == other || q == other) {
            probe->cleared[probe->cleared[0] != HEWN_NONE && probe->cleared[0] != h / 3] = h / 3;
        } else {
            HEWN_TRY(hewn_reserve((void **)&probe->faces, &probe->face_capacity, probe->face_count + 1,
                                  sizeof *probe->faces, NULL));
            probe_face *face = &probe->faces[probe->face_count++];
            *face = (probe_face){.face = h / 3};
            for (int axis = 0; axis < 3; axis++) {
                face->corners[0][axis] = to[axis];
                face->corners[1][axis] = simplify_at(work, p)[axis];
                face->corners[2][axis] = simplify_at(work, q)[axis];
            }
            set_planes(face);
        }
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return HEWN_OK;
}

/* --- samples ------------------------------------------------------------------------------------------------------ */

/* Samples of one triangle, which is `own` of the probe's or goes. */
static hewn_result place_samples(const simplify_work *work, uint32_t face, uint32_t own, simplify_probe *probe)
{
    const simplify_samples *samples = work->samples;
    for (uint32_t s = samples->first[face]; s != HEWN_NONE; s = samples->items[s].next) {
        const simplify_sample *sample = &samples->items[s];
        const double was = (double)sample->gap;
        uint32_t best = own;
        double least = own == HEWN_NONE ? INFINITY : square_to(&probe->faces[own], sample->at, INFINITY);
        for (uint32_t f = 0; f < probe->face_count; f++) {
            const double square = f == own ? INFINITY : square_to(&probe->faces[f], sample->at, least);
            if (square < least) {
                least = square;
                best = f;
            }
        }
        HEWN_TRY(hewn_reserve((void **)&probe->places, &probe->place_capacity, probe->place_count + 1,
                              sizeof *probe->places, NULL));
        const double gap = sqrt(least);
        probe->places[probe->place_count++] = (probe_place){s, best, (float)gap};
        probe->before += was * was;
        probe->after += least;
        if (gap > was * 1.001 && gap > probe->most)
            probe->most = gap;
        if (probe->most > probe->plenty) {
            probe->cut = true;
            break;
        }
    }
    return HEWN_OK;
}

/* --- back to the input -------------------------------------------------------------------------------------------- */

/* The vertex, then of each triangle the middle of a side that changes and its own. */
static hewn_result list_points(const double at[3], simplify_probe *probe)
{
    const size_t count = 1 + 2 * probe->face_count;
    HEWN_TRY(hewn_reserve((void **)&probe->points, &probe->point_capacity, count, sizeof *probe->points, NULL));
    for (size_t i = 0; i < count; i++)
        probe->points[i] = (probe_point){.square = INFINITY, .sample = HEWN_NONE};
    for (int axis = 0; axis < 3; axis++) {
        probe->points[0].at[axis] = at[axis];
        for (size_t f = 0; f < probe->face_count; f++) {
            const probe_face *face = &probe->faces[f];
            const double two = face->corners[0][axis] + face->corners[1][axis];
            probe->points[1 + 2 * f].at[axis] = two / 2;
            probe->points[2 + 2 * f].at[axis] = (two + face->corners[2][axis]) / 3;
        }
    }
    return HEWN_OK;
}

static void find_samples(const simplify_samples *samples, simplify_probe *probe)
{
    for (size_t i = 0; i < probe->place_count; i++) {
        const uint32_t s = probe->places[i].sample;
        const double *at = samples->items[s].at;
        for (size_t k = 0; k < 1 + 2 * probe->face_count; k++) {
            probe_point *point = &probe->points[k];
            double away[3];
            simplify_between(point->at, at, away);
            const double square = simplify_dot(away, away);
            if (square < point->square) {
                point->square = square;
                point->sample = s;
            }
        }
    }
}

/* The triangle of the input near a point: of those around the nearest sample, or of all where that is not near enough
 * to make no difference. Without `exact` any that is near enough will do. */
static uint32_t look_back(const simplify_samples *samples, const probe_point *point, bool exact, simplify_probe *probe)
{
    const double enough = fmax(probe->enough, fmax(probe->most, probe->back));
    double least = INFINITY;
    uint32_t near = 0;
    for (uint32_t i = samples->rings[point->sample]; i < samples->rings[point->sample + 1]; i++) {
        const uint32_t *corner = samples->input.corners + 3 * (size_t)samples->faces[i];
        const double distance =
            hewn_triangle_reach(point->at, samples->positions + 3 * (size_t)corner[0],
                                samples->positions + 3 * (size_t)corner[1], samples->positions + 3 * (size_t)corner[2]);
        near = distance < least ? samples->faces[i] : near;
        least = distance < least ? distance : least;
        if (least <= enough && !exact)
            return near;
    }
    if (!(least <= enough)) {
        near = hewn_bvh_nearest(&samples->bvh, &samples->input, point->at, near, &least);
        probe->back = fmax(least, probe->back);
    }
    return near;
}

/* Whether a triangle of the input faces away from a normal. */
static bool faces_away(const simplify_samples *samples, uint32_t near, const double normal[3])
{
    const uint32_t *corner = samples->input.corners + 3 * (size_t)near;
    double n[3];
    simplify_area_vector(samples->positions + 3 * (size_t)corner[0], samples->positions + 3 * (size_t)corner[1],
                         samples->positions + 3 * (size_t)corner[2], n);
    return simplify_dot(normal, n) < 0;
}

bool hewn_simplify_is_turned(const simplify_work *work, uint32_t face)
{
    const simplify_samples *samples = work->samples;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    const double *a = simplify_at(work, corner[0]), *b = simplify_at(work, corner[1]),
                 *c = simplify_at(work, corner[2]);
    double middle[3], n[3], distance;
    for (int axis = 0; axis < 3; axis++)
        middle[axis] = (a[axis] + b[axis] + c[axis]) / 3;
    simplify_area_vector(a, b, c, n);
    return faces_away(samples,
                      hewn_bvh_nearest(&samples->bvh, &samples->input, middle, work->face_origins[face], &distance), n);
}

/* Whether the surface around a sample faces so much as the triangle does that all of it will. */
static bool is_along(const simplify_sample *sample, const probe_face *face)
{
    const double n[3] = {(double)sample->normal[0], (double)sample->normal[1], (double)sample->normal[2]};
    const double along = simplify_dot(face->planes[3], n);
    return along > 0 && along * along > least_along * simplify_dot(n, n);
}

/* Whether the side that a triangle shares with the one before may stand out: it does not where the two go on in much
 * the same way, for then samples of both tell. */
static bool is_ridge(const simplify_probe *probe, size_t f)
{
    const probe_face *face = &probe->faces[f], *last = &probe->faces[f > 0 ? f - 1 : probe->face_count - 1];
    for (int axis = 0; axis < 3; axis++)
        if (face->flat || last->flat || face->corners[1][axis] < last->corners[2][axis] ||
            face->corners[1][axis] > last->corners[2][axis])
            return true;
    return simplify_dot(face->planes[3], last->planes[3]) < ridge_cosine;
}

static hewn_result place_all(const simplify_work *work, const double at[3], simplify_probe *probe)
{
    const simplify_samples *samples = work->samples;
    for (int i = 0; i < 2 && !probe->cut; i++) /* what has most to lose first */
        if (probe->cleared[i] != HEWN_NONE)
            HEWN_TRY(place_samples(work, probe->cleared[i], HEWN_NONE, probe));
    for (uint32_t f = 0; f < probe->face_count && !probe->cut; f++)
        HEWN_TRY(place_samples(work, probe->faces[f].face, f, probe));
    if (probe->place_count == 0 || probe->cut)
        return HEWN_OK;
    HEWN_TRY(list_points(at, probe));
    find_samples(samples, probe);
    (void)look_back(samples, &probe->points[0], false, probe);
    for (size_t f = 0; f < probe->face_count; f++) {
        if (is_ridge(probe, f))
            (void)look_back(samples, &probe->points[1 + 2 * f], false, probe);
        const probe_face *face = &probe->faces[f];
        const probe_point *middle = &probe->points[2 + 2 * f];
        if (!face->flat && !is_along(&samples->items[middle->sample], face))
            probe->turned |= faces_away(samples, look_back(samples, middle, true, probe), face->planes[3]);
    }
    return HEWN_OK;
}

static void begin(simplify_probe *probe)
{
    probe->face_count = probe->place_count = 0;
    probe->cleared[0] = probe->cleared[1] = HEWN_NONE;
    probe->back = probe->most = probe->before = probe->after = 0;
    probe->turned = probe->cut = false;
}

hewn_result hewn_simplify_probe_collapse(const simplify_work *work, const simplify_plan *plan, simplify_probe *probe)
{
    begin(probe);
    HEWN_TRY(take_fan(work, plan->gone, plan->kept, plan->at, probe));
    HEWN_TRY(take_fan(work, plan->kept, plan->gone, plan->at, probe));
    return place_all(work, plan->at, probe);
}

hewn_result hewn_simplify_probe_move(const simplify_work *work, uint32_t v, const double to[3], simplify_probe *probe)
{
    begin(probe);
    HEWN_TRY(take_fan(work, v, HEWN_NONE, to, probe));
    return place_all(work, to, probe);
}

void hewn_simplify_probe_settle(const simplify_work *work, const simplify_probe *probe)
{
    simplify_samples *samples = work->samples;
    for (uint32_t f = 0; f < probe->face_count; f++)
        samples->first[probe->faces[f].face] = HEWN_NONE;
    for (int i = 0; i < 2; i++)
        if (probe->cleared[i] != HEWN_NONE)
            samples->first[probe->cleared[i]] = HEWN_NONE;
    for (size_t i = probe->place_count; i-- > 0;) {
        const probe_place *place = &probe->places[i];
        uint32_t *first = &samples->first[probe->faces[place->face].face];
        samples->items[place->sample].gap = place->gap;
        samples->items[place->sample].next = *first;
        *first = place->sample;
    }
}
