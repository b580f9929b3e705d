/* STL from memory. */
#include "fuzz_model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_model(hewn_stl_read, data, size, "stl");
    return 0;
}
