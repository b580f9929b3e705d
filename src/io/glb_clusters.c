/* GLB with clusters: the finest level as a mesh like any other, and behind it what all levels are made of. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/bytes.h"
#include "io/glb_body.h"
#include "io/shim/gltf_levels.h"

/* Of a cluster in the file: five times four numbers of 4 bytes. */
enum { CLUSTER_BYTES = 80 };

/* --- the finest level --------------------------------------------------------------------------------------------- */

/* Values of vertices and corners become those of the clusters' vertices. */
static hewn_result flatten_channel(const hewn_clusters *from, const hewn_channel *channel, hewn_model *out,
                                   hewn_error *error)
{
    hewn_channel *copy;
    hewn_attribute_info info = channel->info;
    const size_t bytes = info.components * hewn_scalar_size(info.scalar);
    const bool corner = info.domain == HEWN_DOMAIN_CORNER;
    info.domain = HEWN_DOMAIN_VERT;
    if (hewn_model_find_channel(out, HEWN_DOMAIN_VERT, info.name))
        return HEWN_OK; /* corners' values come first, and go before */
    HEWN_TRY(hewn_model_add_channel(out, &info, &copy, error));
    for (size_t u = 0; u < from->unique_count; u++) {
        const uint32_t at = corner ? from->corner_origins[u] : from->vertex_origins[u];
        if (at != HEWN_NONE)
            memcpy((char *)copy->values + u * bytes, (const char *)channel->values + at * bytes, bytes);
    }
    return HEWN_OK;
}

static hewn_result flatten_faces(const hewn_clusters *from, const hewn_channel *channel, hewn_model *out,
                                 hewn_error *error)
{
    hewn_channel *copy;
    int32_t value;
    const size_t bytes = channel->info.components * hewn_scalar_size(channel->info.scalar);
    HEWN_TRY(hewn_model_add_channel(out, &channel->info, &copy, error));
    for (uint64_t t = 0; t < out->face_count; t++)
        memcpy((char *)copy->values + t * bytes, (const char *)channel->values + from->faces[t] * bytes, bytes);
    for (uint32_t i = 0; i < channel->name_count; i++)
        HEWN_TRY(hewn_channel_value(copy, channel->names[i], &value, error));
    return HEWN_OK;
}

/* Triangles of the finest level, in the order of the clusters, over their vertices. */
static hewn_result flatten(const hewn_clusters *from, const hewn_model *model, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){
        .vertex_count = from->unique_count, .unit = model->unit, .up = model->up, .up_known = model->up_known};
    for (uint32_t i = 0; i < from->count && from->clusters[i].level == 0; i++)
        out->face_count += from->clusters[i].triangle_count;
    out->positions = hewn_alloc(out->vertex_count, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(out->face_count, 3 * sizeof *out->corners);
    if (!out->positions || !out->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    for (size_t u = 0; u < out->vertex_count; u++)
        memcpy(out->positions + 3 * u, model->positions + 3 * (size_t)from->vertex_origins[u], 3 * sizeof(double));
    for (uint32_t i = 0; i < from->count && from->clusters[i].level == 0; i++) {
        const hewn_cluster *cluster = &from->clusters[i];
        for (size_t c = 3 * (size_t)cluster->first_triangle;
             c < 3 * ((size_t)cluster->first_triangle + cluster->triangle_count); c++)
            out->corners[c] = from->vertices[cluster->first_vertex + from->corners[c]];
    }
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < model->channel_count; i++)
            if (model->channels[i].info.domain == (pass == 0 ? HEWN_DOMAIN_CORNER : HEWN_DOMAIN_VERT))
                HEWN_TRY(flatten_channel(from, &model->channels[i], out, error));
    for (uint32_t i = 0; i < model->channel_count; i++)
        if (model->channels[i].info.domain == HEWN_DOMAIN_FACE)
            HEWN_TRY(flatten_faces(from, &model->channels[i], out, error));
    return HEWN_OK;
}

/* --- what stands behind it ---------------------------------------------------------------------------------------- */

static char *put_sphere(char *to, const float center[3], float radius)
{
    for (int axis = 0; axis < 3; axis++)
        to = hewn_put_float(to, center[axis]);
    return hewn_put_float(to, radius);
}

