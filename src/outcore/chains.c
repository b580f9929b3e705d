#include "outcore/chains.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { BLOCK = 1 << 14 }; /* bytes, about */

static hewn_result out_of_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for lists on disk");
}

size_t hewn_chains_block_bytes(const hewn_chains *chains)
{
    return chains->each * chains->size;
}

uint64_t hewn_chains_file_bytes(const hewn_chains *chains)
{
    return (uint64_t)chains->block_count * hewn_chains_block_bytes(chains);
}

hewn_result hewn_chains_open(const char *output, size_t size, hewn_chains *out, hewn_error *error)
{
    *out = (hewn_chains){.size = size, .each = size < BLOCK ? BLOCK / size : 1};
    out->block = hewn_alloc(out->each, size);
    hewn_result result = out->block ? hewn_scratch_create(output, &out->file, error) : out_of_memory(error);
    if (result != HEWN_OK)
        hewn_chains_close(out);
    return result;
}

void hewn_chains_close(hewn_chains *chains)
{
    hewn_scratch_destroy(&chains->file);
    hewn_free(chains->spare);
    hewn_free(chains->block);
    *chains = (hewn_chains){0};
}

void hewn_chain_free(hewn_chain *chain)
{
    hewn_free(chain->blocks);
    hewn_free(chain->tail);
    *chain = (hewn_chain){0};
}

static hewn_result take_block(hewn_chains *chains, uint32_t *block, hewn_error *error)
{
    if (chains->spare_count > 0) {
        *block = chains->spare[--chains->spare_count];
        return HEWN_OK;
    }
    if (chains->block_count == UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "temporary files of more than 2^32 blocks are not possible");
    *block = chains->block_count++;
    return HEWN_OK;
}

static hewn_result write_tail(hewn_chains *chains, hewn_chain *chain, hewn_error *error)
{
    void *items = chain->blocks;
    uint32_t block = 0;
    HEWN_TRY(hewn_reserve(&items, &chain->block_room, chain->block_count + 1, sizeof *chain->blocks, error));
    chain->blocks = items;
    HEWN_TRY(take_block(chains, &block, error));
    const size_t length = chain->tail_count * chains->size;
    HEWN_TRY(hewn_scratch_write(chains->file, chain->tail, length, (uint64_t)block * hewn_chains_block_bytes(chains),
                                error));
    chain->blocks[chain->block_count++] = block;
    chain->tail_count = 0;
    return HEWN_OK;
}

hewn_result hewn_chain_add(hewn_chains *chains, hewn_chain *chain, const void *record, hewn_error *error)
{
    if (!chain->tail) {
        chain->tail = hewn_alloc(chains->each, chains->size);
        if (!chain->tail)
            return out_of_memory(error);
    }
    memcpy(chain->tail + chain->tail_count * chains->size, record, chains->size);
    chain->count++;
    return ++chain->tail_count == chains->each ? write_tail(chains, chain, error) : HEWN_OK;
}

hewn_result hewn_chain_settle(hewn_chains *chains, hewn_chain *chain, hewn_error *error)
{
    if (chain->tail_count > 0)
        HEWN_TRY(write_tail(chains, chain, error));
    hewn_free(chain->tail);
    chain->tail = NULL;
    return HEWN_OK;
}

static hewn_result give_block(hewn_chains *chains, uint32_t block, hewn_error *error)
{
    void *items = chains->spare;
    HEWN_TRY(hewn_reserve(&items, &chains->spare_room, chains->spare_count + 1, sizeof *chains->spare, error));
    chains->spare = items;
    chains->spare[chains->spare_count++] = block;
    return HEWN_OK;
}

hewn_result hewn_chain_read(hewn_chains *chains, hewn_chain *chain, bool consume, hewn_chain_take take, void *user,
                            hewn_error *error)
{
    uint64_t left = chain->count;
    hewn_result result = HEWN_OK;
    for (size_t i = 0; result == HEWN_OK && i < chain->block_count; i++) {
        const size_t count = left < chains->each ? (size_t)left : chains->each;
        const uint64_t place = (uint64_t)chain->blocks[i] * hewn_chains_block_bytes(chains);
        result = hewn_scratch_read(chains->file, chains->block, count * chains->size, place, error);
        if (result == HEWN_OK && consume)
            result = give_block(chains, chain->blocks[i], error);
        for (size_t k = 0; result == HEWN_OK && k < count; k++)
            result = take(user, chains->block + k * chains->size, error);
        left -= count;
    }
    if (consume)
        hewn_chain_free(chain);
    return result;
}
