/* Shared by the tests of the check: soups that are built corner by corner. */
#ifndef HEWN_TEST_CHECK_SUPPORT_H
#define HEWN_TEST_CHECK_SUPPORT_H

#include "hewn/check.h"
#include "test_mesh_support.h"

enum { SOUP_VERTICES = 4096, SOUP_FACES = 8192, SOUP_CORNERS = 32768 };

typedef struct soup {
    uint64_t vertices, faces;
    double positions[3 * SOUP_VERTICES];
    uint64_t first[SOUP_FACES + 1];
    uint32_t corners[SOUP_CORNERS];
} soup;

static inline soup *make_soup(void)
{
    soup *made = calloc(1, sizeof *made);
    assert_non_null(made);
    return made;
}

static inline uint32_t add_point(soup *to, double x, double y, double z)
{
    assert_true(to->vertices < SOUP_VERTICES);
    double *p = to->positions + 3 * to->vertices;
    p[0] = x;
    p[1] = y;
    p[2] = z;
    return (uint32_t)to->vertices++;
}

static inline void add_polygon(soup *to, const uint32_t *corners, uint32_t count)
{
    uint64_t begin = to->first[to->faces];
    assert_true(to->faces < SOUP_FACES && begin + count <= SOUP_CORNERS);
    for (uint32_t i = 0; i < count; i++)
        to->corners[begin + i] = corners[i];
    to->first[++to->faces] = begin + count;
}

static inline void add_quad(soup *to, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    add_polygon(to, (uint32_t[]){a, b, c, d}, 4);
}

static inline void add_triangle(soup *to, uint32_t a, uint32_t b, uint32_t c)
{
    add_polygon(to, (uint32_t[]){a, b, c}, 3);
}

/* A cube of quads from `at` to at + size in all three axes, turned inside out where size is below 0. */
static inline void add_cube(soup *to, double x, double y, double z, double size)
{
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    uint32_t base = (uint32_t)to->vertices;
    for (uint32_t v = 0; v < 8; v++)
        add_point(to, x + (v & 1) * size, y + (v >> 1 & 1) * size, z + (v >> 2 & 1) * size);
    for (int f = 0; f < 6; f++)
        add_quad(to, base + quads[f][0], base + quads[f][1], base + quads[f][2], base + quads[f][3]);
}

/* n × m quads in two rounds around x, y, z; `twist` quads' corners are exchanged where the first round closes, which
 * makes a Klein bottle by its connections (its positions do not matter then). */
static inline void add_torus(soup *to, uint32_t n, uint32_t m, double x, bool klein)
{
    uint32_t base = (uint32_t)to->vertices;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m, radius = 1 + 0.3 * cos(v);
            add_point(to, x + radius * cos(u), radius * sin(u), 0.3 * sin(v));
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            uint32_t k = (j + 1) % m, at = (i + 1) % n * m, turn = klein && i + 1 == n;
            uint32_t far_j = turn ? (m - j) % m : j, far_k = turn ? (m - k) % m : k;
            add_quad(to, base + i * m + j, base + at + far_j, base + at + far_k, base + i * m + k);
        }
}

/* A strip of n quads that closes upon itself, after a half turn if `twisted`. */
static inline void add_band(soup *to, uint32_t n, bool twisted)
{
    uint32_t base = (uint32_t)to->vertices;
    for (uint32_t i = 0; i < n; i++) {
        double u = 2 * M_PI * i / n, turn = twisted ? u / 2 : 0;
        for (int side = -1; side <= 1; side += 2)
            add_point(to, (3 + side * cos(turn)) * cos(u), (3 + side * cos(turn)) * sin(u), side * sin(turn));
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = base + 2 * i, b = a + 1, last = i + 1 == n, flip = last && twisted;
        uint32_t c = last ? base : a + 2, d = c + 1;
        add_quad(to, a, flip ? d : c, flip ? c : d, b);
    }
}

static inline hewn_polygons polygons_of(const soup *of)
{
    return (hewn_polygons){of->vertices, of->positions, of->faces, of->first, of->corners};
}

static inline hewn_check *check_soup(const soup *of, const hewn_check_desc *desc)
{
    hewn_polygons polygons = polygons_of(of);
    hewn_check *check = NULL;
    hewn_error error = {0};
    if (hewn_check_polygons(&polygons, desc, &check, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    assert_non_null(check);
    return check;
}

/* Checks and frees the soup. */
static inline hewn_check *take_soup(soup *of)
{
    hewn_check *check = check_soup(of, NULL);
    free(of);
    return check;
}

/* Renumbers vertices, reorders faces, and turns their corners on; with `reverse` also reverses all faces. */
static inline soup *shuffle_soup(const soup *of, bool reverse, random_state *random)
{
    soup *out = make_soup();
    uint32_t *number = calloc(of->vertices + 1, sizeof *number), *order = calloc(of->faces + 1, sizeof *order);
    assert_true(number && order);
    for (uint32_t v = 0; v < of->vertices; v++) {
        uint32_t other = random_below(random, v + 1);
        number[v] = number[other];
        number[other] = v;
    }
    for (uint32_t f = 0; f < of->faces; f++) {
        uint32_t other = random_below(random, f + 1);
        order[f] = order[other];
        order[other] = f;
    }
    out->vertices = of->vertices;
    for (uint64_t v = 0; v < of->vertices; v++)
        memcpy(out->positions + 3 * (size_t)number[v], of->positions + 3 * v, 3 * sizeof(double));
    for (uint64_t f = 0; f < of->faces; f++) {
        uint64_t begin = of->first[order[f]];
        uint32_t length = (uint32_t)(of->first[order[f] + 1] - begin), corners[256] = {0};
        assert_true(length <= 256);
        uint32_t turn = length > 0 ? random_below(random, length) : 0;
        for (uint32_t i = 0; i < length; i++) {
            uint32_t at = (i + turn) % length;
            corners[reverse ? length - 1 - i : i] = number[of->corners[begin + at]];
        }
        add_polygon(out, corners, length);
    }
    free(number);
    free(order);
    return out;
}

#endif
