/* The certificate of a mesh that comes in parts. A vertex is examined when no later face can name it: then all its
 * faces are there. Faces stay as long as one of their vertices is open or has not come, and their vertices with them;
 * so what is kept from part to part is the seam between what has come and what is to come. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/check_parts.h"

/* A vertex of the seam. */
typedef struct seam_vertex {
    uint32_t number;
    uint32_t label; /* of its component; HEWN_NONE where it is settled or no face with sides names it yet */
    float position[3];
    bool known;    /* the position */
    bool examined; /* in an earlier part */
} seam_vertex;

typedef struct seam_face {
    uint32_t corners[3]; /* the whole mesh's numbers */
    bool measured;
} seam_face;

struct hewn_certifier {
    seam_vertex *vertices;
    size_t vertex_count, vertex_room;
    seam_face *faces;
    size_t face_count, face_room;
    uint32_t labels;
    hewn_measure_sums sums;
    hewn_box bounds;
    double origin[3]; /* vertex 0 */
    bool has_origin, names_origin;
    hewn_star_counts counts;
    uint64_t components, all_faces, collapsed;
};

/* A part at work. Vertices go by places: first those of its two runs, then those of the seam. `ranks` of places order
 * them: examined before, to be examined now, open. */
typedef struct part_check {
    hewn_certifier *all;
    const hewn_mesh_part *part;
    uint32_t *slots; /* open addressing: places of the seam by number, HEWN_NONE is free */
    size_t slot_count;
    uint64_t run_count, place_count, face_count;
    uint64_t old_faces; /* of the seam: they come first */
    uint32_t *corners;  /* 3 a face: places, later ranks */
    uint8_t *measured;  /* a face */
    uint32_t *ranks;
    uint64_t examined, settled; /* ranks end there */
    hewn_face_view view;
    hewn_stars stars;
    _Atomic uint32_t *trees;
    uint32_t *labels; /* of roots of trees */
} part_check;

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory certifying a part of a mesh");
}

/* --- places ------------------------------------------------------------------------------------------------------- */

/* The place of a vertex in the runs; HEWN_NONE where it is in none. */
static uint32_t place_in_runs(const part_check *of, uint32_t number)
{
    const hewn_vertex_run *runs = of->part->vertices;
    if (number - runs[0].first < runs[0].count)
        return (uint32_t)(number - runs[0].first);
    if (number - runs[1].first < runs[1].count)
        return (uint32_t)(runs[0].count + number - runs[1].first);
    return HEWN_NONE;
}

static size_t find_slot(const part_check *of, uint32_t number)
{
    size_t mask = of->slot_count - 1, at = (size_t)(number * (uint64_t)0x9e3779b97f4a7c15u >> 32) & mask;
    while (of->slots[at] != HEWN_NONE && of->all->vertices[of->slots[at]].number != number)
        at = (at + 1) & mask;
    return at;
}

static hewn_result grow_slots(part_check *of, hewn_error *error)
{
    size_t count = 1024;
    while (count < 3 * of->all->vertex_count)
        count *= 2;
    uint32_t *slots = hewn_alloc(count, sizeof *slots);
    if (!slots)
        return fail_memory(error);
    memset(slots, 0xFF, count * sizeof *slots);
    hewn_free(of->slots);
    of->slots = slots;
    of->slot_count = count;
    for (size_t i = 0; i < of->all->vertex_count; i++)
        slots[find_slot(of, of->all->vertices[i].number)] = (uint32_t)i;
    return HEWN_OK;
}

/* The place of a vertex, which the seam gets where it is new. */
static hewn_result place_of(part_check *of, uint32_t number, uint32_t *out, hewn_error *error)
{
    hewn_certifier *all = of->all;
    *out = place_in_runs(of, number);
    if (*out != HEWN_NONE)
        return HEWN_OK;
    size_t slot = find_slot(of, number);
    if (of->slots[slot] == HEWN_NONE) {
        void *items = all->vertices;
        HEWN_TRY(hewn_reserve(&items, &all->vertex_room, all->vertex_count + 1, sizeof *all->vertices, error));
        all->vertices = items;
        all->vertices[all->vertex_count++] = (seam_vertex){.number = number, .label = HEWN_NONE};
        if (2 * all->vertex_count > of->slot_count)
            HEWN_TRY(grow_slots(of, error));
        else
            of->slots[slot] = (uint32_t)(all->vertex_count - 1);
        slot = find_slot(of, number);
    }
    *out = (uint32_t)(of->run_count + of->slots[slot]);
    return HEWN_OK;
}

