/* Geomview's OFF as text, with the prefixes ST, C and N where vertices have texture coordinates, colours and normals.
 *
 * Numbers are as short as they read back exactly: positions of a model as doubles, those of triangle buffers as floats.
 * Colours of bytes are whole numbers up to 255; others always have a point, so that they are not taken for bytes. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/remark.h"
#include "io/shim/number.h"
#include "io/stream.h"

enum {
    NUMBER_ROOM = 3 + HEWN_NUMBER_ROOM,
    VERTEX_ROOM = 2 + 12 * NUMBER_ROOM,
    FACE_ROOM = 2 + 5 * NUMBER_ROOM,
    CORNER_ROOM = 1 + HEWN_NUMBER_ROOM
};

typedef struct off_own {
    const hewn_channel *normals, *colors, *uvs, *face_colors;
} off_own;

static char *put_number(const hewn_channel *channel, double value, char *to)
{
    *to++ = ' ';
    return channel->info.scalar == HEWN_SCALAR_DOUBLE ? hewn_number_print_double(to, value)
                                                      : hewn_number_print_float(to, (float)value);
}

static char *put_vector(const hewn_channel *channel, uint64_t index, char *to)
{
    for (uint32_t k = 0; channel && k < channel->info.components; k++)
        to = put_number(channel, hewn_channel_number(channel, index, k), to);
    return to;
}

static char *put_color(const hewn_channel *channel, uint64_t index, char *to)
{
    for (uint32_t k = 0; channel && k < channel->info.components; k++) {
        const char *begin = to;
        to = put_number(channel, hewn_channel_number(channel, index, k), to);
        size_t length = (size_t)(to - begin);
        if (channel->info.scalar != HEWN_SCALAR_UINT8 && !memchr(begin, '.', length) && !memchr(begin, 'e', length)) {
            *to++ = '.';
            *to++ = '0';
        }
    }
    return to;
}

static char *put_vertex(const hewn_writing *job, uint64_t v, char *to)
{
    const off_own *own = job->own;
    for (int axis = 0; axis < 3; axis++) {
        if (axis > 0)
            *to++ = ' ';
        to = job->floats ? hewn_number_print_float(to, job->floats[3 * v + axis])
                         : hewn_number_print_double(to, job->doubles[3 * v + axis]);
    }
    to = put_vector(own->normals, v, to);
    to = put_color(own->colors, v, to);
    to = put_vector(own->uvs, v, to);
    *to++ = '\n';
    return to;
}

static char *put_face(const hewn_writing *job, uint64_t face, char *to)
{
    const off_own *own = job->own;
    uint64_t begin = hewn_writing_first(job, face), end = hewn_writing_first(job, face + 1);
    to = hewn_number_print_unsigned(to, end - begin);
    for (uint64_t corner = begin; corner < end; corner++) {
        *to++ = ' ';
        to = hewn_number_print_unsigned(to, job->corners[corner]);
    }
    to = put_color(own->face_colors, face, to);
    *to++ = '\n';
    return to;
}

static size_t face_room(const hewn_writing *job, uint64_t face)
{
    return hewn_writing_face_room(job, face, FACE_ROOM, CORNER_ROOM);
}

static const hewn_channel *find_channel(const hewn_writing *job, hewn_domain domain, const char *name, uint32_t least,
                                        uint32_t most)
{
    const hewn_channel *channel = hewn_writing_channel(job, domain, name);
    return channel && channel->info.components >= least && channel->info.components <= most ? channel : NULL;
}

static hewn_result prepare(hewn_writing *job, hewn_error *error)
{
    off_own *own = hewn_alloc_zero(1, sizeof *own);
    if (!own)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    job->own = own;
    own->normals = find_channel(job, HEWN_DOMAIN_VERT, "normal", 3, 3);
    own->colors = find_channel(job, HEWN_DOMAIN_VERT, "color", 3, 4);
    own->uvs = find_channel(job, HEWN_DOMAIN_VERT, "uv", 2, 2);
    own->face_colors = find_channel(job, HEWN_DOMAIN_FACE, "color", 3, 4);
    hewn_text head = {0};
    hewn_text_print(&head, "%s%s%sOFF\n# Hewn %s\n# ", own->uvs ? "ST" : "", own->colors ? "C" : "",
                    own->normals ? "N" : "", hewn_version());
    hewn_remark_print(&head, job->unit, job->up_known ? &job->up : NULL, job->space);
    hewn_text_print(&head, "\n%llu %llu 0\n", (unsigned long long)job->vertex_count,
                    (unsigned long long)job->face_count);
    job->head = head.bytes;
    job->head_length = head.length;
    return hewn_text_status(&head, error);
}

static hewn_result write(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    hewn_stream vertices = {put_vertex, job->vertex_count, VERTEX_ROOM, NULL, 0, 0.5, NULL};
    HEWN_TRY(hewn_stream_write(job, &vertices, output, error));
    hewn_stream faces = {put_face, job->face_count, 0, face_room, 0.5, 0.5, NULL};
    return hewn_stream_write(job, &faces, output, error);
}

static void release(hewn_writing *job)
{
    hewn_free(job->own);
    job->own = NULL;
}

const hewn_format_writer hewn_off_writer = {.to_stdout = true, .prepare = prepare, .write = write, .release = release};
