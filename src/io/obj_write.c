/* Wavefront OBJ: v, vn and f a//a (or f a), numbers as short as they read back exactly. */
#include "base/error.h"
#include "base/text.h"
#include "io/shim/number.h"
#include "io/stream.h"

enum { VERTEX_ROOM = 4 + 3 * HEWN_NUMBER_ROOM, FACE_ROOM = 4 + 6 * HEWN_NUMBER_ROOM };

static char *put_vector(const float *vector, char *to)
{
    for (int axis = 0; axis < 3; axis++) {
        *to++ = ' ';
        to = hewn_number_print_float(to, vector[axis]);
    }
    *to++ = '\n';
    return to;
}

static char *put_position(const hewn_mesh_writing *job, uint64_t v, char *to)
{
    *to++ = 'v';
    return put_vector(job->mesh->positions + 3 * v, to);
}

static char *put_normal(const hewn_mesh_writing *job, uint64_t v, char *to)
{
    *to++ = 'v';
    *to++ = 'n';
    return put_vector(job->mesh->normals + 3 * v, to);
}

static char *put_face(const hewn_mesh_writing *job, uint64_t t, char *to)
{
    *to++ = 'f';
    for (int k = 0; k < 3; k++) {
        uint64_t number = (uint64_t)job->mesh->indices[3 * t + k] + 1;
        *to++ = ' ';
        to = hewn_number_print_unsigned(to, number);
        if (job->mesh->normals) {
            *to++ = '/';
            *to++ = '/';
            to = hewn_number_print_unsigned(to, number);
        }
    }
    *to++ = '\n';
    return to;
}

static hewn_result prepare(hewn_mesh_writing *job, hewn_error *error)
{
    hewn_text head = {0};
    char metres[HEWN_NUMBER_ROOM];
    *hewn_number_print_float(metres, (float)job->metres_per_unit) = '\0';
    hewn_text_print(&head, "# Hewn %s\n# 1 unit = %s m, %s up\no %s\n", hewn_version(), metres, hewn_axis_name(job->up),
                    job->name);
    job->head = head.bytes;
    job->head_length = head.length;
    return hewn_text_status(&head, error);
}

static hewn_result write(const hewn_mesh_writing *job, hewn_output *output, hewn_error *error)
{
    uint64_t vertices = job->mesh->vertex_count;
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    hewn_stream positions = {put_position, vertices, VERTEX_ROOM, 0, 0.3};
    HEWN_TRY(hewn_stream_write(job, &positions, output, error));
    hewn_stream normals = {put_normal, job->mesh->normals ? vertices : 0, VERTEX_ROOM, 0.3, 0.3};
    HEWN_TRY(hewn_stream_write(job, &normals, output, error));
    hewn_stream faces = {put_face, job->mesh->triangle_count, FACE_ROOM, 0.6, 0.4};
    return hewn_stream_write(job, &faces, output, error);
}

const hewn_mesh_writer hewn_obj_writer = {NULL, prepare, write};
