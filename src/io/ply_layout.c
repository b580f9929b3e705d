#include "io/ply_layout.h"

#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/ply_values.h"

enum { MOST_COMPONENTS = 16 };

typedef struct layout_maker {
    const hewn_ply_header *header;
    const hewn_ply_element *element;
    hewn_ply_layout *layout;
} layout_maker;

/* Properties that stand for one thing when they come together. */
static const struct {
    const char *channel; /* NULL: the positions */
    const char *names[4];
    uint32_t least; /* the names after these may be missing */
    bool of_faces;  /* too */
    bool bytes;     /* may be uchar */
    bool any_types; /* and different ones */
} groups[] = {
    {NULL, {"x", "y", "z"}, 3, false, true, true},
    {"normal", {"nx", "ny", "nz"}, 3, true, false, false},
    {"color", {"red", "green", "blue", "alpha"}, 3, true, true, false},
    {"color", {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"}, 3, true, true, false},
    {"color", {"r", "g", "b", "a"}, 3, true, true, false},
    {"uv", {"s", "t"}, 2, false, false, false},
    {"uv", {"u", "v"}, 2, false, false, false},
    {"uv", {"texture_u", "texture_v"}, 2, false, false, false},
};

static const hewn_ply_property *property_at(const layout_maker *maker, size_t i)
{
    return &maker->header->properties[maker->element->first + i];
}

/* Names of channels are strings. */
static bool is_string(hewn_word name)
{
    return name.begin < name.end && !memchr(name.begin, 0, (size_t)(name.end - name.begin));
}

static bool is_taken(const layout_maker *maker, hewn_domain domain, hewn_word name)
{
    for (uint32_t i = 0; i < maker->layout->column_count; i++) {
        const hewn_ply_column *column = &maker->layout->columns[i];
        if (column->domain == domain && column->name && hewn_word_is(name, column->name))
            return true;
    }
    return false;
}

/* `name` NULL: the positions. There is room for a column a property. */
static hewn_result add_column(layout_maker *maker, const hewn_word *name, hewn_domain domain, hewn_ply_type type,
                              uint32_t components, hewn_error *error)
{
    hewn_ply_column column = {.domain = domain,
                              .scalar = name ? hewn_ply_scalar_of(type) : HEWN_SCALAR_DOUBLE,
                              .components = components,
                              .is_unsigned = type == HEWN_PLY_UINT32};
    column.size = hewn_scalar_size(column.scalar);
    if (name) {
        size_t length = (size_t)(name->end - name->begin);
        column.name = hewn_alloc(length + 1, 1);
        if (!column.name)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a name");
        memcpy(column.name, name->begin, length);
        column.name[length] = '\0';
    }
    maker->layout->columns[maker->layout->column_count++] = column;
    return HEWN_OK;
}

static void set_slot(layout_maker *maker, size_t property, uint32_t component)
{
    maker->layout->slots[property] = (hewn_ply_slot){maker->layout->column_count - 1, component};
}

/* --- known names -------------------------------------------------------------------------------------------------- */

/* The places of a group's properties and how many there are; 0 where property `i` begins none. */
static uint32_t match_group(const layout_maker *maker, size_t group, size_t i, size_t places[4])
{
    hewn_ply_type type = property_at(maker, i)->type;
    bool fits = type == HEWN_PLY_FLOAT || type == HEWN_PLY_DOUBLE || (type == HEWN_PLY_UINT8 && groups[group].bytes);
    if (!(fits || groups[group].any_types) || (maker->element->kind != HEWN_PLY_VERTICES && !groups[group].of_faces))
        return 0;
    uint32_t count = 0;
    bool found = false;
    for (uint32_t k = 0; k < 4 && groups[group].names[k]; k++)
        found = found || hewn_word_is(property_at(maker, i)->name, groups[group].names[k]);
    for (; found && count < 4 && groups[group].names[count]; count++) {
        size_t at = hewn_ply_find(maker->header, maker->element, groups[group].names[count]);
        if (at == HEWN_PLY_MOST || (property_at(maker, at)->type != type && !groups[group].any_types))
            break;
        places[count] = at;
    }
    found = false; /* a second property of that name is another */
    for (uint32_t k = 0; k < count; k++)
        found = found || places[k] == i;
    return found && count >= groups[group].least ? count : 0;
}

static hewn_result take_group(layout_maker *maker, size_t i, bool *taken, hewn_error *error)
{
    hewn_domain domain = maker->element->kind == HEWN_PLY_VERTICES ? HEWN_DOMAIN_VERT : HEWN_DOMAIN_FACE;
    for (size_t group = 0; group < sizeof groups / sizeof *groups; group++) {
        size_t places[4];
        uint32_t count = match_group(maker, group, i, places);
        const char *channel = groups[group].channel;
        hewn_word name = {channel, channel ? channel + strlen(channel) : NULL};
        if (count == 0 || (channel && is_taken(maker, domain, name)))
            continue;
        HEWN_TRY(add_column(maker, channel ? &name : NULL, domain, property_at(maker, i)->type, count, error));
        for (uint32_t k = 0; k < count; k++)
            set_slot(maker, places[k], k);
        *taken = true;
        return HEWN_OK;
    }
    return HEWN_OK;
}

/* --- other names -------------------------------------------------------------------------------------------------- */

/* How many properties from `i` on are called NAME_0, NAME_1 and so on; `*name` is NAME. */
static uint32_t count_numbered(const layout_maker *maker, size_t i, hewn_word *name)
{
    *name = property_at(maker, i)->name;
    size_t length = (size_t)(name->end - name->begin);
    if (length < 3 || memcmp(name->end - 2, "_0", 2) != 0)
        return 0;
    name->end -= 2;
    uint32_t count = 1;
    for (; i + count < maker->element->property_count; count++) {
        const hewn_ply_property *next = property_at(maker, i + count);
        char ending[16];
        size_t ending_length = (size_t)snprintf(ending, sizeof ending, "_%u", count);
        size_t next_length = (size_t)(next->name.end - next->name.begin);
        if (next->count_type != HEWN_PLY_NONE || next->type != property_at(maker, i)->type ||
            maker->layout->slots[i + count].column != HEWN_NONE || next_length != length - 2 + ending_length ||
            memcmp(next->name.begin, name->begin, length - 2) != 0 ||
            memcmp(next->name.end - ending_length, ending, ending_length) != 0)
            break;
    }
    return count;
}

static hewn_result take_numbered(layout_maker *maker, size_t i, bool *taken, hewn_error *error)
{
    hewn_domain domain = maker->element->kind == HEWN_PLY_VERTICES ? HEWN_DOMAIN_VERT : HEWN_DOMAIN_FACE;
    hewn_word name;
    uint32_t count = count_numbered(maker, i, &name);
    if (count < 2 || count > MOST_COMPONENTS || !is_string(name) || is_taken(maker, domain, name))
        return HEWN_OK;
    HEWN_TRY(add_column(maker, &name, domain, property_at(maker, i)->type, count, error));
    for (uint32_t k = 0; k < count; k++)
        set_slot(maker, i + k, k);
    *taken = true;
    return HEWN_OK;
}

static hewn_result take_single(layout_maker *maker, size_t i, hewn_error *error)
{
    hewn_domain domain = maker->element->kind == HEWN_PLY_VERTICES ? HEWN_DOMAIN_VERT : HEWN_DOMAIN_FACE;
    const hewn_ply_property *property = property_at(maker, i);
    if (!is_string(property->name) || is_taken(maker, domain, property->name))
        return HEWN_OK;
    HEWN_TRY(add_column(maker, &property->name, domain, property->type, 1, error));
    set_slot(maker, i, 0);
    return HEWN_OK;
}

static hewn_result take_list(layout_maker *maker, size_t i, hewn_error *error)
{
    static const char prefix[] = "corner_", uv[] = "uv";
    const hewn_ply_property *property = property_at(maker, i);
    bool texcoord = hewn_word_is(property->name, "texcoord");
    hewn_word name = {uv, uv + 2};
    if (!texcoord) {
        size_t length = (size_t)(property->name.end - property->name.begin);
        if (length < sizeof prefix || memcmp(property->name.begin, prefix, sizeof prefix - 1) != 0)
            return HEWN_OK;
        name = (hewn_word){property->name.begin + sizeof prefix - 1, property->name.end};
    }
    bool real = property->type == HEWN_PLY_FLOAT || property->type == HEWN_PLY_DOUBLE;
    if (maker->element->kind != HEWN_PLY_FACES || !is_string(name) || is_taken(maker, HEWN_DOMAIN_CORNER, name) ||
        (texcoord && !real))
        return HEWN_OK;
    HEWN_TRY(add_column(maker, &name, HEWN_DOMAIN_CORNER, property->type, texcoord ? 2 : 0, error));
    set_slot(maker, i, 0);
    return HEWN_OK;
}

static hewn_result take_properties(layout_maker *maker, hewn_error *error)
{
    for (size_t i = 0; i < maker->element->property_count; i++) {
        bool taken = maker->layout->slots[i].column != HEWN_NONE;
        bool list = property_at(maker, i)->count_type != HEWN_PLY_NONE;
        if (list)
            HEWN_TRY(take_list(maker, i, error));
        if (!list && !taken)
            HEWN_TRY(take_group(maker, i, &taken, error));
        if (!list && !taken)
            HEWN_TRY(take_numbered(maker, i, &taken, error));
        if (!list && !taken)
            HEWN_TRY(take_single(maker, i, error));
    }
    return HEWN_OK;
}

hewn_result hewn_ply_layout_make(const hewn_ply_header *header, const hewn_ply_element *element, hewn_ply_layout *out,
                                 hewn_error *error)
{
    *out = (hewn_ply_layout){.columns = hewn_alloc(element->property_count, sizeof *out->columns),
                             .slots = hewn_alloc(element->property_count, sizeof *out->slots)};
    hewn_result result = HEWN_OK;
    if (!out->columns || !out->slots)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %zu properties", element->property_count);
    for (size_t i = 0; result == HEWN_OK && i < element->property_count; i++)
        out->slots[i] = (hewn_ply_slot){HEWN_NONE, 0};
    layout_maker maker = {header, element, out};
    if (result == HEWN_OK)
        result = take_properties(&maker, error);
    if (result != HEWN_OK)
        hewn_ply_layout_free(out);
    return result;
}

void hewn_ply_layout_free(hewn_ply_layout *layout)
{
    for (uint32_t i = 0; i < layout->column_count; i++) {
        hewn_free(layout->columns[i].name);
        hewn_free(layout->columns[i].values);
    }
    hewn_free(layout->columns);
    hewn_free(layout->slots);
    *layout = (hewn_ply_layout){0};
}
