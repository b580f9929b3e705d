/* Borders by the nonzero rule: of random polygons that cross themselves and each other, against winding numbers and
 * distances by brute force. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "font/font.h"

static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* How often polygons wind around a point: by angles, which shares nothing with the code. */
static long winding_at(const hewn_grid_sides *sides, double x, double y)
{
    double sum = 0;
    for (size_t i = 0; i < sides->count; i++) {
        const hewn_grid_side *s = &sides->items[i];
        double ax = (double)s->a.x - x, ay = (double)s->a.y - y, bx = (double)s->b.x - x, by = (double)s->b.y - y;
        sum += (double)s->winding * atan2(ax * by - ay * bx, ax * bx + ay * by);
    }
    return lround(sum / (2 * acos(-1)));
}

static double distance_to(const hewn_grid_sides *sides, double x, double y)
{
    double least = INFINITY;
    for (size_t i = 0; i < sides->count; i++) {
        const hewn_grid_side *s = &sides->items[i];
        double ex = (double)(s->b.x - s->a.x), ey = (double)(s->b.y - s->a.y);
        double dx = x - (double)s->a.x, dy = y - (double)s->a.y;
        double t = fmin(fmax((dx * ex + dy * ey) / (ex * ex + ey * ey), 0), 1);
        least = fmin(least, hypot(dx - t * ex, dy - t * ey));
    }
    return least;
}

static hewn_grid_sides copy_of(const hewn_grid_sides *from)
{
    hewn_grid_sides out = {0};
    for (size_t i = 0; i < from->count; i++)
        assert_int_equal(hewn_grid_add(&out, from->items[i].a, from->items[i].b, NULL), HEWN_OK);
    return out;
}

static void random_polygons(uint64_t *random, int64_t size, hewn_grid_sides *out)
{
    unsigned polygons = 1 + (unsigned)(next_random(random) % 3);
    for (unsigned p = 0; p < polygons; p++) {
        unsigned corners = 3 + (unsigned)(next_random(random) % 12);
        hewn_grid_point first = {0, 0}, last = {0, 0};
        for (unsigned i = 0; i <= corners; i++) {
            hewn_grid_point next = {(int64_t)(next_random(random) % (uint64_t)size),
                                    (int64_t)(next_random(random) % (uint64_t)size)};
            if (i > 0)
                assert_int_equal(hewn_grid_add(out, last, i < corners ? next : first, NULL), HEWN_OK);
            else
                first = next;
            last = next;
        }
    }
}

/* Ends alone meet, as many sides leave each point as come in, and no two are the same. */
static void check_borders(const hewn_grid_sides *borders)
{
    for (size_t i = 0; i < borders->count; i++) {
        int balance = 0;
        const hewn_grid_side *one = &borders->items[i];
        for (size_t k = 0; k < borders->count; k++) {
            const hewn_grid_side *other = &borders->items[k];
            balance += hewn_grid_same(other->a, one->a);
            balance -= hewn_grid_same(other->b, one->a);
            if (k == i)
                continue;
            assert_false(hewn_grid_same(one->a, other->a) && hewn_grid_same(one->b, other->b));
            assert_false(hewn_grid_same(one->a, other->b) && hewn_grid_same(one->b, other->a));
            int64_t a = hewn_grid_turn(other->a, other->b, one->a), b = hewn_grid_turn(other->a, other->b, one->b);
            int64_t c = hewn_grid_turn(one->a, one->b, other->a), d = hewn_grid_turn(one->a, one->b, other->b);
            assert_false(((a < 0 && b > 0) || (a > 0 && b < 0)) && ((c < 0 && d > 0) || (c > 0 && d < 0)));
        }
        assert_int_equal(balance, 0);
    }
}

/* Snapping moves sides by a few steps: points nearer to a side than that are left out. */
static void check_inside(const hewn_grid_sides *given, const hewn_grid_sides *borders, uint64_t *random, int64_t size)
{
    for (int i = 0; i < 100; i++) {
        double x = (double)(next_random(random) % (uint64_t)(1000 * size)) / 1000;
        double y = (double)(next_random(random) % (uint64_t)(1000 * size)) / 1000;
        if (distance_to(given, x, y) < 3)
            continue;
        long winding = winding_at(borders, x, y);
        assert_true(winding == 0 || winding == 1);
        assert_int_equal(winding, winding_at(given, x, y) != 0);
    }
}

static void random_polygons_keep_their_inside(void **state)
{
    (void)state;
    static const int64_t sizes[] = {6, 40, 5000, HEWN_GRID_MOST};
    uint64_t random = 77;
    int rounds = getenv("HEWN_LONG") ? 20000 : 400;
    for (int round = 0; round < rounds; round++) {
        int64_t size = sizes[round % 4];
        hewn_grid_sides given = {0};
        random_polygons(&random, size, &given);
        hewn_grid_sides borders = copy_of(&given);
        assert_int_equal(hewn_grid_nonzero(&borders, 5000, NULL), HEWN_OK);
        check_borders(&borders);
        check_inside(&given, &borders, &random, size);
        hewn_grid_sides_clear(&given);
        hewn_grid_sides_clear(&borders);
    }
}

/* Every side is on one loop, and each loop is closed. */
static void loops_have_every_side_once(void **state)
{
    (void)state;
    uint64_t random = 5;
    for (int round = 0; round < 100; round++) {
        hewn_grid_sides sides = {0};
        hewn_grid_loops loops;
        random_polygons(&random, round % 2 ? 8 : 3000, &sides);
        assert_int_equal(hewn_grid_nonzero(&sides, 5000, NULL), HEWN_OK);
        assert_int_equal(hewn_grid_loops_create(&sides, &loops, NULL), HEWN_OK);
        assert_int_equal(loops.point_count, sides.count);
        size_t found = 0, first = 0;
        for (size_t i = 0; i < loops.count; first += loops.counts[i++]) {
            assert_true(loops.counts[i] >= 3);
            for (size_t k = 0; k < loops.counts[i]; k++)
                for (size_t s = 0; s < sides.count; s++)
                    found += hewn_grid_same(sides.items[s].a, loops.points[first + k]) &&
                             hewn_grid_same(sides.items[s].b, loops.points[first + (k + 1) % loops.counts[i]]);
        }
        assert_int_equal(found, sides.count);
        hewn_grid_loops_destroy(&loops);
        hewn_grid_sides_clear(&sides);
    }
}

static void limits_are_errors(void **state)
{
    (void)state;
    hewn_error error = {0};
    hewn_grid_sides sides = {0};
    uint64_t random = 3;
    assert_int_equal(hewn_grid_add(&sides, (hewn_grid_point){0, 0}, (hewn_grid_point){HEWN_GRID_MOST, 0}, &error),
                     HEWN_LIMIT);
    for (int i = 0; i < 20; i++)
        random_polygons(&random, 100000, &sides);
    assert_int_equal(hewn_grid_nonzero(&sides, 100, &error), HEWN_LIMIT);
    hewn_grid_sides_clear(&sides);
    assert_int_equal(hewn_grid_nonzero(&sides, 100, NULL), HEWN_OK);
    assert_int_equal(sides.count, 0);
    hewn_grid_sides_clear(&sides);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_polygons_keep_their_inside),
        cmocka_unit_test(loops_have_every_side_once),
        cmocka_unit_test(limits_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
