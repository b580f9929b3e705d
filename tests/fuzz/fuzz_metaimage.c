/* MetaImage from memory. */
#include "fuzz_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_volume(hewn_metaimage_read, false, data, size);
    return 0;
}
