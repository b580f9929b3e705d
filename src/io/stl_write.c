/* STL, binary: facets with their own corners and a normal each. */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/text.h"
#include "io/bytes.h"
#include "io/shim/number.h"
#include "io/stream.h"

enum { HEADER = 80, FACET = 50 };

/* Of length 1, or 0 for a facet without area. */
static void facet_normal(const float *a, const float *b, const float *c, float out[3])
{
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = length > 0 ? (float)(n[axis] / length) : 0.0f;
}

static char *put_vector(const float *vector, char *to)
{
    for (int axis = 0; axis < 3; axis++)
        to = hewn_put_float(to, vector[axis]);
    return to;
}

static char *put_facet(const hewn_mesh_writing *job, uint64_t t, char *to)
{
    const uint32_t *corner = job->mesh->indices + 3 * t;
    const float *positions = job->mesh->positions;
    const float *a = positions + 3 * (uint64_t)corner[0];
    const float *b = positions + 3 * (uint64_t)corner[1];
    const float *c = positions + 3 * (uint64_t)corner[2];
    float normal[3];
    facet_normal(a, b, c, normal);
    to = put_vector(normal, to);
    to = put_vector(a, to);
    to = put_vector(b, to);
    to = put_vector(c, to);
    return hewn_put_u16(to, 0);
}

static hewn_result fits(const hewn_triangles *mesh, hewn_error *error)
{
    if (mesh->triangle_count > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu triangles are more than the 4294967295 that an STL file can hold",
                         (unsigned long long)mesh->triangle_count);
    return HEWN_OK;
}

/* The header's text must not begin with "solid", by which readers know the text form. */
static hewn_result prepare(hewn_mesh_writing *job, hewn_error *error)
{
    char metres[HEWN_NUMBER_ROOM], count[4];
    *hewn_number_print_float(metres, (float)job->metres_per_unit) = '\0';
    hewn_text head = {0};
    hewn_text_print(&head, "binary STL, Hewn %s, 1 unit = %s m, %s up", hewn_version(), metres,
                    hewn_axis_name(job->up));
    while (head.length < HEADER && !head.failed)
        hewn_text_append_bytes(&head, "\0", 1);
    if (!head.failed)
        head.length = HEADER;
    hewn_put_u32(count, (uint32_t)job->mesh->triangle_count);
    hewn_text_append_bytes(&head, count, sizeof count);
    job->head = head.bytes;
    job->head_length = head.length;
    return hewn_text_status(&head, error);
}

static hewn_result write(const hewn_mesh_writing *job, hewn_output *output, hewn_error *error)
{
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    hewn_stream facets = {put_facet, job->mesh->triangle_count, FACET, 0, 1};
    return hewn_stream_write(job, &facets, output, error);
}

const hewn_mesh_writer hewn_stl_writer = {fits, prepare, write};
