/* OpenVDB's grids from memory, dense or in blocks. */
#include "fuzz_volume.h"

/* A process for each: so by the bytes, for some only. */
static void fuzz_blocks(const uint8_t *data, size_t size)
{
    static const hewn_volume_read_desc desc = {.memory_limit = 1 << 24, .blocks = true};
    uint32_t sum = 7;
    for (size_t i = 0; i < size; i++)
        sum = 31 * sum + data[i];
    if (sum % 8 != 0)
        return;
    hewn_volume_source source = {.bytes = (const char *)data, .length = size, .name = "fuzz", .desc = &desc};
    hewn_volume volume;
    hewn_error error = {0};
    if (hewn_vdb_read(&source, &volume, &error) == HEWN_OK) {
        hewn_volume_range range = hewn_volume_find_range(&volume, 0);
        demand(volume.blocks && !volume.samples && hewn_volume_check(&volume, NULL) == HEWN_OK);
        demand(range.finite_count + range.nan_count + range.infinite_count == hewn_volume_frame_size(&volume));
    } else {
        demand(error.message[0] != '\0');
    }
    hewn_volume_destroy(&volume);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_volume(hewn_vdb_read, "hewn_vdb", data, size);
    fuzz_blocks(data, size);
    return 0;
}
