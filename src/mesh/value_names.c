#include <string.h>

#include "base/alloc.h"
#include "mesh/mesh_data.h"

void hewn_mesh_clear_names(mesh_attribute *attribute)
{
    for (uint32_t i = 0; i < attribute->name_count; i++)
        hewn_free(attribute->names[i]);
    hewn_free((void *)attribute->names);
    attribute->names = NULL;
    attribute->name_count = 0;
}

hewn_result hewn_mesh_name_values(hewn_mesh *mesh, uint32_t attribute, const char *const *names, uint32_t count,
                                  hewn_error *error)
{
    if (attribute >= mesh->attribute_count || mesh->attributes[attribute].info.scalar != HEWN_SCALAR_INT32)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "only values of integer attributes have names");
    for (uint32_t i = 0; i < count; i++)
        if (!names[i])
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "value %u has no name", i);
    mesh_attribute copy = {.names = hewn_alloc_zero(count, sizeof *copy.names)};
    bool whole = copy.names != NULL;
    for (; whole && copy.name_count < count; copy.name_count += whole) {
        copy.names[copy.name_count] = hewn_strdup(names[copy.name_count]);
        whole = copy.names[copy.name_count] != NULL;
    }
    if (!whole) {
        hewn_mesh_clear_names(&copy);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u names", count);
    }
    mesh_attribute *entry = &mesh->attributes[attribute];
    hewn_mesh_clear_names(entry);
    entry->names = copy.names;
    entry->name_count = copy.name_count;
    return HEWN_OK;
}

uint32_t hewn_mesh_value_name_count(const hewn_mesh *mesh, uint32_t attribute)
{
    return attribute < mesh->attribute_count ? mesh->attributes[attribute].name_count : 0;
}

const char *hewn_mesh_value_name(const hewn_mesh *mesh, uint32_t attribute, int32_t value)
{
    bool named = value >= 0 && (uint32_t)value < hewn_mesh_value_name_count(mesh, attribute);
    return named ? mesh->attributes[attribute].names[value] : NULL;
}

/* The value of a name, or -1; `near` is where it stands in meshes of one origin, so that those need no search. */
static int32_t find_name(const mesh_attribute *attribute, const char *name, uint32_t near)
{
    if (near < attribute->name_count && strcmp(attribute->names[near], name) == 0)
        return (int32_t)near;
    for (uint32_t i = 0; i < attribute->name_count; i++)
        if (strcmp(attribute->names[i], name) == 0)
            return (int32_t)i;
    return -1;
}

/* Room for all names of both. */
static hewn_result grow_names(mesh_attribute *attribute, const mesh_attribute *from, hewn_error *error)
{
    size_t most = (size_t)attribute->name_count + from->name_count;
    char **names = most <= INT32_MAX ? hewn_realloc((void *)attribute->names, most, sizeof *names) : NULL;
    if (!names)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %zu names", most);
    attribute->names = names;
    return HEWN_OK;
}

hewn_result hewn_mesh_join_names(mesh_attribute *attribute, const mesh_attribute *from, int32_t **map,
                                 hewn_error *error)
{
    *map = NULL;
    uint32_t count = from->name_count;
    if (attribute == from)
        return HEWN_OK;
    HEWN_TRY(grow_names(attribute, from, error));
    int32_t *values = hewn_alloc(count, sizeof *values);
    if (!values)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u names", count);
    bool fresh = attribute->name_count == 0, moved = false;
    for (uint32_t i = 0; i < count; i++) {
        values[i] = fresh ? -1 : find_name(attribute, from->names[i], i);
        if (values[i] < 0) {
            char *name = hewn_strdup(from->names[i]);
            if (!name) {
                hewn_free(values);
                return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u names", count);
            }
            values[i] = (int32_t)attribute->name_count;
            attribute->names[attribute->name_count++] = name;
        }
        moved = moved || values[i] != (int32_t)i;
    }
    if (moved)
        *map = values;
    else
        hewn_free(values);
    return HEWN_OK;
}
