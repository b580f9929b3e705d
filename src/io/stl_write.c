/* STL, binary: facets with their own corners and a normal each, and the face channel "attribute" (1 INT32) where it is
 * that which the reader makes. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/clones.h"
#include "base/error.h"
#include "base/text.h"
#include "io/bytes.h"
#include "io/remark.h"
#include "io/stream.h"

enum { HEADER = 80, FACET = 50, RUN = 64 };

/* --- facets ------------------------------------------------------------------------------------------------------- */

/* Some facets at once: their normals are computed in lanes. */
typedef struct facet_run {
    float corner[3][3][RUN]; /* corner, axis, facet */
    float normal[3][RUN];
    uint32_t attribute[RUN];
} facet_run;

/* Of length 1, or 0 for a facet without area. */
HEWN_CLONES static void find_normals(facet_run *run)
{
    for (int i = 0; i < RUN; i++) {
        double u[3], v[3], n[3];
        for (int axis = 0; axis < 3; axis++) {
            u[axis] = (double)run->corner[1][axis][i] - (double)run->corner[0][axis][i];
            v[axis] = (double)run->corner[2][axis][i] - (double)run->corner[0][axis][i];
        }
        n[0] = u[1] * v[2] - u[2] * v[1];
        n[1] = u[2] * v[0] - u[0] * v[2];
        n[2] = u[0] * v[1] - u[1] * v[0];
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), divisor = length > 0 ? length : 1;
        for (int axis = 0; axis < 3; axis++) {
            float quotient = (float)(n[axis] / divisor);
            run->normal[axis][i] = length > 0 ? quotient : 0.0f; /* not -0 */
        }
    }
}

/* The face that a place in `corners` belongs to: the last one that begins there or before, of those with corners. */
static uint64_t face_of(const hewn_writing *job, uint64_t place)
{
    uint64_t low = 0, high = job->face_count;
    if (!job->first)
        return place / 3;
    while (high - low > 1) {
        uint64_t middle = low + (high - low) / 2;
        if (job->first[middle] <= place)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The two bytes after a facet. */
static uint32_t attribute_of(const hewn_writing *job, uint64_t place)
{
    const hewn_channel *channel = job->own;
    if (!channel)
        return 0;
    int32_t value = ((const int32_t *)channel->values)[face_of(job, place)];
    return value >= 0 && value <= UINT16_MAX ? (uint32_t)value : 0;
}

static void gather(const hewn_writing *job, uint64_t t, int i, facet_run *run)
{
    uint64_t place[3];
    hewn_writing_triangle(job, t, place);
    for (int k = 0; k < 3; k++) {
        double position[3];
        hewn_writing_position(job, job->corners[place[k]], position);
        for (int axis = 0; axis < 3; axis++)
            run->corner[k][axis][i] = (float)position[axis];
    }
    run->attribute[i] = attribute_of(job, place[0]);
}

/* The same of triangle buffers, whose positions are floats. */
static void gather_floats(const hewn_writing *job, uint64_t begin, int count, facet_run *run)
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const uint64_t place = 3 * (begin + (uint64_t)i) + (uint64_t)k;
            const float *position = job->floats + 3 * (uint64_t)job->corners[place];
            for (int axis = 0; axis < 3; axis++)
                run->corner[k][axis][i] = position[axis];
        }
}

static char *put_facets(const facet_run *run, int count, char *to)
{
    for (int i = 0; i < count; i++) {
        for (int axis = 0; axis < 3; axis++)
            to = hewn_put_float(to, run->normal[axis][i]);
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                to = hewn_put_float(to, run->corner[k][axis][i]);
        to = hewn_put_u16(to, run->attribute[i]);
    }
    return to;
}

static char *put_run(const hewn_writing *job, uint64_t begin, uint64_t end, char *to)
{
    facet_run run = {0};
    const bool plain = job->floats && !job->cut && !job->own;
    for (uint64_t t = begin; t < end; t += RUN) {
        const int count = end - t < RUN ? (int)(end - t) : RUN;
        if (plain)
            gather_floats(job, t, count, &run);
        for (int i = 0; i < count && !plain; i++)
            gather(job, t + (uint64_t)i, i, &run);
        find_normals(&run);
        to = put_facets(&run, count, to);
    }
    return to;
}

/* --- the file ----------------------------------------------------------------------------------------------------- */

static hewn_result fits(const hewn_writing *job, hewn_error *error)
{
    if (job->triangle_count > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu triangles are more than the 4294967295 that an STL file can hold",
                         (unsigned long long)job->triangle_count);
    return HEWN_OK;
}

static hewn_result check_range(const hewn_writing *job, hewn_error *error)
{
    for (uint64_t i = 0; !job->all_float && i < 3 * job->vertex_count; i++)
        if (fabs(job->doubles[i]) > (double)FLT_MAX)
            return hewn_fail(error, HEWN_LIMIT, "vertex %llu lies too far out for STL's floats",
                             (unsigned long long)(i / 3));
    return HEWN_OK;
}

/* The header's text must not begin with "solid", by which readers know the text form. */
static hewn_result prepare(hewn_writing *job, hewn_error *error)
{
    HEWN_TRY(check_range(job, error));
    const hewn_channel *attribute = hewn_writing_channel(job, HEWN_DOMAIN_FACE, "attribute");
    if (attribute && attribute->info.scalar == HEWN_SCALAR_INT32 && attribute->info.components == 1)
        job->own = (void *)(uintptr_t)attribute; /* only read, and the model's: there is nothing to release */
    char count[4];
    hewn_text head = {0};
    hewn_text_print(&head, "binary STL, Hewn %s, ", hewn_version());
    hewn_remark_print(&head, job->unit, job->up_known ? &job->up : NULL, job->space);
    while (head.length < HEADER && !head.failed)
        hewn_text_append_bytes(&head, "\0", 1);
    if (!head.failed)
        head.length = HEADER;
    hewn_put_u32(count, (uint32_t)job->triangle_count);
    hewn_text_append_bytes(&head, count, sizeof count);
    job->head = head.bytes;
    job->head_length = head.length;
    return hewn_text_status(&head, error);
}

static hewn_result write(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    hewn_output_expect(output, job->head_length + FACET * job->triangle_count);
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    hewn_stream facets = {.put_run = put_run, .count = job->triangle_count, .room = FACET, .span = 1};
    return hewn_stream_write(job, &facets, output, error);
}

const hewn_format_writer hewn_stl_writer = {
    .triangles = true, .to_stdout = true, .fits = fits, .prepare = prepare, .write = write};
