#include "io/stream.h"

#include "base/alloc.h"
#include "base/progress.h"

static hewn_result write_block(const hewn_mesh_writing *job, const hewn_stream *stream, uint64_t first, char *room,
                               hewn_output *output, hewn_error *error)
{
    uint64_t end = stream->count - first < HEWN_WRITE_BLOCK ? stream->count : first + HEWN_WRITE_BLOCK;
    char *at = room;
    for (uint64_t i = first; i < end; i++)
        at = stream->put(job, i, at);
    HEWN_TRY(hewn_output_write(output, room, (size_t)(at - room), error));
    double fraction = stream->begin + stream->span * (double)end / (double)stream->count;
    return hewn_progress_report(job->progress, "write", fraction, error);
}

hewn_result hewn_stream_write(const hewn_mesh_writing *job, const hewn_stream *stream, hewn_output *output,
                              hewn_error *error)
{
    char *room = hewn_alloc(HEWN_WRITE_BLOCK, stream->room);
    if (!room)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    hewn_result result = HEWN_OK;
    for (uint64_t first = 0; first < stream->count && result == HEWN_OK; first += HEWN_WRITE_BLOCK)
        result = write_block(job, stream, first, room, output, error);
    hewn_free(room);
    return result;
}
