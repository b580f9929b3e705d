/* Lists of records in one scratch file, which grow at their ends and are read from their beginnings. A list lies in
 * blocks, wherever there is room; blocks of what was read for good are used again, so the file is no longer than all
 * lists together once were. */
#ifndef HEWN_SRC_OUTCORE_CHAINS_H
#define HEWN_SRC_OUTCORE_CHAINS_H

#include "base/scratch.h"

/* One list. Zero is empty, and takes memory from its first record on: a block while it is added to, and 4 bytes for
 * each block in the file. */
typedef struct hewn_chain {
    uint64_t count;   /* records */
    uint32_t *blocks; /* of the file, in order */
    size_t block_count, block_room;
    char *tail; /* what waits to fill a block; or NULL */
    size_t tail_count;
} hewn_chain;

/* The file of many lists. */
typedef struct hewn_chains {
    hewn_scratch *file;
    size_t size, each;    /* bytes of a record, records of a block */
    uint32_t block_count; /* of the file */
    uint32_t *spare;      /* blocks that hold nothing */
    size_t spare_count, spare_room;
    char *block; /* of the reader */
} hewn_chains;

/* Beside `output`, for records of `size` bytes. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_chains_open(const char *output, size_t size, hewn_chains *out, hewn_error *error);
void hewn_chains_close(hewn_chains *chains);

/* Bytes of memory that a list takes while it is added to. */
size_t hewn_chains_block_bytes(const hewn_chains *chains);

/* Bytes that the file has taken on disk. */
uint64_t hewn_chains_file_bytes(const hewn_chains *chains);

/* Adds a record. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_chain_add(hewn_chains *chains, hewn_chain *chain, const void *record, hewn_error *error);

/* Writes what waits and gives its memory back: nothing is added any more. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_chain_settle(hewn_chains *chains, hewn_chain *chain, hewn_error *error);

/* What is done with records, in the order in which they were added. */
typedef hewn_result (*hewn_chain_take)(void *user, const void *record, hewn_error *error);

/* Hands out all records of a settled list. `consume`: each block is spare as soon as it was handed out, and in the end
 * the list is empty; also after a failure, when the rest is lost. One list is read at a time, but others may be added
 * to meanwhile. HEWN_IO, and what `take` returns. */
hewn_result hewn_chain_read(hewn_chains *chains, hewn_chain *chain, bool consume, hewn_chain_take take, void *user,
                            hewn_error *error);

/* Frees a list's memory; its blocks are lost to the file. */
void hewn_chain_free(hewn_chain *chain);

#endif
