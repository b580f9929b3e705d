#include "mesh/mesh_data.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"

enum { MOST_COMPONENTS = 16 };

size_t hewn_scalar_size(hewn_scalar scalar)
{
    switch (scalar) {
    case HEWN_SCALAR_FLOAT: return sizeof(float);
    case HEWN_SCALAR_DOUBLE: return sizeof(double);
    case HEWN_SCALAR_UINT8: return sizeof(uint8_t);
    case HEWN_SCALAR_INT32: return sizeof(int32_t);
    }
    return 0;
}

static hewn_result check_info(const hewn_mesh *mesh, const hewn_attribute_info *info, hewn_error *error)
{
    if (!info->name || info->name[0] == '\0')
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an attribute needs a name");
    if (info->components < 1 || info->components > MOST_COMPONENTS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "attribute \"%s\" cannot have %u components, only 1 to %d",
                         info->name, info->components, MOST_COMPONENTS);
    if (hewn_scalar_size(info->scalar) == 0 || (unsigned)info->domain > HEWN_DOMAIN_FACE)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "attribute \"%s\" has an unknown domain or scalar", info->name);
    if (hewn_mesh_find_attribute(mesh, info->domain, info->name, NULL))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh has an attribute \"%s\" there already", info->name);
    return HEWN_OK;
}

static size_t domain_capacity(const hewn_mesh *mesh, hewn_domain domain)
{
    return domain == HEWN_DOMAIN_VERT   ? mesh->vert_capacity
           : domain == HEWN_DOMAIN_FACE ? mesh->face_capacity
                                        : mesh->half_capacity;
}

hewn_result hewn_mesh_add_attribute(hewn_mesh *mesh, const hewn_attribute_info *info, uint32_t *out, hewn_error *error)
{
    if (out)
        *out = 0;
    HEWN_TRY(check_info(mesh, info, error));
    HEWN_TRY(hewn_reserve((void **)&mesh->attributes, &mesh->attribute_capacity, (size_t)mesh->attribute_count + 1,
                          sizeof *mesh->attributes, error));
    mesh_attribute attribute = {.info = *info, .stride = hewn_scalar_size(info->scalar) * info->components};
    bool real = info->scalar == HEWN_SCALAR_FLOAT || info->scalar == HEWN_SCALAR_DOUBLE;
    attribute.direction = real && info->components == 3 && strcmp(info->name, "normal") == 0;
    char *name = hewn_strdup(info->name);
    attribute.data = hewn_alloc_zero(domain_capacity(mesh, info->domain), attribute.stride);
    if (!name || !attribute.data) {
        hewn_free(name);
        hewn_free(attribute.data);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the attribute \"%s\"", info->name);
    }
    attribute.info.name = name;
    mesh->attributes[mesh->attribute_count] = attribute;
    if (out)
        *out = mesh->attribute_count;
    mesh->attribute_count++;
    return HEWN_OK;
}

void hewn_mesh_remove_attribute(hewn_mesh *mesh, uint32_t attribute)
{
    if (attribute >= mesh->attribute_count)
        return;
    hewn_free((void *)mesh->attributes[attribute].info.name);
    hewn_free(mesh->attributes[attribute].data);
    hewn_mesh_clear_names(&mesh->attributes[attribute]);
    mesh->attribute_count--;
    memmove(mesh->attributes + attribute, mesh->attributes + attribute + 1,
            (mesh->attribute_count - attribute) * sizeof *mesh->attributes);
}

uint32_t hewn_mesh_attribute_count(const hewn_mesh *mesh)
{
    return mesh->attribute_count;
}

const hewn_attribute_info *hewn_mesh_attribute(const hewn_mesh *mesh, uint32_t attribute)
{
    return attribute < mesh->attribute_count ? &mesh->attributes[attribute].info : NULL;
}

bool hewn_mesh_find_attribute(const hewn_mesh *mesh, hewn_domain domain, const char *name, uint32_t *out)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++)
        if (mesh->attributes[i].info.domain == domain && strcmp(mesh->attributes[i].info.name, name) == 0) {
            if (out)
                *out = i;
            return true;
        }
    return false;
}

const void *hewn_mesh_attribute_read(const hewn_mesh *mesh, uint32_t attribute, uint32_t element)
{
    if (attribute >= mesh->attribute_count)
        return NULL;
    const mesh_attribute *entry = &mesh->attributes[attribute];
    return element < mesh_domain_bound(mesh, entry->info.domain) ? entry->data + element * entry->stride : NULL;
}

