#include "io/stream.h"

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

enum { ROOM = 1 << 17 };

typedef struct buffer {
    char *bytes, *at, *end;
} buffer;

static hewn_result flush(buffer *to, hewn_output *output, hewn_error *error)
{
    HEWN_TRY(hewn_output_write(output, to->bytes, (size_t)(to->at - to->bytes), error));
    to->at = to->bytes;
    return HEWN_OK;
}

/* Empties the buffer where the next item might not fit, and makes it larger where it never would. */
static hewn_result make_room(buffer *to, size_t needed, hewn_output *output, hewn_error *error)
{
    if ((size_t)(to->end - to->at) >= needed)
        return HEWN_OK;
    HEWN_TRY(flush(to, output, error));
    if ((size_t)(to->end - to->bytes) >= needed)
        return HEWN_OK;
    char *larger = hewn_realloc(to->bytes, needed, 1);
    if (!larger)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    *to = (buffer){larger, larger, larger + needed};
    return HEWN_OK;
}

static hewn_result put_items(const hewn_writing *job, const hewn_stream *stream, buffer *to, hewn_output *output,
                             hewn_error *error)
{
    for (uint64_t i = 0; i < stream->count; i++) {
        HEWN_TRY(make_room(to, stream->room_of ? stream->room_of(job, i) : stream->room, output, error));
        to->at = stream->put(job, i, to->at);
        if ((i + 1) % HEWN_WRITE_BLOCK == 0) {
            double fraction = stream->begin + stream->span * (double)(i + 1) / (double)stream->count;
            HEWN_TRY(hewn_progress_report(job->progress, "write", fraction, error));
        }
    }
    HEWN_TRY(flush(to, output, error));
    return hewn_progress_report(job->progress, "write", stream->begin + stream->span, error);
}

hewn_result hewn_stream_write(const hewn_writing *job, const hewn_stream *stream, hewn_output *output,
                              hewn_error *error)
{
    if (stream->count == 0)
        return HEWN_OK;
    char *bytes = hewn_alloc(ROOM, 1);
    if (!bytes)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    buffer to = {bytes, bytes, bytes + ROOM};
    hewn_result result = put_items(job, stream, &to, output, error);
    hewn_free(to.bytes);
    return result;
}
