/* Stanford PLY, binary little-endian. */
#include "base/error.h"
#include "base/text.h"
#include "io/bytes.h"
#include "io/shim/number.h"
#include "io/stream.h"

static char *put_vector(const float *vector, char *to)
{
    for (int axis = 0; axis < 3; axis++)
        to = hewn_put_float(to, vector[axis]);
    return to;
}

static char *put_vertex(const hewn_mesh_writing *job, uint64_t v, char *to)
{
    to = put_vector(job->mesh->positions + 3 * v, to);
    return job->mesh->normals ? put_vector(job->mesh->normals + 3 * v, to) : to;
}

static char *put_face(const hewn_mesh_writing *job, uint64_t t, char *to)
{
    *to++ = 3;
    for (int k = 0; k < 3; k++)
        to = hewn_put_u32(to, job->mesh->indices[3 * t + k]);
    return to;
}

static hewn_result fits(const hewn_triangles *mesh, hewn_error *error)
{
    if (mesh->vertex_count > (uint64_t)INT32_MAX + 1)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices are more than a PLY file's int indices can name",
                         (unsigned long long)mesh->vertex_count);
    return HEWN_OK;
}

static hewn_result prepare(hewn_mesh_writing *job, hewn_error *error)
{
    const hewn_triangles *mesh = job->mesh;
    hewn_text head = {0};
    char metres[HEWN_NUMBER_ROOM];
    *hewn_number_print_float(metres, (float)job->metres_per_unit) = '\0';
    hewn_text_print(&head, "ply\nformat binary_little_endian 1.0\ncomment Hewn %s\ncomment 1 unit = %s m, %s up\n",
                    hewn_version(), metres, hewn_axis_name(job->up));
    hewn_text_print(&head, "comment object %s\n", job->name);
    hewn_text_print(&head, "element vertex %llu\nproperty float x\nproperty float y\nproperty float z\n",
                    (unsigned long long)mesh->vertex_count);
    if (mesh->normals)
        hewn_text_append(&head, "property float nx\nproperty float ny\nproperty float nz\n");
    hewn_text_print(&head, "element face %llu\nproperty list uchar int vertex_indices\nend_header\n",
                    (unsigned long long)mesh->triangle_count);
    job->head = head.bytes;
    job->head_length = head.length;
    return hewn_text_status(&head, error);
}

static hewn_result write(const hewn_mesh_writing *job, hewn_output *output, hewn_error *error)
{
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    hewn_stream vertices = {put_vertex, job->mesh->vertex_count, 24, 0, 0.5};
    HEWN_TRY(hewn_stream_write(job, &vertices, output, error));
    hewn_stream faces = {put_face, job->mesh->triangle_count, 13, 0.5, 0.5};
    return hewn_stream_write(job, &faces, output, error);
}

const hewn_mesh_writer hewn_ply_writer = {fits, prepare, write};