void *hewn_mesh_attribute_at(hewn_mesh *mesh, uint32_t attribute, uint32_t element)
{
    return (void *)hewn_mesh_attribute_read(mesh, attribute, element);
}

void hewn_mesh_read_direction(const mesh_attribute *attribute, uint32_t element, double out[3])
{
    const unsigned char *at = attribute->data + element * attribute->stride;
    for (int k = 0; k < 3; k++)
        out[k] = attribute->info.scalar == HEWN_SCALAR_FLOAT ? (double)((const float *)(const void *)at)[k]
                                                             : ((const double *)(const void *)at)[k];
}

void hewn_mesh_write_direction(mesh_attribute *attribute, uint32_t element, const double direction[3])
{
    unsigned char *at = attribute->data + element * attribute->stride;
    for (int k = 0; k < 3; k++) {
        if (attribute->info.scalar == HEWN_SCALAR_FLOAT)
            ((float *)(void *)at)[k] = (float)direction[k];
        else
            ((double *)(void *)at)[k] = direction[k];
    }
}

/* --- what operations do to values --------------------------------------------------------------------------------- */

bool hewn_mesh_has_values(const hewn_mesh *mesh, hewn_domain domain)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++)
        if (mesh->attributes[i].info.domain == domain)
            return true;
    return false;
}

void hewn_mesh_clear_values(hewn_mesh *mesh, hewn_domain domain, uint32_t element)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        if (attribute->info.domain == domain)
            memset(attribute->data + element * attribute->stride, 0, attribute->stride);
    }
}

void hewn_mesh_copy_values(hewn_mesh *mesh, hewn_domain domain, uint32_t to, uint32_t from)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        if (attribute->info.domain == domain)
            memcpy(attribute->data + to * attribute->stride, attribute->data + from * attribute->stride,
                   attribute->stride);
    }
}

static double value_read(const mesh_attribute *attribute, uint32_t element, uint32_t component)
{
    const unsigned char *at = attribute->data + element * attribute->stride;
    switch (attribute->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)(const void *)at)[component];
    case HEWN_SCALAR_DOUBLE: return ((const double *)(const void *)at)[component];
    case HEWN_SCALAR_UINT8: return at[component];
    case HEWN_SCALAR_INT32: return ((const int32_t *)(const void *)at)[component];
    }
    return 0;
}

static void value_write(mesh_attribute *attribute, uint32_t element, uint32_t component, double value)
{
    unsigned char *at = attribute->data + element * attribute->stride;
    if (attribute->info.scalar == HEWN_SCALAR_FLOAT)
        ((float *)(void *)at)[component] = (float)value;
    else if (attribute->info.scalar == HEWN_SCALAR_DOUBLE)
        ((double *)(void *)at)[component] = value;
    else
        at[component] = (uint8_t)lrint(value < 0 ? 0 : value > 255 ? 255 : value);
}

static void normalise(double *values)
{
    double length = sqrt(values[0] * values[0] + values[1] * values[1] + values[2] * values[2]);
    if (length > 0 && isfinite(length))
        for (int i = 0; i < 3; i++)
            values[i] /= length;
}

static void blend(mesh_attribute *attribute, uint32_t to, const uint32_t *from, const double *weights, uint32_t count)
{
    double sum[MOST_COMPONENTS] = {0};
    for (uint32_t s = 0; s < count; s++)
        for (uint32_t c = 0; c < attribute->info.components; c++)
            sum[c] += weights[s] * value_read(attribute, from[s], c);
    if (attribute->direction)
        normalise(sum);
    for (uint32_t c = 0; c < attribute->info.components; c++)
        value_write(attribute, to, c, sum[c]);
}

void hewn_mesh_blend_values(hewn_mesh *mesh, hewn_domain domain, uint32_t to, const uint32_t *from,
                            const double *weights, uint32_t count)
{
    uint32_t greatest = 0;
    for (uint32_t s = 1; s < count; s++)
        greatest = weights[s] > weights[greatest] ? s : greatest;
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        if (attribute->info.domain != domain)
            continue;
        if (attribute->info.scalar == HEWN_SCALAR_INT32)
            memcpy(attribute->data + to * attribute->stride, attribute->data + from[greatest] * attribute->stride,
                   attribute->stride);
        else
            blend(attribute, to, from, weights, count);
    }
}
