#include <string.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "base/error.h"
#include "simplify/samples.h"

/* Bits of a coordinate: of few points, and of more than there can be cells that a surface of that many goes through. */
enum { FEW_BITS = 10, AXIS_BITS = 14, FEW_POINTS = 1 << 17, DIGIT_BITS = 11 };

static int bits_of(uint32_t count)
{
    return count < FEW_POINTS ? FEW_BITS : AXIS_BITS;
}

/* --- the curve ---------------------------------------------------------------------------------------------------- */

/* Two zero bits between all bits of a number of AXIS_BITS. */
static HEWN_INTO_CLONES uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffu;
    x = (x | x << 16) & 0x1f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    return (x | x << 2) & 0x1249249249249249u;
}

/* Points whose places are found at a time. */
enum { MANY = 64 };

/* From coordinates, an array an axis, to those whose bits, one of each in turn, are the place along the curve (Skilling
 * 2004, 'Programming the Hilbert curve'). */
static HEWN_INTO_CLONES void transpose(uint32_t x[3][MANY], int bits)
{
    for (uint32_t bit = 1u << (bits - 1); bit > 1; bit >>= 1) {
        const uint32_t below = bit - 1;
        for (int axis = 0; axis < 3; axis++) /* turned over, or changed with the first */
            for (int i = 0; i < MANY; i++) {
                const uint32_t over = x[axis][i] & bit ? below : 0;
                const uint32_t swapped = (x[0][i] ^ x[axis][i]) & below & ~over;
                x[0][i] ^= over | swapped;
                x[axis][i] ^= swapped;
            }
    }
    for (int i = 0; i < MANY; i++) {
        x[1][i] ^= x[0][i];
        x[2][i] ^= x[1][i];
        uint32_t rest = x[2][i];
        for (int shift = 1; shift < 2 * AXIS_BITS;
             shift *= 2) /* of the bits above each, whether they are odd in number */
            rest ^= rest >> shift;
        rest = rest >> 1;
        for (int axis = 0; axis < 3; axis++)
            x[axis][i] ^= rest;
    }
}

/* Coordinates take half the width of the cube, so it can be moved by the other half. */
HEWN_CLONES static void find_keys(double at[3][MANY], const double shift[3], int bits, uint64_t key[MANY])
{
    const double most = (1 << bits) - 1;
    uint32_t x[3][MANY];
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < MANY; i++)
            x[axis][i] = (uint32_t)(int32_t)(((at[axis][i] + 1) / 4 + shift[axis] / 2) * most);
    transpose(x, bits);
    for (int i = 0; i < MANY; i++)
        key[i] = spread(x[0][i]) << 2 | spread(x[1][i]) << 1 | spread(x[2][i]);
}

typedef struct keyed {
    uint64_t key;
    uint32_t item; /* a vertex or a triangle */
} keyed;

/* Least digit first; equal keys keep their order. */
static keyed *sort_keys(keyed *from, keyed *to, uint32_t count)
{
    for (int digit = 0; digit * DIGIT_BITS < 3 * bits_of(count); digit++) {
        uint32_t places[1 << DIGIT_BITS] = {0}, sum = 0;
        const int shift = digit * DIGIT_BITS;
        const uint64_t mask = (1 << DIGIT_BITS) - 1;
        for (uint32_t i = 0; i < count; i++)
            places[from[i].key >> shift & mask]++;
        for (int d = 0; d < 1 << DIGIT_BITS; d++) {
            uint32_t here = places[d];
            places[d] = sum;
            sum += here;
        }
        for (uint32_t i = 0; i < count; i++)
            to[places[from[i].key >> shift & mask]++] = from[i];
        keyed *held = from;
        from = to;
        to = held;
    }
    return from;
}

/* Of items in order, `find` tells where each is. */
typedef void find_place(const void *context, uint32_t item, double out[3]);

static void key_items(keyed *items, uint32_t count, const double shift[3], find_place *find, const void *context)
{
    const int bits = bits_of(count);
#pragma omp parallel for schedule(static) if (count > SIMPLIFY_FEW)
    for (uint32_t begin = 0; begin < count; begin += MANY) {
        const uint32_t some = count - begin < MANY ? count - begin : MANY;
        double at[3][MANY] = {{0}}, place[3];
        uint64_t key[MANY];
        for (uint32_t i = 0; i < some; i++) {
            find(context, items[begin + i].item, place);
            for (int axis = 0; axis < 3; axis++)
                at[axis][i] = place[axis];
        }
        find_keys(at, shift, bits, key);
        for (uint32_t i = 0; i < some; i++)
            items[begin + i].key = key[i];
    }
}

