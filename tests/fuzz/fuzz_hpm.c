/* Progressive meshes from memory. The checksums of mutated blocks are made right first, or nothing would get past them;
 * every other input comes as it is. */
#include <zlib.h>

#include "fuzz_model.h"
#include "progressive/block.h"

static void put_sum(unsigned char *to, uint32_t sum)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(sum >> (8 * i) & 0xff);
}

static void mend_checksums(unsigned char *bytes, size_t size)
{
    for (size_t at = PROGRESSIVE_START; size - at >= PROGRESSIVE_BLOCK_HEAD + PROGRESSIVE_BLOCK_TAIL && at < size;) {
        uint64_t length = 0;
        for (size_t i = 0; i < 8; i++)
            length |= (uint64_t)bytes[at + 4 + i] << (8 * i);
        if (length > size - at - PROGRESSIVE_BLOCK_HEAD - PROGRESSIVE_BLOCK_TAIL)
            return;
        const size_t end = at + PROGRESSIVE_BLOCK_HEAD + (size_t)length;
        put_sum(bytes + end, (uint32_t)crc32_z(0, bytes + at, end - at));
        at = end + PROGRESSIVE_BLOCK_TAIL;
    }
}

/* Meshes on the way are valid models, and so are geomorphs. */
static void demand_parts(const hewn_progressive *from)
{
    const hewn_progressive_info info = hewn_progressive_about(from);
    for (int i = 0; i <= 4; i++) {
        hewn_model model;
        uint32_t *ancestors;
        const uint64_t splits = info.splits_there * (uint64_t)i / 4;
        demand(hewn_progressive_model(from, splits, &model, NULL) == HEWN_OK);
        demand(hewn_model_check(&model, NULL) == HEWN_OK);
        hewn_model_destroy(&model);
        demand(hewn_progressive_geomorph(from, splits / 2, splits, &model, &ancestors, NULL) == HEWN_OK);
        for (uint64_t v = 0; v < model.vertex_count; v++)
            demand(ancestors[v] < info.base_vertices + splits / 2);
        hewn_progressive_ancestors_free(ancestors);
        hewn_model_destroy(&model);
    }
}

/* What was read is written as the same again, but that numbers may have been written longer than they need. */
static void demand_rewritable(const hewn_progressive *from)
{
    char *bytes, *again;
    size_t length, again_length;
    hewn_progressive *read;
    demand(hewn_progressive_encode(from, &bytes, &length, NULL) == HEWN_OK);
    demand(hewn_progressive_decode(bytes, length, "fuzz", true, &read, NULL) == HEWN_OK);
    demand(hewn_progressive_encode(read, &again, &again_length, NULL) == HEWN_OK);
    demand(length == again_length);
    demand_same_bytes(bytes, again, length);
    hewn_progressive_bytes_free(bytes);
    hewn_progressive_bytes_free(again);
    hewn_progressive_destroy(&read);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    unsigned char *bytes = malloc(size + 1);
    hewn_progressive *read = NULL;
    hewn_error error = {0};
    demand(bytes != NULL);
    memcpy(bytes, data, size);
    if (is_chosen(data, size))
        fuzz_model(hewn_hpm_read, data, size, "ply");
    if (size > PROGRESSIVE_START)
        mend_checksums(bytes, size);
    const hewn_result result = hewn_progressive_decode((const char *)bytes, size, "fuzz", true, &read, &error);
    demand(result == HEWN_OK || result == HEWN_BAD_INPUT || result == HEWN_LIMIT);
    demand((result == HEWN_OK) == (read != NULL));
    demand(result == HEWN_OK || error.message[0] != '\0');
    if (read) {
        demand_parts(read);
        demand_rewritable(read);
    }
    hewn_progressive_destroy(&read);
    free(bytes);
    return 0;
}
