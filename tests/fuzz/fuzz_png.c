/* Grey pictures as heights: whatever the bytes are, reading them gives finite values from 0 to 1, or an error and
 * nothing. */
#include <stdlib.h>
#include <string.h>

#include "io/heights_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(bool holds)
{
    if (!holds)
        abort();
}

/* The size that a header tells, if it does. */
static uint64_t pixels_of(const uint8_t *data, size_t size)
{
    uint64_t sides[2] = {0, 0};
    for (size_t i = 0; size >= 24 && i < 8; i++)
        sides[i / 4] = sides[i / 4] << 8 | data[16 + i];
    return sides[0] * sides[1];
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { PIXELS = 1 << 20 };
    hewn_heightmap map;
    hewn_error error = {0};
    if (pixels_of(data, size) > PIXELS && pixels_of(data, size) <= HEWN_HEIGHTS_MOST)
        return 0; /* right, but slow */
    hewn_result result = hewn_png_read((const char *)data, size, "fuzz", &map, &error);
    if (result != HEWN_OK) {
        demand(!map.values && map.columns == 0 && error.code == result && error.message[0] != '\0');
        demand(result == HEWN_BAD_INPUT || result == HEWN_LIMIT || result == HEWN_OUT_OF_MEMORY);
        return 0;
    }
    for (uint64_t i = 0; i < (uint64_t)map.columns * map.rows; i++)
        demand(map.values[i] >= 0 && map.values[i] <= 1);
    demand(hewn_heightmap_check(&map, "fuzz", &error) == (map.columns < 2 || map.rows < 2 ? HEWN_BAD_INPUT : HEWN_OK));
    hewn_heightmap_destroy(&map);
    return 0;
}
