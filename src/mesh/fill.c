#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "mesh/hole.h"

/* Holes of more edges than this get vertices of their own. */
enum { PLAIN_EDGES = 8 };

/* The mesh around all holes, as it is before any is filled. Holes share no vertex, so one patch does not change what
 * another one sees. */
typedef struct filler {
    hewn_soup *soup;
    hewn_sides sides;
    uint32_t *mates;
    uint32_t *leaving; /* the open half-edge that leaves a vertex; HEWN_NONE once its hole was looked at */
    uint32_t *place;   /* of a vertex in the rim at hand, HEWN_NONE off it */
} filler;

static void free_filler(filler *f)
{
    hewn_sides_free(&f->sides);
    hewn_free(f->mates);
    hewn_free(f->leaving);
    hewn_free(f->place);
}

static hewn_result create_filler(hewn_soup *soup, filler *f, hewn_error *error)
{
    *f = (filler){.soup = soup};
    HEWN_TRY(hewn_sides_build(soup, &f->sides, error));
    size_t vertices = soup->vertex_count;
    f->mates = hewn_alloc(hewn_soup_corner_count(soup), sizeof *f->mates);
    f->leaving = hewn_alloc(vertices, sizeof *f->leaving);
    f->place = hewn_alloc(vertices, sizeof *f->place);
    if (!f->mates || !f->leaving || !f->place)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory looking for holes");
    memset(f->leaving, 0xFF, vertices * sizeof *f->leaving);
    memset(f->place, 0xFF, vertices * sizeof *f->place);
    for (uint32_t g = 0; g < f->sides.count; g++) {
        uint32_t begin = f->sides.group[g], end = f->sides.group[g + 1];
        uint32_t a = f->sides.sides[begin], b = f->sides.sides[end - 1];
        f->mates[a] = a == b ? HEWN_NONE : b;
        f->mates[b] = a == b ? HEWN_NONE : a;
        if (a == b)
            f->leaving[hewn_side_tail(soup, a)] = a;
    }
    return HEWN_OK;
}

/* --- the rim ------------------------------------------------------------------------------------------------------ */

static void free_hole(hewn_hole *hole)
{
    hewn_free(hole->rim);
    hewn_free(hole->normals);
    hewn_free(hole->outer);
    hewn_free(hole->outer_area);
    hewn_free(hole->joined);
    hewn_free(hole->positions);
    hewn_free(hole->spacing);
    hewn_free(hole->faces);
}

static hewn_result create_hole(hewn_hole *hole, uint32_t count, hewn_error *error)
{
    *hole = (hewn_hole){.rim_count = count, .vertex_count = count};
    hole->rim = hewn_alloc(count, sizeof *hole->rim);
    hole->normals = hewn_alloc(count, 3 * sizeof(double));
    hole->outer = hewn_alloc_zero(count, 3 * sizeof(double));
    hole->outer_area = hewn_alloc_zero(count, sizeof(double));
    hole->joined = hewn_alloc_zero((size_t)count * count, 1);
    hole->positions = hewn_alloc(count, 3 * sizeof(double));
    hole->spacing = hewn_alloc_zero(count, sizeof(double));
    hole->position_capacity = hole->spacing_capacity = count;
    if (!hole->rim || !hole->normals || !hole->outer || !hole->outer_area || !hole->joined || !hole->positions ||
        !hole->spacing)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory filling a hole of %u edges", count);
    return HEWN_OK;
}

/* Positions about the box's centre, in units of its longest side. Halves first: the box may be wider than any double.
 */
static void place_vertices(const filler *f, hewn_hole *hole)
{
    double half = 0;
    for (int axis = 0; axis < 3; axis++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < hole->rim_count; i++) {
            double x = f->soup->positions[3 * (size_t)hole->rim[i] + axis];
            lo = fmin(lo, x);
            hi = fmax(hi, x);
        }
        hole->centre[axis] = lo / 2 + hi / 2;
        half = fmax(half, hi / 2 - lo / 2);
    }
    hole->size = half > 0x1p-1000 ? half : 1;
}

