/* OpenVDB's grids from memory, dense or in blocks, and meshes of these. */
#include <math.h>

#include "fuzz_volume.h"
#include "hewn/volume_extract.h"

static hewn_result pass_over(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    uint64_t *triangles = user;
    (void)error;
    *triangles += part->triangles[0].count + part->triangles[1].count;
    return HEWN_OK;
}

/* Slices are not bounded by the file, only by the memory that their counts take. */
static void demand_meshable(const hewn_volume *volume, const hewn_volume_range *range)
{
    enum { SLICES = 1 << 12 };
    if (range->finite_count == 0 || volume->dims[2] > SLICES)
        return;
    const double middle = range->lo / 2 + range->hi / 2;
    for (int n = 0; n < 4; n++) {
        uint64_t triangles = 0;
        const hewn_mesh_sink sink = {.user = &triangles, .take = pass_over};
        const hewn_volume_extract_desc desc = {.method = n & 1 ? HEWN_METHOD_MARCHING_CUBES : HEWN_METHOD_MC33,
                                               .iso = isfinite(middle) ? middle : 0,
                                               .inside = n & 2 ? HEWN_INSIDE_BELOW : HEWN_INSIDE_ABOVE,
                                               .open = n == 1,
                                               .max_memory = volume->memory_length + ((uint64_t)1 << 23)};
        hewn_volume_extract_stats stats;
        hewn_error error = {0};
        hewn_result result = hewn_volume_extract_parts(volume, &desc, &sink, &stats, &error);
        demand(result == HEWN_OK ? triangles > 0 && triangles == stats.triangles : error.message[0] != '\0');
        demand(result == HEWN_OK || result == HEWN_BAD_INPUT || result == HEWN_LIMIT || result == HEWN_OUT_OF_MEMORY);
    }
}

/* A process for each: so by the bytes, for some only. */
static void fuzz_blocks(const uint8_t *data, size_t size)
{
    static const hewn_volume_read_desc desc = {.memory_limit = 1 << 24, .blocks = true};
    uint32_t sum = 7;
    for (size_t i = 0; i < size; i++)
        sum = 31 * sum + data[i];
    if (sum % 32 != 0)
        return;
    hewn_volume_source source = {.bytes = (const char *)data, .length = size, .name = "fuzz", .desc = &desc};
    hewn_volume volume;
    hewn_error error = {0};
    if (hewn_vdb_read(&source, &volume, &error) == HEWN_OK) {
        hewn_volume_range range = hewn_volume_find_range(&volume, 0);
        demand(volume.blocks && !volume.samples && hewn_volume_check(&volume, NULL) == HEWN_OK);
        demand(range.finite_count + range.nan_count + range.infinite_count == hewn_volume_frame_size(&volume));
        demand_meshable(&volume, &range);
    } else {
        demand(error.message[0] != '\0');
    }
    hewn_volume_destroy(&volume);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_volume(hewn_vdb_read, true, data, size);
    fuzz_blocks(data, size);
    return 0;
}
