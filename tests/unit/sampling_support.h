/* Samplings made up for tests: a bumpy ball, with bricks that are coarse at random where the ball's side is far. */
#ifndef HEWN_TEST_SAMPLING_SUPPORT_H
#define HEWN_TEST_SAMPLING_SUPPORT_H

#include "test_field_support.h"

#include "field/sampling.h"

/* Above 0 at the sides of the lattice. */
static inline double sampled_ball(const double at[3], double radius)
{
    double length = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    double bumps = sin(0.9 * at[0]) * sin(0.8 * at[1]) * sin(0.7 * at[2] + 0.3);
    return length - radius + bumps * fmin(1, fabs(radius) / 4);
}

static inline hewn_sampling *random_sampling(random_state *random, uint32_t most_bricks)
{
    hewn_sampling_shape shape = {0};
    uint32_t bricks[3];
    size_t count = 1;
    uint32_t least = UINT32_MAX;
    for (int i = 0; i < 3; i++) {
        bricks[i] = 2 + random_below(random, most_bricks - 1);
        shape.cells[i] = 8 * bricks[i];
        least = shape.cells[i] < least ? shape.cells[i] : least;
        count *= bricks[i];
    }
    double radius = 0.5 * least - 3;
    uint8_t *fine = malloc(count);
    assert_non_null(fine);
    shape.fine = fine;
    for (uint32_t b = 0; b < count; b++) {
        const uint32_t at[3] = {b % bricks[0], b / bricks[0] % bricks[1], b / (bricks[0] * bricks[1])};
        double middle[3];
        for (int i = 0; i < 3; i++)
            middle[i] = 8.0 * at[i] + 4 - 0.5 * shape.cells[i];
        fine[b] = fabs(sampled_ball(middle, radius)) < 9 || random_below(random, 4) == 0;
    }
    hewn_sampling *made;
    hewn_error error = {0};
    if (hewn_sampling_begin(&shape, &made, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    float *corners = hewn_sampling_corners(made);
    for (uint32_t z = 0; z <= bricks[2]; z++)
        for (uint32_t y = 0; y <= bricks[1]; y++)
            for (uint32_t x = 0; x <= bricks[0]; x++) {
                const double at[3] = {8.0 * x - 0.5 * shape.cells[0], 8.0 * y - 0.5 * shape.cells[1],
                                      8.0 * z - 0.5 * shape.cells[2]};
                *corners++ = (float)sampled_ball(at, radius);
            }
    for (uint32_t b = 0; b < count; b++) {
        float *samples = hewn_sampling_brick(made, b);
        assert_true((samples != NULL) == (fine[b] != 0));
        for (uint32_t k = 0; samples && k < 729; k++) {
            const uint32_t from[3] = {b % bricks[0], b / bricks[0] % bricks[1], b / (bricks[0] * bricks[1])};
            const uint32_t in[3] = {k % 9, k / 9 % 9, k / 81};
            double at[3];
            for (int i = 0; i < 3; i++)
                at[i] = 8.0 * from[i] + in[i] - 0.5 * shape.cells[i];
            samples[k] = (float)sampled_ball(at, radius);
        }
    }
    free(fine);
    hewn_sampling_finish(made);
    return made;
}

static inline hewn_sampling *random_heights(random_state *random, uint32_t columns, uint32_t rows)
{
    float *values = malloc(sizeof *values * columns * rows);
    assert_non_null(values);
    for (uint32_t i = 0; i < columns * rows; i++)
        values[i] = (float)random_between(random, -1, 1);
    hewn_sampling *made;
    hewn_error error = {0};
    if (hewn_sampling_from_heights(values, columns, rows, &made, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    free(values);
    return made;
}

#endif
