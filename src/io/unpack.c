#include "io/unpack.h"

#define ZLIB_CONST
#include <zlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

enum { FIRST_ROOM = 1 << 16, STEP = 1 << 24 }; /* bytes; so much comes out between two looks at the progress callback */

typedef struct unpacking {
    z_stream stream;
    const char *name;
    const hewn_progress *progress;
    const char *bytes;
    size_t length, at; /* at: what has been taken in */
    char *out;
    size_t room, made; /* of `out`; a byte more is there for a NUL */
    size_t limit;
} unpacking;

static void *zlib_alloc(void *user, unsigned count, unsigned size)
{
    (void)user;
    return hewn_alloc(count, size);
}

static void zlib_free(void *user, void *block)
{
    (void)user;
    hewn_free(block);
}

bool hewn_is_packed(const char *bytes, size_t length)
{
    return length >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}

/* Room for one byte past the limit is enough to see that the limit is passed. */
static hewn_result grow(unpacking *job, hewn_error *error)
{
    if (job->made < job->room)
        return HEWN_OK;
    size_t room = job->room < FIRST_ROOM ? FIRST_ROOM : job->room > job->limit / 2 ? job->limit + 1 : 2 * job->room;
    if (room > job->limit)
        room = job->limit + 1;
    char *larger = hewn_realloc(job->out, room + 1, 1);
    if (!larger)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory unpacking more than %zu bytes",
                            job->made);
    job->out = larger;
    job->room = room;
    return HEWN_OK;
}

/* Takes in and gives out some; `*ends` where a member's end is reached. */
static hewn_result advance(unpacking *job, bool *ends, hewn_error *error)
{
    size_t left = job->length - job->at, space = job->room - job->made;
    unsigned given = left < STEP ? (unsigned)left : STEP, taken = space < STEP ? (unsigned)space : STEP;
    job->stream.next_in = (const Bytef *)job->bytes + job->at;
    job->stream.avail_in = given;
    job->stream.next_out = (Bytef *)job->out + job->made;
    job->stream.avail_out = taken;
    int status = inflate(&job->stream, Z_NO_FLUSH);
    job->at += given - job->stream.avail_in;
    job->made += taken - job->stream.avail_out;
    *ends = status == Z_STREAM_END;
    if (job->made > job->limit)
        return hewn_fail_at(error, HEWN_LIMIT, job->name, 0, "unpacked it is larger than the limit of %zu bytes",
                            job->limit);
    if (status == Z_MEM_ERROR)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory unpacking");
    if (status == Z_BUF_ERROR && given == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, job->name, 0, "the compressed data end early");
    if (status != Z_OK && status != Z_BUF_ERROR && !*ends)
        return hewn_fail_at(error, HEWN_BAD_INPUT, job->name, 0, "the compressed data are damaged: %s",
                            job->stream.msg ? job->stream.msg : "a preset dictionary is wanted");
    return hewn_progress_report(job->progress, "load", (double)job->at / (double)job->length, error);
}

static hewn_result unpack_member(unpacking *job, hewn_error *error)
{
    if (inflateInit2(&job->stream, 16 + MAX_WBITS) != Z_OK)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory unpacking");
    hewn_result result = HEWN_OK;
    for (bool ends = false; result == HEWN_OK && !ends;) {
        result = grow(job, error);
        if (result == HEWN_OK)
            result = advance(job, &ends, error);
    }
    inflateEnd(&job->stream);
    return result;
}

static hewn_result check_tail(const unpacking *job, hewn_error *error)
{
    for (size_t i = job->at; i < job->length; i++)
        if (job->bytes[i] != 0)
            return hewn_fail_at(error, HEWN_BAD_INPUT, job->name, 0,
                                "after the compressed data, at byte %zu, something else follows", i);
    return HEWN_OK;
}

static void finish(unpacking *job, char **out, size_t *out_length)
{
    char *smaller = job->out ? hewn_realloc(job->out, job->made + 1, 1) : hewn_alloc(1, 1);
    *out = smaller ? smaller : job->out;
    *out_length = job->made;
    if (*out)
        (*out)[job->made] = '\0';
}

hewn_result hewn_unpack(const char *bytes, size_t length, uint64_t limit, const char *name,
                        const hewn_progress *progress, char **out, size_t *out_length, hewn_error *error)
{
    *out = NULL;
    *out_length = 0;
    unpacking job = {.name = name, .progress = progress, .bytes = bytes, .length = length};
    job.limit = limit < SIZE_MAX / 4 ? (size_t)limit : SIZE_MAX / 4;
    job.stream.zalloc = zlib_alloc;
    job.stream.zfree = zlib_free;
    hewn_result result = HEWN_OK;
    while (result == HEWN_OK && hewn_is_packed(bytes + job.at, length - job.at))
        result = unpack_member(&job, error);
    if (result == HEWN_OK)
        result = check_tail(&job, error);
    if (result == HEWN_OK)
        finish(&job, out, out_length);
    else
        hewn_free(job.out);
    return result;
}