static const seam_vertex *seam_at(const part_check *of, uint32_t place)
{
    return &of->all->vertices[place - of->run_count];
}

/* Where a vertex lies; NULL while that is not known. */
static const float *position_at(const part_check *of, uint32_t place)
{
    const hewn_vertex_run *runs = of->part->vertices;
    if (place < runs[0].count)
        return runs[0].positions + 3 * (uint64_t)place;
    if (place < of->run_count)
        return runs[1].positions + 3 * (place - runs[0].count);
    return seam_at(of, place)->known ? seam_at(of, place)->position : NULL;
}

static uint32_t number_at(const part_check *of, uint32_t place)
{
    const hewn_vertex_run *runs = of->part->vertices;
    if (place < runs[0].count)
        return (uint32_t)(runs[0].first + place);
    if (place < of->run_count)
        return (uint32_t)(runs[1].first + place - runs[0].count);
    return seam_at(of, place)->number;
}

/* The corners of a face, as the whole mesh numbers them. */
static const uint32_t *face_at(const part_check *of, uint64_t face)
{
    const hewn_triangle_run *runs = of->part->triangles;
    if (face < of->old_faces)
        return of->all->faces[face].corners;
    face -= of->old_faces;
    return face < runs[0].count ? runs[0].indices + 3 * face : runs[1].indices + 3 * (face - runs[0].count);
}

static hewn_result check_part(const hewn_mesh_part *part, hewn_error *error)
{
    for (int i = 0; i < 2; i++) {
        const hewn_vertex_run *run = &part->vertices[i];
        if (run->first + run->count > UINT32_MAX)
            return hewn_fail(error, HEWN_LIMIT, "more vertices than can be examined");
        HEWN_TRY(hewn_check_positions(NULL, run->positions, run->positions ? run->count : 0, error));
    }
    return HEWN_OK;
}

static hewn_result place_corners(part_check *of, hewn_error *error)
{
    hewn_certifier *all = of->all;
    uint64_t count = of->old_faces + of->part->triangles[0].count + of->part->triangles[1].count;
    of->face_count = count;
    of->run_count = of->part->vertices[0].count + of->part->vertices[1].count;
    if (count > UINT32_MAX / 3 || of->run_count + all->vertex_count + 3 * count > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "a part of %llu faces is more than can be examined",
                         (unsigned long long)count);
    for (size_t i = 0; i < all->vertex_count; i++)
        if (all->vertices[i].known && place_in_runs(of, all->vertices[i].number) != HEWN_NONE)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "vertex %u comes twice", all->vertices[i].number);
    of->corners = hewn_alloc(count, 3 * sizeof *of->corners);
    of->measured = hewn_alloc_zero(count, sizeof *of->measured);
    if (!of->corners || !of->measured)
        return fail_memory(error);
    HEWN_TRY(grow_slots(of, error));
    for (uint64_t f = 0; f < count; f++)
        for (int k = 0; k < 3; k++)
            HEWN_TRY(place_of(of, face_at(of, f)[k], &of->corners[3 * f + (uint64_t)k], error));
    of->place_count = of->run_count + all->vertex_count;
    return HEWN_OK;
}

/* --- measures ----------------------------------------------------------------------------------------------------- */

static void find_origin(part_check *of)
{
    uint32_t place = place_in_runs(of, 0);
    if (place == HEWN_NONE)
        return;
    for (int axis = 0; axis < 3; axis++)
        of->all->origin[axis] = (double)position_at(of, place)[axis];
    of->all->has_origin = true;
}

