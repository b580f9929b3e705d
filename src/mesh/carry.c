#include "mesh/carry.h"

#include <string.h>

#include "base/alloc.h"

void hewn_mesh_face_vector(const hewn_mesh *mesh, uint32_t face, double out[3])
{
    uint32_t first = mesh->face_half[face];
    const double *origin = mesh->position + 3 * (size_t)mesh->head[first];
    out[0] = out[1] = out[2] = 0;
    for (uint32_t h = mesh->next[first]; mesh->next[h] != first; h = mesh->next[h]) {
        const double *p = mesh->position + 3 * (size_t)mesh->head[h];
        const double *q = mesh->position + 3 * (size_t)mesh->head[mesh->next[h]];
        double a[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        double b[3] = {q[0] - origin[0], q[1] - origin[1], q[2] - origin[2]};
        for (int k = 0; k < 3; k++)
            out[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

/* --- values ------------------------------------------------------------------------------------------------------- */

static hewn_result add_attribute(hewn_mesh *mesh, const hewn_channel *channel, hewn_error *error)
{
    uint32_t at;
    HEWN_TRY(hewn_mesh_add_attribute(mesh, &channel->info, &at, error));
    if (channel->name_count == 0)
        return HEWN_OK;
    return hewn_mesh_name_values(mesh, at, (const char *const *)channel->names, channel->name_count, error);
}

static void carry_elements(mesh_attribute *attribute, const hewn_channel *channel, const uint32_t *origins,
                           uint64_t count)
{
    const unsigned char *values = channel->values;
    size_t stride = attribute->stride;
    if (!origins && count > 0)
        memcpy(attribute->data, values, count * stride);
    for (uint64_t i = 0; origins && i < count; i++)
        if (origins[i] != HEWN_NONE)
            memcpy(attribute->data + i * stride, values + origins[i] * stride, stride);
}

/* Corner values stand at the half-edge that ends in the corner's vertex. */
static void carry_corners(const hewn_mesh *mesh, mesh_attribute *attribute, const hewn_channel *channel,
                          const uint32_t *origins)
{
    const unsigned char *values = channel->values;
    size_t stride = attribute->stride;
    uint64_t corner = 0;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        uint32_t first = mesh->face_half[f], h = first;
        do {
            uint64_t from = origins ? origins[corner] : corner;
            if (!origins || from != HEWN_NONE)
                memcpy(attribute->data + h * stride, values + from * stride, stride);
            corner++;
            h = mesh->next[h];
        } while (h != first);
    }
}

/* --- turned faces ------------------------------------------------------------------------------------------------- */

/* Whether a face's corners run against their order in the soup: going around once, their places fall but for one step.
 */
static bool is_turned(const hewn_repair_origins *origins, uint32_t face)
{
    uint64_t begin = origins->first[face], count = origins->first[face + 1] - begin, rises = 0;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t a = origins->corner_origins[begin + i], b = origins->corner_origins[begin + (i + 1) % count];
        if (a == HEWN_NONE || b == HEWN_NONE)
            return false;
        rises += b > a;
    }
    return rises == 1;
}

/* Turns a normal that points against its side of the surface. */
static void agree(mesh_attribute *attribute, uint32_t element, const double side[3])
{
    double normal[3];
    hewn_mesh_read_direction(attribute, element, normal);
    if (normal[0] * side[0] + normal[1] * side[1] + normal[2] * side[2] >= 0)
        return;
    for (int k = 0; k < 3; k++)
        normal[k] = -normal[k];
    hewn_mesh_write_direction(attribute, element, normal);
}

/* The sum of the faces' vectors around a vertex; false where one of them was not turned, or there is none. */
static bool all_turned(const hewn_mesh *mesh, uint32_t v, const uint8_t *turned, double side[3])
{
    hewn_ring ring = hewn_vert_ring(mesh, (hewn_vert){v});
    hewn_half half;
    bool any = false;
    side[0] = side[1] = side[2] = 0;
    while (hewn_ring_next(mesh, &ring, &half)) {
        uint32_t face = mesh->face[half.id];
        double vector[3];
        if (face == HEWN_NONE)
            continue;
        if (!turned[face])
            return false;
        any = true;
        hewn_mesh_face_vector(mesh, face, vector);
        for (int k = 0; k < 3; k++)
            side[k] += vector[k];
    }
    return any;
}

static void turn_normals(hewn_mesh *mesh, mesh_attribute *attribute, const uint8_t *turned)
{
    double side[3];
    hewn_domain domain = attribute->info.domain;
    for (uint32_t v = 0; domain == HEWN_DOMAIN_VERT && v < mesh->vert_bound; v++)
        if (all_turned(mesh, v, turned, side))
            agree(attribute, v, side);
    for (uint32_t f = 0; domain != HEWN_DOMAIN_VERT && f < mesh->face_bound; f++) {
        if (!turned[f])
            continue;
        hewn_mesh_face_vector(mesh, f, side);
        uint32_t first = mesh->face_half[f], h = first;
        if (domain == HEWN_DOMAIN_FACE) {
            agree(attribute, f, side);
            continue;
        }
        do {
            agree(attribute, h, side);
            h = mesh->next[h];
        } while (h != first);
    }
}

static hewn_result turn_directions(hewn_mesh *mesh, const hewn_repair_origins *origins, hewn_error *error)
{
    bool wanted = false;
    for (uint32_t i = 0; i < mesh->attribute_count; i++)
        wanted = wanted || mesh->attributes[i].direction;
    if (!wanted)
        return HEWN_OK;
    uint8_t *turned = hewn_alloc(mesh->face_bound, 1);
    if (!turned)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u faces", mesh->face_bound);
    bool any = false;
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        turned[f] = is_turned(origins, f);
        any = any || turned[f];
    }
    for (uint32_t i = 0; any && i < mesh->attribute_count; i++)
        if (mesh->attributes[i].direction)
            turn_normals(mesh, &mesh->attributes[i], turned);
    hewn_free(turned);
    return HEWN_OK;
}

hewn_result hewn_mesh_carry(hewn_mesh *mesh, const hewn_model *model, const hewn_repair_origins *origins,
                            hewn_error *error)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        HEWN_TRY(add_attribute(mesh, channel, error));
        mesh_attribute *attribute = &mesh->attributes[mesh->attribute_count - 1];
        switch (channel->info.domain) {
        case HEWN_DOMAIN_VERT:
            carry_elements(attribute, channel, origins ? origins->vertex_origins : NULL, mesh->vert_bound);
            break;
        case HEWN_DOMAIN_FACE:
            carry_elements(attribute, channel, origins ? origins->face_origins : NULL, mesh->face_bound);
            break;
        case HEWN_DOMAIN_CORNER:
            carry_corners(mesh, attribute, channel, origins ? origins->corner_origins : NULL);
            break;
        }
    }
    return origins ? turn_directions(mesh, origins, error) : HEWN_OK;
}
