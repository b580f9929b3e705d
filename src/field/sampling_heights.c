#include <math.h>

#include "base/error.h"
#include "field/sampling.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE };

static hewn_result check(const float *values, uint32_t columns, uint32_t rows, hewn_error *error)
{
    if (!values || columns < 2 || rows < 2)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "heights need at least 2 x 2 values, not %u x %u", columns,
                         rows);
    for (uint64_t i = 0; i < (uint64_t)columns * rows; i++)
        if (!isfinite(values[i]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the height in column %u of row %u is no finite number",
                             (unsigned)(i % columns), (unsigned)(i / columns));
    return HEWN_OK;
}

/* Bricks that reach past the last row or column repeat it; nothing is ever looked up there. */
static void fill(hewn_sampling *made, uint64_t brick, const float *values, uint32_t columns, uint32_t rows)
{
    float *samples = hewn_sampling_brick(made, brick);
    uint64_t from_x = BRICK * (brick % made->bricks[0]), from_y = BRICK * (brick / made->bricks[0]);
    for (uint64_t y = 0; y < SIDE; y++)
        for (uint64_t x = 0; x < SIDE; x++) {
            uint64_t column = from_x + x < columns ? from_x + x : columns - 1;
            uint64_t row = from_y + y < rows ? from_y + y : rows - 1;
            samples[x + SIDE * y] = values[column + columns * row];
        }
}

hewn_result hewn_sampling_from_heights(const float *values, uint32_t columns, uint32_t rows, hewn_sampling **out,
                                       hewn_error *error)
{
    if (!out)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_sampling_from_heights: no place for the sampling");
    *out = NULL;
    HEWN_TRY(check(values, columns, rows, error));
    const hewn_sampling_shape shape = {.cells = {columns - 1, rows - 1, 0}, .endless = true};
    hewn_sampling *made;
    HEWN_TRY(hewn_sampling_begin(&shape, &made, error));
    for (uint64_t brick = 0; brick < made->fine_count; brick++)
        fill(made, brick, values, columns, rows);
    hewn_sampling_finish(made);
    *out = made;
    return HEWN_OK;
}