static void find_vertex(const void *context, uint32_t v, double out[3])
{
    const simplify_work *work = context;
    memcpy(out, simplify_at(work, v), 3 * sizeof *out);
}

static void find_middle(const void *context, uint32_t t, double out[3])
{
    const hewn_triangle_view *triangles = context;
    const uint32_t *corner = triangles->corners + 3 * (size_t)t;
    for (size_t axis = 0; axis < 3; axis++)
        out[axis] = 0;
    for (size_t k = 0; k < 3; k++)
        for (size_t axis = 0; axis < 3; axis++)
            out[axis] += triangles->doubles[3 * (size_t)corner[k] + axis] / 3;
}

/* The vertices that are left, in order. */
static uint32_t *order_vertices(const simplify_work *work, uint32_t round, uint32_t *count)
{
    const double step = round * 0.61803398874989485;
    const double shift[3] = {fmod(step, 1), fmod(step + 0.33, 1), fmod(step + 0.67, 1)};
    keyed *keys = hewn_alloc(work->live_vertices, 2 * sizeof *keys);
    uint32_t *order = hewn_alloc(work->live_vertices, sizeof *order);
    *count = 0;
    if (keys && order) {
        for (uint32_t v = 0; v < work->vertex_count; v++)
            if (work->half[v] != SIMPLIFY_GONE)
                keys[(*count)++].item = v;
        key_items(keys, *count, shift, find_vertex, work);
        const keyed *sorted = sort_keys(keys, keys + *count, *count);
        for (uint32_t i = 0; i < *count; i++)
            order[i] = sorted[i].item;
    } else {
        hewn_free(order);
        order = NULL;
    }
    hewn_free(keys);
    return order;
}

uint32_t *hewn_simplify_along(const hewn_triangle_view *triangles)
{
    const double unmoved[3] = {0};
    const uint32_t count = (uint32_t)triangles->triangle_count;
    keyed *keys = hewn_alloc(count, 2 * sizeof *keys);
    uint32_t *order = hewn_alloc((size_t)count + 3, sizeof *order);
    if (keys && order) {
        for (uint32_t t = 0; t < count; t++)
            keys[t].item = t;
        key_items(keys, count, unmoved, find_middle, triangles);
        const keyed *sorted = sort_keys(keys, keys + count, count);
        for (uint32_t t = 0; t < count; t++)
            order[t] = sorted[t].item;
    } else {
        hewn_free(order);
        order = NULL;
    }
    hewn_free(keys);
    return order;
}

/* --- moving ------------------------------------------------------------------------------------------------------- */

/* Makes `*items` the items of `order`. */
static bool move(void **items, size_t size, const uint32_t *order, uint32_t count)
{
    if (!*items)
        return true;
    char *to = hewn_alloc(count, size);
    const char *from = *items;
    if (!to)
        return false;
#pragma omp parallel for schedule(static) if (count > SIMPLIFY_FEW)
    for (uint32_t i = 0; i < count; i++)
        memcpy(to + i * size, from + order[i] * size, size);
    hewn_free(*items);
    *items = to;
    return true;
}

/* Triangles by the first of their vertices; `number` is the new one of each vertex. */
static uint32_t *order_faces(const simplify_work *work, const uint32_t *number, uint32_t verts)
{
    uint32_t *places = hewn_alloc_zero((size_t)verts + 1, sizeof *places);
    uint32_t *order = hewn_alloc(work->live_faces, sizeof *order);
    uint32_t *least = hewn_alloc(work->face_count, sizeof *least);
    if (places && order && least) {
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
        for (uint32_t f = 0; f < work->face_count; f++) {
            const uint32_t *corner = work->tail + 3 * (size_t)f;
            least[f] = HEWN_NONE;
            for (int k = 0; k < 3 && corner[0] != HEWN_NONE; k++)
                least[f] = number[corner[k]] < least[f] ? number[corner[k]] : least[f];
        }
        for (uint32_t f = 0; f < work->face_count; f++)
            if (least[f] != HEWN_NONE)
                places[least[f] + 1]++;
        for (uint32_t v = 1; v <= verts; v++)
            places[v] += places[v - 1];
        for (uint32_t f = 0; f < work->face_count; f++)
            if (least[f] != HEWN_NONE)
                order[places[least[f]]++] = f;
    } else {
        hewn_free(order);
        order = NULL;
    }
    hewn_free(places);
    hewn_free(least);
    return order;
}