static void put_cluster(char *to, const hewn_cluster *cluster)
{
    to = hewn_put_u32(to, cluster->first_vertex);
    to = hewn_put_u32(to, cluster->vertex_count);
    to = hewn_put_u32(to, cluster->first_triangle);
    to = hewn_put_u32(to, cluster->triangle_count);
    to = put_sphere(to, cluster->self.center, cluster->self.radius);
    to = put_sphere(to, cluster->parent.center, cluster->parent.radius);
    to = put_sphere(to, cluster->center, cluster->radius);
    to = hewn_put_float(to, cluster->self.error);
    to = hewn_put_float(to, cluster->parent.error);
    to = hewn_put_u32(to, cluster->level);
    hewn_put_u32(to, 0);
}

static hewn_result write_clusters(const hewn_clusters *from, hewn_output *output, hewn_error *error)
{
    char bytes[CLUSTER_BYTES];
    for (uint32_t i = 0; i < from->count; i++) {
        put_cluster(bytes, &from->clusters[i]);
        HEWN_TRY(hewn_output_write(output, bytes, sizeof bytes, error));
    }
    for (uint64_t i = 0; i < from->vertex_count; i++) {
        hewn_put_u32(bytes, from->vertices[i]);
        HEWN_TRY(hewn_output_write(output, bytes, 4, error));
    }
    HEWN_TRY(hewn_output_write(output, from->corners, 3 * from->triangle_count, error));
    return hewn_output_write(output, "\0\0\0", (size_t)(-(3 * from->triangle_count) & 3), error);
}

static hewn_result write_file(const hewn_writing *job, const hewn_clusters *from, const char *head, size_t length,
                              const char *path, hewn_error *error)
{
    hewn_output *output = NULL;
    hewn_result result = hewn_output_create(path, &output, error);
    if (result == HEWN_OK)
        result = hewn_output_write(output, head, length, error);
    if (result == HEWN_OK)
        result = hewn_glb_write_body(job, output, error);
    if (result == HEWN_OK && job->triangle_count > 0)
        result = write_clusters(from, output, error);
    if (result == HEWN_OK)
        result = hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result compose(hewn_writing *job, const hewn_clusters *from, char **head, size_t *length, hewn_error *error)
{
    hewn_text plain = {0}, json = {0};
    hewn_gltf_clusters behind = {.cluster_bytes = (uint64_t)CLUSTER_BYTES * from->count,
                                 .vertex_bytes = 4 * from->vertex_count,
                                 .corner_bytes = 3 * from->triangle_count,
                                 .count = from->count,
                                 .level_count = from->level_count};
    hewn_result result = hewn_glb_writer.fits(job, error);
    if (result == HEWN_OK)
        result = hewn_writing_check(job, error);
    if (result == HEWN_OK)
        result = hewn_glb_compose(job, &plain, &behind.begin, error);
    if (result == HEWN_OK)
        result = hewn_gltf_add_clusters(&plain, &behind, &json, error);
    uint64_t whole = behind.begin;
    if (job->triangle_count > 0)
        whole += behind.cluster_bytes + behind.vertex_bytes + ((behind.corner_bytes + 3) & ~(uint64_t)3);
    if (result == HEWN_OK)
        result = hewn_glb_head(&json, whole, head, length, error);
    hewn_text_clear(&plain);
    hewn_text_clear(&json);
    return result;
}

hewn_result hewn_clusters_write_glb(const hewn_clusters *clusters, const hewn_model *model, const char *path,
                                    const hewn_write_desc *desc, hewn_error *error)
{
    static const hewn_write_desc defaults;
    const hewn_write_desc *wanted = desc ? desc : &defaults;
    hewn_model flat = {0};
    hewn_writing job = {0};
    char *head = NULL, *name = hewn_object_name(wanted->name, path);
    size_t length = 0;
    hewn_result result = name ? flatten(clusters, model, &flat, error)
                              : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    if (result == HEWN_OK) {
        job = hewn_writing_of(&flat, wanted);
        job.name = name;
        result = compose(&job, clusters, &head, &length, error);
    }
    if (result == HEWN_OK)
        result = write_file(&job, clusters, head, length, path, error);
    hewn_glb_writer.release(&job);
    hewn_model_destroy(&flat);
    hewn_free(head);
    hewn_free(name);
    return result;
}
