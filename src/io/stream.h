/* Writing many small things, by all threads and in their order, with progress. */
#ifndef HEWN_SRC_IO_STREAM_H
#define HEWN_SRC_IO_STREAM_H

#include "io/formats.h"

/* Puts item `index` at `to` and returns its end. Several threads call it at once. */
typedef char *(*hewn_put_item)(const hewn_writing *job, uint64_t index, char *to);

typedef struct hewn_stream {
    hewn_put_item put;
    uint64_t count;
    size_t room;                                                /* the most bytes that an item takes, */
    size_t (*room_of)(const hewn_writing *job, uint64_t index); /* or where this is not NULL, that item */
    double begin, span;                                         /* its share of the whole work, for progress */
    char *(*put_run)(const hewn_writing *job, uint64_t begin, uint64_t end, char *to); /* NULL, or many at once */
} hewn_stream;

/* Writes all items. HEWN_IO, HEWN_CANCELLED, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_stream_write(const hewn_writing *job, const hewn_stream *stream, hewn_output *output,
                              hewn_error *error);

/* Most bytes of face `index` in a list: `head` for itself and `corner` for each corner. */
static inline size_t hewn_writing_face_room(const hewn_writing *job, uint64_t face, size_t head, size_t corner)
{
    return head + (size_t)(hewn_writing_first(job, face + 1) - hewn_writing_first(job, face)) * corner;
}

#endif