static void local_position(const filler *f, const hewn_hole *hole, uint32_t vertex, double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = f->soup->positions[3 * (size_t)vertex + axis] / hole->size - hole->centre[axis] / hole->size;
}

/* One edge of the mesh at rim vertex i. */
static void add_edge(const filler *f, hewn_hole *hole, uint32_t i, uint32_t other)
{
    double p[3], length = 0;
    local_position(f, hole, other, p);
    for (int axis = 0; axis < 3; axis++) {
        double difference = p[axis] - hole->positions[3 * (size_t)i + axis];
        length += difference * difference;
    }
    hole->spacing[i] += sqrt(length);
    if (f->place[other] != HEWN_NONE)
        hole->joined[(size_t)i * hole->rim_count + f->place[other]] = 1;
}

static uint32_t side_before(const filler *f, uint32_t side)
{
    uint32_t face = f->sides.faces[side];
    return side > f->soup->first[face] ? side - 1 : (uint32_t)f->soup->first[face + 1] - 1;
}

/* Walks the fan at rim vertex i, `side` being its open half-edge that leaves. A polygon stands for the triangle at its
 * corner. */
static void look_around(const filler *f, hewn_hole *hole, uint32_t i, uint32_t side)
{
    uint32_t count = 0;
    while (side != HEWN_NONE) {
        uint32_t before = side_before(f, side);
        uint32_t next = hewn_side_head(f->soup, &f->sides, side), last = hewn_side_tail(f->soup, before);
        double a[3], b[3];
        local_position(f, hole, next, a);
        local_position(f, hole, last, b);
        hole->outer_area[i] += hewn_hole_corner(hole->positions + 3 * (size_t)i, a, b, hole->outer + 3 * (size_t)i);
        add_edge(f, hole, i, next);
        count++;
        side = f->mates[before];
        if (side == HEWN_NONE)
            add_edge(f, hole, i, last);
    }
    hole->spacing[i] /= count + 1;
}

static void find_normal(const filler *f, uint32_t side, double out[3])
{
    hewn_soup_face_normal(f->soup, f->sides.faces[side], out);
    double most = fmax(fabs(out[0]), fmax(fabs(out[1]), fabs(out[2])));
    bool good = most > 0 && isfinite(most);
    double length = 0;
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = good ? out[axis] / most : 0;
        length += out[axis] * out[axis];
    }
    for (int axis = 0; axis < 3 && good; axis++)
        out[axis] /= sqrt(length);
}

/* The loop runs with its faces; the patch runs against them, so rim vertex i is the loop's vertex count - 1 - i, and
 * the half-edge from rim vertex i + 1 to i lies across rim edge i. `sides` holds the loop's half-edges. */
static void look_at_hole(filler *f, hewn_hole *hole, const uint32_t *sides)
{
    uint32_t count = hole->rim_count;
    for (uint32_t i = 0; i < count; i++) {
        hole->rim[i] = hewn_side_tail(f->soup, sides[count - 1 - i]);
        f->place[hole->rim[i]] = i;
    }
    place_vertices(f, hole);
    for (uint32_t i = 0; i < count; i++)
        local_position(f, hole, hole->rim[i], hole->positions + 3 * (size_t)i);
    for (uint32_t i = 0; i < count; i++) {
        look_around(f, hole, i, sides[count - 1 - i]);
        find_normal(f, sides[i + 1 < count ? count - 2 - i : count - 1], hole->normals + 3 * (size_t)i);
    }
    uint32_t face = f->sides.faces[sides[0]];
    hole->pillow = count == 3 && f->soup->first[face + 1] - f->soup->first[face] == 3 &&
                   f->sides.faces[sides[1]] == face && f->sides.faces[sides[2]] == face;
}

/* --- the patch into the soup -------------------------------------------------------------------------------------- */

