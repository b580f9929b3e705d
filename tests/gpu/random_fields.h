/* Fields of which many cells are ambiguous: values at whole coordinates that are as good as random, and shapes that
 * meet at random. */
#ifndef HEWN_TESTS_RANDOM_FIELDS_H
#define HEWN_TESTS_RANDOM_FIELDS_H

#include <math.h>

#include "../oracle/random_grid.h"
#include "hewn/hewn.h"

typedef hewn_node maker(hewn_field *field, uint32_t seed);

static inline hewn_node scaled(hewn_field *field, hewn_node a, double by)
{
    return hewn_mul(field, a, hewn_constant(field, by));
}

static inline hewn_node make_waves(hewn_field *field, uint32_t seed)
{
    hewn_node sum = hewn_constant(field, seed);
    sum = hewn_add(field, sum, scaled(field, hewn_x(field), 419.4));
    sum = hewn_add(field, sum, scaled(field, hewn_y(field), 1028.7));
    sum = hewn_add(field, sum, scaled(field, hewn_z(field), 246.6));
    sum = hewn_add(field, sum, scaled(field, hewn_mul(field, hewn_x(field), hewn_y(field)), 31.7));
    return hewn_sin(field, sum);
}

/* Whole numbers from -3 to 3: many values, face saddles and body saddles are exactly 0. */
static inline hewn_node make_integers(hewn_field *field, uint32_t seed)
{
    hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field);
    hewn_node sum = hewn_constant(field, seed);
    sum = hewn_add(field, sum, scaled(field, hewn_mul(field, x, x), 13));
    sum = hewn_add(field, sum, scaled(field, hewn_mul(field, y, y), 29));
    sum = hewn_add(field, sum, scaled(field, hewn_mul(field, z, z), 7));
    sum = hewn_add(field, sum, scaled(field, hewn_mul(field, x, y), 5));
    sum = hewn_add(field, sum, scaled(field, hewn_mul(field, y, z), 11));
    hewn_node hash = hewn_mod(field, sum, hewn_constant(field, 101));
    hash = hewn_add(field, scaled(field, hewn_mul(field, hash, hash), 3), hewn_mul(field, x, z));
    return hewn_sub(field, hewn_mod(field, hash, hewn_constant(field, 7)), hewn_constant(field, 3));
}

/* Spheres and boxes here and there, joined and cut at random, in a box of side 2. */
static inline hewn_node make_tree(hewn_field *field, uint32_t seed)
{
    uint64_t random = seed + 1000;
    hewn_node tree = HEWN_NODE_NONE;
    for (uint32_t i = 0; i < 14; i++) {
        double size = 0.1 + 0.2 * fabs(random_value(&random, RANDOM_UNIFORM));
        hewn_node part =
            random_below(&random, 2) ? hewn_sphere(field, size) : hewn_box_shape(field, size, 2 * size, size + 0.1);
        double turn = 6 * random_value(&random, RANDOM_UNIFORM);
        part = hewn_rotate(field, part, 1, 0.3, 0.2, turn);
        double at[3];
        for (int axis = 0; axis < 3; axis++)
            at[axis] = 0.8 * random_value(&random, RANDOM_UNIFORM);
        part = hewn_translate(field, part, at[0], at[1], at[2]);
        if (i == 0)
            tree = part;
        else
            tree = random_below(&random, 4) ? hewn_union(field, tree, part) : hewn_difference(field, tree, part);
    }
    return tree;
}

#endif