/* Adds a face whose corners have come. */
static void measure_face(const part_check *of, uint64_t face, hewn_measure_sums *sums, hewn_box *bounds)
{
    double points[3][3];
    for (int k = 0; k < 3; k++) {
        const float *from = position_at(of, of->corners[3 * face + (uint64_t)k]);
        if (!from)
            return;
        for (int axis = 0; axis < 3; axis++)
            points[k][axis] = (double)from[axis];
    }
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++) {
            bounds->lo[axis] = points[k][axis] < bounds->lo[axis] ? points[k][axis] : bounds->lo[axis];
            bounds->hi[axis] = points[k][axis] > bounds->hi[axis] ? points[k][axis] : bounds->hi[axis];
        }
    hewn_measured one = hewn_measure_corners(points[0], points[1], points[2], of->all->origin, INFINITY);
    one.flat = one.flat && hewn_points_collinear(points[0], points[1], points[2]);
    hewn_measure_sums_add(sums, one);
    of->measured[face] = true;
}

static void measure_faces(const part_check *of)
{
    hewn_certifier *all = of->all;
    for (uint64_t f = 0; f < of->old_faces; f++)
        of->measured[f] = all->faces[f].measured;
#pragma omp parallel if (of->face_count >= HEWN_CHECK_ALONE)
    {
        hewn_measure_sums sums = {0};
        hewn_box bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
#pragma omp for schedule(static)
        for (uint64_t f = 0; f < of->face_count; f++)
            if (!of->measured[f])
                measure_face(of, f, &sums, &bounds);
#pragma omp critical(hewn_certifier_sums)
        {
            hewn_measure_sums_join(&all->sums, &sums);
            for (int axis = 0; axis < 3; axis++) {
                all->bounds.lo[axis] = fmin(all->bounds.lo[axis], bounds.lo[axis]);
                all->bounds.hi[axis] = fmax(all->bounds.hi[axis], bounds.hi[axis]);
            }
        }
    }
}

/* --- stars -------------------------------------------------------------------------------------------------------- */

static bool is_open(const hewn_mesh_part *part, uint32_t number)
{
    uint64_t low = 0, high = part->open_count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (part->open[middle].first + part->open[middle].count <= number)
            low = middle + 1;
        else
            high = middle;
    }
    return low < part->open_count && part->open[low].first <= number;
}

/* 0: examined before, 1: settled now, 2: open. */
static uint32_t class_of(const part_check *of, uint32_t place)
{
    if (place >= of->run_count && seam_at(of, place)->examined)
        return 0;
    return is_open(of->part, number_at(of, place)) ? 2 : 1;
}

/* A vertex of the seam that comes with this part is in a run now, and its old place is nobody's. */
static bool has_moved(const part_check *of, uint32_t place)
{
    return place >= of->run_count && place_in_runs(of, seam_at(of, place)->number) != HEWN_NONE;
}

static hewn_result rank_places(part_check *of, hewn_error *error)
{
    uint64_t counts[4] = {0}, count = of->place_count;
    of->ranks = hewn_alloc(count, sizeof *of->ranks);
    if (!of->ranks)
        return fail_memory(error);
#pragma omp parallel for schedule(static) if (count >= HEWN_CHECK_ALONE)
    for (uint64_t i = 0; i < count; i++)
        of->ranks[i] = class_of(of, (uint32_t)i);
    for (uint64_t i = 0; i < count; i++) {
        if (of->ranks[i] == 1 && !position_at(of, (uint32_t)i) && !has_moved(of, (uint32_t)i))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a face names vertex %u, which is not open",
                             number_at(of, (uint32_t)i));
        counts[of->ranks[i] + 1]++;
    }
    counts[2] += counts[1];
    of->examined = counts[1];
    of->settled = counts[2];
    for (uint64_t i = 0; i < count; i++)
        of->ranks[i] = (uint32_t)counts[of->ranks[i]]++;
#pragma omp parallel for schedule(static) if (of->face_count >= HEWN_CHECK_ALONE)
    for (uint64_t c = 0; c < 3 * of->face_count; c++)
        of->corners[c] = of->ranks[of->corners[c]];
    return HEWN_OK;
}