static hewn_result take_patch(filler *f, const hewn_hole *hole, hewn_repair_report *report, hewn_error *error)
{
    uint32_t added = hole->vertex_count - hole->rim_count;
    HEWN_TRY(hewn_soup_reserve(f->soup, added, hole->face_count, 3 * (uint64_t)hole->face_count, error));
    uint32_t base = f->soup->vertex_count - hole->rim_count;
    for (uint32_t v = hole->rim_count; v < hole->vertex_count; v++) {
        double position[3];
        for (int axis = 0; axis < 3; axis++)
            position[axis] = hole->positions[3 * (size_t)v + axis] * hole->size + hole->centre[axis];
        hewn_soup_add_vertex(f->soup, position, HEWN_NONE);
    }
    for (uint32_t t = 0; t < hole->face_count; t++) {
        uint32_t corners[3];
        for (int k = 0; k < 3; k++) {
            uint32_t v = hole->faces[t].vertices[k];
            corners[k] = v < hole->rim_count ? hole->rim[v] : base + v;
        }
        hewn_soup_add_triangle(f->soup, corners[0], corners[1], corners[2]);
    }
    report->filled_holes++;
    report->filled_edges += hole->rim_count;
    report->added_faces += hole->face_count;
    report->added_vertices += added;
    return HEWN_OK;
}

/* New vertices may only land on finite positions. */
static bool is_sound(const hewn_hole *hole)
{
    for (size_t i = 0; i < 3 * (size_t)hole->vertex_count; i++)
        if (!isfinite(hole->positions[i] * hole->size + hole->centre[i % 3]))
            return false;
    return true;
}

static hewn_result fill_hole(filler *f, hewn_hole *hole, bool flat, hewn_repair_report *report, hewn_error *error)
{
    bool found;
    HEWN_TRY(hewn_hole_triangulate(hole, &found, error));
    if (found && !flat && hole->rim_count > PLAIN_EDGES) {
        HEWN_TRY(hewn_hole_refine(hole, error));
        HEWN_TRY(hewn_hole_fair(hole, error));
        if (!is_sound(hole)) {
            hole->vertex_count = hole->rim_count;
            HEWN_TRY(hewn_hole_triangulate(hole, &found, error));
        }
    }
    if (found)
        return take_patch(f, hole, report, error);
    report->kept_holes++;
    return HEWN_OK;
}

/* `side` is open and leaves the hole's first vertex; `loop` has room for `most` half-edges. */
static hewn_result visit_hole(filler *f, uint32_t start, uint32_t most, uint32_t *loop, bool flat, bool strict,
                              hewn_repair_report *report, hewn_error *error)
{
    uint32_t count = 0, side = start;
    for (; side != HEWN_NONE; count++) {
        uint32_t tail = hewn_side_tail(f->soup, side);
        if (count < most)
            loop[count] = side;
        f->leaving[tail] = HEWN_NONE;
        side = f->leaving[hewn_side_head(f->soup, &f->sides, side)];
    }
    if (count > most || count < 3)
        return HEWN_OK;
    if (strict)
        return hewn_fail(error, HEWN_BAD_INPUT, "a hole of %u edges lies at vertex %u", count,
                         f->soup->vertex_origins[hewn_side_tail(f->soup, start)]);
    hewn_hole hole;
    hewn_result result = create_hole(&hole, count, error);
    if (result == HEWN_OK) {
        look_at_hole(f, &hole, loop);
        result = fill_hole(f, &hole, flat, report, error);
        for (uint32_t i = 0; i < count; i++)
            f->place[hole.rim[i]] = HEWN_NONE;
    }
    free_hole(&hole);
    return result;
}

hewn_result hewn_soup_fill(hewn_soup *soup, uint32_t most_edges, bool flat, bool strict, const hewn_progress *progress,
                           hewn_repair_report *report, hewn_error *error)
{
    filler f;
    uint32_t vertices = soup->vertex_count, *loop = hewn_alloc(most_edges, sizeof *loop);
    hewn_result result = create_filler(soup, &f, error);
    if (result == HEWN_OK && !loop)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory looking for holes");
    for (uint32_t v = 0; result == HEWN_OK && v < vertices; v++) {
        if (f.leaving[v] == HEWN_NONE)
            continue;
        result = hewn_progress_report(progress, "repair", 0.5 + 0.5 * v / vertices, error);
        if (result == HEWN_OK)
            result = visit_hole(&f, f.leaving[v], most_edges, loop, flat, strict, report, error);
    }
    free_filler(&f);
    hewn_free(loop);
    return result;
}
