/* PLY from memory. */
#include "fuzz_model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_model(hewn_ply_read, data, size, "ply");
    return 0;
}
