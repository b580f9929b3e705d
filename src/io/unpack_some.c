/* Packed parts of files whose length unpacked is known, by zlib or bzip2. */
#define ZLIB_CONST
#include <bzlib.h>
#include <zlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/unpack.h"

enum { FIRST_ROOM = 1 << 16, STEP = 1 << 24 }; /* bytes; so much comes out between two looks at the progress callback */

typedef struct stream {
    hewn_packing packing;
    z_stream zlib;
    bz_stream bzip2;
} stream;

/* What a step of either library has come to. */
typedef enum step_result { STEP_GOES_ON, STEP_ENDS, STEP_DAMAGED, STEP_OUT_OF_MEMORY } step_result;

static void *zlib_alloc(void *user, unsigned count, unsigned size)
{
    (void)user;
    return hewn_alloc(count, size);
}

static void *bzip2_alloc(void *user, int count, int size)
{
    (void)user;
    return hewn_alloc((size_t)count, (size_t)size);
}

static void free_either(void *user, void *block)
{
    (void)user;
    hewn_free(block);
}

static bool begin(stream *job)
{
    if (job->packing == HEWN_PACKING_BZIP2) {
        job->bzip2.bzalloc = bzip2_alloc;
        job->bzip2.bzfree = free_either;
        return BZ2_bzDecompressInit(&job->bzip2, 0, 0) == BZ_OK;
    }
    job->zlib.zalloc = zlib_alloc;
    job->zlib.zfree = free_either;
    return inflateInit2(&job->zlib, 32 + MAX_WBITS) == Z_OK;
}

static void finish(stream *job)
{
    if (job->packing == HEWN_PACKING_BZIP2)
        BZ2_bzDecompressEnd(&job->bzip2);
    else
        inflateEnd(&job->zlib);
}

/* Takes in up to `*in` bytes and gives out up to `*out`; both are then what was taken and given. */
static step_result advance(stream *job, const char *from, unsigned *in, char *to, unsigned *out)
{
    if (job->packing == HEWN_PACKING_BZIP2) {
        job->bzip2.next_in = (char *)(uintptr_t)from; /* it only reads there */
        job->bzip2.avail_in = *in;
        job->bzip2.next_out = to;
        job->bzip2.avail_out = *out;
        int status = BZ2_bzDecompress(&job->bzip2);
        *in -= job->bzip2.avail_in;
        *out -= job->bzip2.avail_out;
        return status == BZ_OK           ? STEP_GOES_ON
               : status == BZ_STREAM_END ? STEP_ENDS
               : status == BZ_MEM_ERROR  ? STEP_OUT_OF_MEMORY
                                         : STEP_DAMAGED;
    }
    job->zlib.next_in = (const Bytef *)from;
    job->zlib.avail_in = *in;
    job->zlib.next_out = (Bytef *)to;
    job->zlib.avail_out = *out;
    int status = inflate(&job->zlib, Z_NO_FLUSH);
    *in -= job->zlib.avail_in;
    *out -= job->zlib.avail_out;
    return status == Z_OK || status == Z_BUF_ERROR ? STEP_GOES_ON
           : status == Z_STREAM_END                ? STEP_ENDS
           : status == Z_MEM_ERROR                 ? STEP_OUT_OF_MEMORY
                                                   : STEP_DAMAGED;
}

/* Room for more, doubled, but not past what is wanted. */
static bool grow(char **block, size_t *room, size_t made, size_t wanted)
{
    if (made < *room)
        return true;
    size_t larger = *room < FIRST_ROOM ? FIRST_ROOM : *room > wanted / 2 ? wanted : 2 * *room;
    larger = larger > wanted ? wanted : larger;
    char *moved = hewn_realloc(*block, larger, 1);
    if (!moved)
        return false;
    *block = moved;
    *room = larger;
    return true;
}

/* All that is wanted is there; goes on to the checksum at the stream's end. */
static hewn_result check_end(stream *job, const char *bytes, size_t length, size_t at, const char *name,
                             hewn_error *error)
{
    for (;;) {
        char more;
        unsigned in = length - at < STEP ? (unsigned)(length - at) : STEP, given = 1;
        step_result step = advance(job, bytes + at, &in, &more, &given);
        at += in;
        if (given > 0)
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the compressed data hold more than the header tells");
        if (step == STEP_ENDS)
            return HEWN_OK;
        if (step != STEP_GOES_ON)
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the compressed data are damaged");
        if (in == 0)
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the compressed data end early");
    }
}

static hewn_result unpack(stream *job, const char *bytes, size_t length, size_t wanted, const char *name,
                          const hewn_progress *progress, char **out, size_t *made, hewn_error *error)
{
    size_t at = 0, room = 0;
    for (bool ends = false; !ends && *made < wanted;) {
        if (!grow(out, &room, *made, wanted))
            return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, name, 0, "out of memory unpacking more than %zu bytes",
                                *made);
        unsigned in = length - at < STEP ? (unsigned)(length - at) : STEP;
        unsigned given = room - *made < STEP ? (unsigned)(room - *made) : STEP;
        step_result step = advance(job, bytes + at, &in, *out + *made, &given);
        at += in;
        *made += given;
        ends = step == STEP_ENDS;
        if (step == STEP_OUT_OF_MEMORY)
            return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, name, 0, "out of memory unpacking");
        if (step == STEP_DAMAGED)
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the compressed data are damaged");
        if (!ends && in == 0 && given == 0)
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the compressed data end early");
        HEWN_TRY(hewn_progress_report(progress, "load", (double)*made / (double)wanted, error));
        if (!ends && *made == wanted)
            return check_end(job, bytes, length, at, name, error);
    }
    return HEWN_OK;
}

hewn_result hewn_unpack_some(const char *bytes, size_t length, hewn_packing packing, size_t wanted, const char *name,
                             const hewn_progress *progress, char **out, size_t *out_length, hewn_error *error)
{
    stream job = {.packing = packing};
    char *block = NULL;
    size_t made = 0;
    *out = NULL;
    *out_length = 0;
    if (!begin(&job))
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, name, 0, "out of memory unpacking");
    hewn_result result = unpack(&job, bytes, length, wanted, name, progress, &block, &made, error);
    finish(&job);
    if (result == HEWN_OK && !block && !(block = hewn_alloc(1, 1)))
        result = hewn_fail_at(error, HEWN_OUT_OF_MEMORY, name, 0, "out of memory unpacking");
    if (result == HEWN_OK) {
        *out = block;
        *out_length = made;
    } else {
        hewn_free(block);
    }
    return result;
}