/* Half-edges by the order of faces; `number` is the new one of each vertex. */
static bool move_halves(simplify_work *work, const uint32_t *order, const uint32_t *number)
{
    const size_t count = 3 * (size_t)work->live_faces;
    uint32_t *place = hewn_alloc(work->face_count, sizeof *place), *tail = hewn_alloc(count, sizeof *tail);
    uint32_t *twin = hewn_alloc(count, sizeof *twin);
    float *key = work->key ? hewn_alloc(count, sizeof *key) : NULL;
    uint8_t *flags = work->flags ? hewn_alloc(count, sizeof *flags) : NULL;
    uint32_t *wedge = work->wedge ? hewn_alloc(count, sizeof *wedge) : NULL;
    bool done = place && tail && twin && (key || !work->key) && (flags || !work->flags) && (wedge || !work->wedge);
    for (uint32_t f = 0; done && f < work->live_faces; f++)
        place[order[f]] = f;
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t f = 0; f < (done ? work->live_faces : 0); f++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t h = 3 * f + k, old = 3 * order[f] + k, other = work->twin[old];
            const uint32_t name = simplify_name(work, old);
            tail[h] = number[work->tail[old]];
            twin[h] = other == HEWN_NONE ? HEWN_NONE : 3 * place[other / 3] + other % 3;
            if (key)
                key[h] = work->key[name];
            if (flags)
                flags[h] = work->flags[name];
            if (wedge)
                wedge[h] = work->wedge[old];
        }
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < (done ? work->vertex_count : 0); v++)
        if (work->half[v] != SIMPLIFY_GONE && work->rank[v] != SIMPLIFY_APART)
            work->half[v] = 3 * place[work->half[v] / 3] + work->half[v] % 3;
    if (done) {
        hewn_free(work->tail);
        hewn_free(work->twin);
        hewn_free(work->key);
        hewn_free(work->flags);
        hewn_free(work->wedge);
        work->tail = tail;
        work->twin = twin;
        work->key = key;
        work->flags = flags;
        work->wedge = wedge;
    } else {
        hewn_free(tail);
        hewn_free(twin);
        hewn_free(key);
        hewn_free(flags);
        hewn_free(wedge);
    }
    hewn_free(place);
    return done;
}

/* What fails in the middle leaves `work` good for being released only. */
hewn_result hewn_simplify_order(simplify_work *work, uint32_t round, hewn_error *error)
{
    uint32_t verts, *number = hewn_alloc(work->vertex_count, sizeof *number), *order_of_faces = NULL;
    uint32_t *order = order_vertices(work, round, &verts);
    bool done = number && order;
    for (uint32_t i = 0; done && i < verts; i++)
        number[order[i]] = i;
    order_of_faces = done ? order_faces(work, number, verts) : NULL;
    done = order_of_faces && move_halves(work, order_of_faces, number) &&
           move((void **)&work->face_origins, sizeof *work->face_origins, order_of_faces, work->live_faces) &&
           (!work->samples ||
            move((void **)&work->samples->first, sizeof *work->samples->first, order_of_faces, work->live_faces));
    hewn_free(order_of_faces);
    for (uint32_t v = 0; done && work->tie && v < work->vertex_count; v++)
        if (work->half[v] != SIMPLIFY_GONE)
            work->tie[v] = number[work->tie[v]];
    hewn_free(number);
    done = done && move((void **)&work->tie, sizeof *work->tie, order, verts) &&
           move((void **)&work->positions, 3 * sizeof *work->positions, order, verts) &&
           move((void **)&work->quadrics, sizeof *work->quadrics, order, verts) &&
           move((void **)&work->facing, 3 * sizeof *work->facing, order, verts) &&
           move((void **)&work->half, sizeof *work->half, order, verts) &&
           move((void **)&work->rank, sizeof *work->rank, order, verts) &&
           move((void **)&work->origins, sizeof *work->origins, order, verts) &&
           move((void **)&work->limit, sizeof *work->limit, order, verts);
    hewn_free(order);
    work->vertex_count = verts;
    work->face_count = work->live_faces;
    return done ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
}