/* An edge is counted at its end of the lesser rank if that is settled now: ranks see to it that this happens once. */
static hewn_result examine_stars(part_check *of, hewn_error *error)
{
    of->view = (hewn_face_view){.vertex_count = of->place_count,
                                .face_count = of->face_count,
                                .corner_count = 3 * of->face_count,
                                .corners = of->corners};
    HEWN_TRY(hewn_stars_build(&of->view, &of->stars, error));
    return hewn_stars_examine(&of->view, &of->stars, of->examined, of->settled, NULL, &of->all->counts, error);
}

/* --- components --------------------------------------------------------------------------------------------------- */

/* Vertices of one label are of one component, whatever joined them. */
static hewn_result join_labels(part_check *of, hewn_error *error)
{
    hewn_certifier *all = of->all;
    uint32_t *first = hewn_alloc(all->labels, sizeof *first);
    if (!first)
        return fail_memory(error);
    memset(first, 0xFF, all->labels * sizeof *first);
    for (size_t i = 0; i < all->vertex_count; i++) {
        uint32_t label = all->vertices[i].label, place = place_in_runs(of, all->vertices[i].number);
        if (label == HEWN_NONE)
            continue;
        uint32_t rank = of->ranks[place == HEWN_NONE ? of->run_count + i : place];
        if (first[label] == HEWN_NONE)
            first[label] = rank;
        else
            hewn_trees_join(of->trees, first[label], rank);
    }
    hewn_free(first);
    return HEWN_OK;
}

/* Components without open vertices are complete; the others' roots get labels. */
static hewn_result count_components(part_check *of, hewn_error *error)
{
    uint64_t roots = 0;
    uint32_t labels = 0;
    HEWN_TRY(hewn_trees_grow(&of->view, &of->stars, &of->trees, &roots, error));
    HEWN_TRY(join_labels(of, error));
    of->labels = hewn_alloc(of->place_count, sizeof *of->labels);
    if (!of->labels)
        return fail_memory(error);
    memset(of->labels, 0xFF, of->place_count * sizeof *of->labels);
    roots = 0;
    for (uint32_t v = 0; v < of->place_count; v++) {
        if (hewn_star_length(&of->stars, v) == 0)
            continue;
        uint32_t root = hewn_trees_root(of->trees, v);
        roots += root == v;
        if (v >= of->settled && of->labels[root] == HEWN_NONE)
            of->labels[root] = labels++;
    }
    of->all->components += roots - labels;
    of->all->labels = labels;
    return HEWN_OK;
}

/* --- the seam ----------------------------------------------------------------------------------------------------- */

static bool is_kept(const part_check *of, uint64_t face)
{
    const uint32_t *rank = of->corners + 3 * face;
    bool open = rank[0] >= of->settled || rank[1] >= of->settled || rank[2] >= of->settled;
    return !of->measured[face] || (open && !hewn_triangle_collapsed(rank));
}

static seam_vertex seam_vertex_of(const part_check *of, uint32_t place)
{
    uint32_t rank = of->ranks[place];
    const float *position = position_at(of, place);
    /* Only open vertices tell of their component: all faces around them are in the seam, and others join no more. */
    bool joins = rank >= of->settled && hewn_star_length(&of->stars, rank) > 0;
    seam_vertex vertex = {.number = number_at(of, place),
                          .label = joins ? of->labels[hewn_trees_root(of->trees, rank)] : HEWN_NONE,
                          .known = position != NULL,
                          .examined = rank < of->settled};
    if (position)
        memcpy(vertex.position, position, sizeof vertex.position);
    return vertex;
}

/* Open vertices are kept whether or not faces name them yet. */
static bool is_waiting(const part_check *of, uint32_t place)
{
    return of->ranks[place] >= of->settled && !has_moved(of, place);
}

/* Counts what the next seam will have; `taken` marks the ranks of its vertices. */
static void count_kept(const part_check *of, uint8_t *taken, size_t *vertices, size_t *faces)
{
    *vertices = *faces = 0;
    for (uint64_t i = 0; i < of->place_count; i++)
        if (is_waiting(of, (uint32_t)i)) {
            taken[of->ranks[i]] = 1;
            ++*vertices;
        }
    for (uint64_t f = 0; f < of->face_count; f++) {
        if (!is_kept(of, f))
            continue;
        ++*faces;
        for (uint64_t c = 3 * f; c < 3 * f + 3; c++) {
            *vertices += !taken[of->corners[c]];
            taken[of->corners[c]] = 1;
        }
    }
}

