/* Compressed input: it unpacks within the limit or fails with a reason, and what comes out is read as its first byte
 * says. */
#include "base/alloc.h"
#include "fuzz_model.h"
#include "io/unpack.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { LIMIT = 1 << 18 };
    char *bytes;
    size_t length;
    hewn_error error = {0};
    hewn_result result = hewn_unpack((const char *)data, size, LIMIT, "fuzz", NULL, &bytes, &length, &error);
    if (result != HEWN_OK) {
        demand((result == HEWN_BAD_INPUT || result == HEWN_LIMIT) && error.code == result && !bytes && length == 0);
        return 0;
    }
    demand(length <= LIMIT && bytes[length] == '\0');
    if (length > 0 && bytes[0] == 'p')
        fuzz_model(hewn_ply_read, bytes, length, "ply");
    else if (length > 0 && bytes[0] == 's')
        fuzz_model(hewn_stl_read, bytes, length, "stl");
    else
        fuzz_model(hewn_obj_read, bytes, length, "obj");
    hewn_free(bytes);
    return 0;
}
