/* OpenVDB's grids from memory. */
#include "fuzz_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_volume(hewn_vdb_read, "hewn_vdb", data, size);
    return 0;
}