static void keep_vertex(const part_check *of, uint32_t place, uint8_t *taken, hewn_certifier *next)
{
    if (taken[of->ranks[place]])
        next->vertices[next->vertex_count++] = seam_vertex_of(of, place);
    taken[of->ranks[place]] = 0;
}

/* The marks go as the vertices get their places in the seam. */
static hewn_result fill_seam(part_check *of, uint8_t *taken, hewn_certifier *next, hewn_error *error)
{
    for (uint64_t i = 0; i < of->place_count; i++)
        if (is_waiting(of, (uint32_t)i))
            keep_vertex(of, (uint32_t)i, taken, next);
    for (uint64_t f = 0; f < of->face_count; f++) {
        if (!is_kept(of, f))
            continue;
        const uint32_t *corners = face_at(of, f);
        next->faces[next->face_count++] = (seam_face){{corners[0], corners[1], corners[2]}, of->measured[f]};
        for (uint64_t k = 0; k < 3; k++) {
            uint32_t place;
            HEWN_TRY(place_of(of, corners[k], &place, error));
            keep_vertex(of, place, taken, next);
        }
    }
    return HEWN_OK;
}

static hewn_result keep_seam(part_check *of, hewn_error *error)
{
    hewn_certifier *all = of->all, next = *all;
    uint8_t *taken = hewn_alloc_zero(of->place_count, sizeof *taken);
    if (!taken)
        return fail_memory(error);
    count_kept(of, taken, &next.vertex_room, &next.face_room);
    next.vertex_count = next.face_count = 0;
    next.vertices = hewn_alloc(next.vertex_room, sizeof *next.vertices);
    next.faces = hewn_alloc(next.face_room, sizeof *next.faces);
    hewn_result result = next.vertices && next.faces ? fill_seam(of, taken, &next, error) : fail_memory(error);
    hewn_free(taken);
    hewn_free(result == HEWN_OK ? all->vertices : next.vertices);
    hewn_free(result == HEWN_OK ? all->faces : next.faces);
    if (result == HEWN_OK)
        *all = next;
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void count_faces(const part_check *of)
{
    hewn_certifier *all = of->all;
    uint64_t collapsed = 0, origin = 0;
#pragma omp parallel for schedule(static) reduction(+ : collapsed, origin) if (of->face_count >= HEWN_CHECK_ALONE)
    for (uint64_t f = of->old_faces; f < of->face_count; f++) {
        const uint32_t *corners = face_at(of, f);
        collapsed += hewn_triangle_collapsed(corners);
        origin += corners[0] == 0 || corners[1] == 0 || corners[2] == 0;
    }
    all->all_faces += of->face_count - of->old_faces;
    all->collapsed += collapsed;
    all->names_origin = all->names_origin || origin > 0;
}

static hewn_result take_part(part_check *of, hewn_error *error)
{
    HEWN_TRY(check_part(of->part, error));
    HEWN_TRY(place_corners(of, error));
    find_origin(of);
    if (!of->all->has_origin && of->run_count > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "vertices come before vertex 0");
    count_faces(of);
    measure_faces(of);
    HEWN_TRY(rank_places(of, error));
    HEWN_TRY(examine_stars(of, error));
    HEWN_TRY(count_components(of, error));
    return keep_seam(of, error);
}

hewn_result hewn_certifier_take(hewn_certifier *certifier, const hewn_mesh_part *part, hewn_error *error)
{
    part_check of = {.all = certifier, .part = part, .old_faces = certifier->face_count};
    hewn_result result = take_part(&of, error);
    hewn_free(of.slots);
    hewn_free(of.corners);
    hewn_free(of.measured);
    hewn_free(of.ranks);
    hewn_free((void *)of.trees);
    hewn_free(of.labels);
    hewn_stars_free(&of.stars);
    return result;
}

hewn_result hewn_certifier_create(hewn_certifier **out, hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    if (!*out)
        return fail_memory(error);
    (*out)->bounds = (hewn_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    return HEWN_OK;
}

void hewn_certifier_destroy(hewn_certifier **certifier)
{
    if (!*certifier)
        return;
    hewn_free((*certifier)->vertices);
    hewn_free((*certifier)->faces);
    hewn_free(*certifier);
    *certifier = NULL;
}

/* Faces that name open vertices: those that the seam will have, but for what is kept already. */
static uint64_t count_open(const hewn_mesh_part *part)
{
    uint64_t open = 0;
    for (int i = 0; i < 2 && part->open_count > 0; i++) {
        const hewn_triangle_run *run = &part->triangles[i];
#pragma omp parallel for schedule(static) reduction(+ : open) if (run->count >= HEWN_CHECK_ALONE)
        for (uint64_t t = 0; t < run->count; t++) {
            const uint32_t *corner = run->indices + 3 * t;
            open += is_open(part, corner[0]) || is_open(part, corner[1]) || is_open(part, corner[2]);
        }
    }
    return open;
}

/* Vertices of the part that are open from the beginning. */
static uint64_t count_waiting(const hewn_mesh_part *part)
{
    uint64_t waiting = 0;
    for (uint64_t i = 0; i < part->open_count; i++)
        for (int k = 0; k < 2; k++) {
            uint64_t first = part->vertices[k].first, end = first + part->vertices[k].count;
            uint64_t low = part->open[i].first, high = low + part->open[i].count;
            low = low > first ? low : first;
            high = high < end ? high : end;
            waiting += high > low ? high - low : 0;
        }
    return waiting;
}

/* A vertex has a rank, a parent, a label, a mark and the start of its row; a face its corners twice and a mark. The
 * seam is there twice at the end, and while it grows its vertices are there three times; a slot is at most 24 bytes a
 * vertex, and half of that again while slots are moved. */
uint64_t hewn_certifier_bytes(const hewn_certifier *certifier, const hewn_mesh_part *part)
{
    uint64_t kept = certifier->vertex_room * sizeof(seam_vertex) + certifier->face_room * sizeof(seam_face);
    if (!part)
        return kept + sizeof *certifier;
    uint64_t open = count_open(part), seam = certifier->vertex_count + open + open / 2 + count_waiting(part) + 64;
    uint64_t vertices = part->vertices[0].count + part->vertices[1].count;
    uint64_t faces = part->triangles[0].count + part->triangles[1].count;
    return kept + sizeof *certifier + 3 * sizeof(seam_vertex) * seam + 36 * seam + 6144 + sizeof(seam_face) * open +
           17 * (vertices + seam) + 25 * (faces + certifier->face_count) + 4 * (uint64_t)certifier->labels;
}

hewn_result hewn_certifier_finish(hewn_certifier *certifier, hewn_certificate *out, hewn_error *error)
{
    *out = (hewn_certificate){0};
    if (certifier->vertex_count > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "the mesh is not complete: %llu vertices have not come or are open, as vertex %u",
                         (unsigned long long)certifier->vertex_count, certifier->vertices[0].number);
    if (certifier->all_faces > 0 && !certifier->names_origin)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "no face names vertex 0");
    bool empty = certifier->all_faces == 0;
    hewn_certificate certificate = {.components = certifier->components,
                                    .degenerate_faces = certifier->sums.flat,
                                    .volume = hewn_exact_sum_value(&certifier->sums.volume) / 6,
                                    .area = hewn_exact_sum_value(&certifier->sums.area) / 2,
                                    .max_residual = NAN};
    for (int axis = 0; axis < 3; axis++) { /* no -0 */
        certificate.bounds.lo[axis] = empty ? 0 : certifier->bounds.lo[axis] + 0.0;
        certificate.bounds.hi[axis] = empty ? 0 : certifier->bounds.hi[axis] + 0.0;
    }
    hewn_certify_counts(&certifier->counts, certifier->all_faces - certifier->collapsed, &certificate);
    *out = certificate;
    return HEWN_OK;
}
