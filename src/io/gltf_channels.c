/* The attributes of a glTF scene as channels. */
#include <math.h>
#include <string.h>

#include "io/gltf_scene.h"

enum { MOST_LAYERS = 256 };

/* An attribute by its semantic, over the whole scene. */
typedef struct layer {
    const char *semantic, *name;
    hewn_scalar scalar;
    uint32_t components;
    bool everywhere; /* every set has it */
} layer;

/* The layer's values in one set. */
typedef struct layer_source {
    hewn_gltf_items items;
    bool there;
    bool straight;
    double sign, cofactors[9]; /* for normals */
} layer_source;

typedef struct channel_maker {
    hewn_gltf_scene *scene;
    const layer *layer;
    hewn_channel *channel;
    size_t size;  /* bytes of a value */
    bool *used;   /* by a triangle, for each wedge; NULL: each is a vertex of its own */
    bool *seen;   /* for each vertex */
    bool differs; /* between the wedges of a vertex */
} channel_maker;

static hewn_result fail_memory(const hewn_gltf_scene *scene, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, scene->data.name, 0, "out of memory for attributes");
}

/* --- which layers there are --------------------------------------------------------------------------------------- */

static const hewn_gltf_attribute *find_attribute(const hewn_gltf *gltf, size_t primitive, const char *semantic)
{
    const hewn_gltf_primitive *from = &gltf->primitives[primitive];
    for (size_t i = 0; i < from->attribute_count; i++)
        if (strcmp(gltf->attributes[from->first_attribute + i].semantic, semantic) == 0)
            return &gltf->attributes[from->first_attribute + i];
    return NULL;
}

static bool is_known(const char *name)
{
    return strcmp(name, "normal") == 0 || strcmp(name, "uv") == 0 || strcmp(name, "color") == 0;
}

/* User attributes begin with an underscore in glTF, which stays only where the name would be one that Hewn knows. */
static const char *name_of(const char *semantic)
{
    if (strcmp(semantic, "NORMAL") == 0)
        return "normal";
    if (strcmp(semantic, "TEXCOORD_0") == 0)
        return "uv";
    if (strcmp(semantic, "COLOR_0") == 0)
        return "color";
    return semantic[1] != '\0' && !is_known(semantic + 1) ? semantic + 1 : semantic;
}

static hewn_result find_layers(const hewn_gltf_scene *scene, layer *layers, size_t *count, hewn_error *error)
{
    static const char *const first[] = {"NORMAL", "TEXCOORD_0", "COLOR_0"};
    const hewn_gltf *gltf = &scene->data.gltf;
    for (*count = 0; *count < sizeof first / sizeof *first; ++*count)
        layers[*count] = (layer){.semantic = first[*count], .name = name_of(first[*count])};
    for (size_t s = 0; s < scene->set_count; s++) {
        const hewn_gltf_primitive *from = &gltf->primitives[scene->sets[s].primitive];
        for (size_t i = 0; i < from->attribute_count; i++) {
            const char *semantic = gltf->attributes[from->first_attribute + i].semantic;
            size_t at = 0;
            while (at < *count && strcmp(layers[at].semantic, semantic) != 0)
                at++;
            if (at < *count)
                continue;
            if (*count == MOST_LAYERS)
                return hewn_fail_at(error, HEWN_LIMIT, scene->data.name, 0, "more than %d attributes", MOST_LAYERS);
            layers[(*count)++] = (layer){.semantic = semantic, .name = name_of(semantic)};
        }
    }
    return HEWN_OK;
}

/* What is known of a layer's types, over all sets. */
typedef struct layer_types {
    bool all_bytes; /* unsigned and normalised */
    bool all_whole; /* 16 bits and less, not normalised */
    bool any_long;  /* unsigned and of 32 bits */
    bool any_matrix;
} layer_types;

static void choose_scalar(layer *of, const layer_types *types)
{
    bool user = of->semantic[0] == '_', colour = strcmp(of->semantic, "COLOR_0") == 0;
    bool flipped = strcmp(of->semantic, "TEXCOORD_0") == 0; /* 1 - v is exact in double */
    if ((user || colour) && types->all_bytes)
        of->scalar = HEWN_SCALAR_UINT8;
    else if (user && types->all_whole)
        of->scalar = HEWN_SCALAR_INT32;
    else
        of->scalar = flipped || types->any_long ? HEWN_SCALAR_DOUBLE : HEWN_SCALAR_FLOAT;
}

static hewn_result check_items(const hewn_gltf_scene *scene, const layer *of, const hewn_gltf_set *set,
                               const hewn_gltf_items *items, hewn_error *error)
{
    int n = items->components;
    bool fits = of->semantic[0] == 'N' ? n == 3 : of->semantic[0] == 'T' ? n == 2 : n == 3 || n == 4;
    if (of->semantic[0] != '_' && (!fits || items->component_type == HEWN_GLTF_UINT))
        return hewn_fail_at(error, HEWN_BAD_INPUT, scene->data.name, 0, "%s does not have the type it should have",
                            of->semantic);
    if (items->count != set->count)
        return hewn_fail_at(error, HEWN_BAD_INPUT, scene->data.name, 0, "a primitive has not as many %s as POSITION",
                            of->semantic);
    return HEWN_OK;
}

static hewn_result open_items(hewn_gltf_scene *scene, const layer *of, const hewn_gltf_set *set, hewn_gltf_items *out,
                              bool *there, hewn_error *error)
{
    const hewn_gltf_attribute *attribute = find_attribute(&scene->data.gltf, set->primitive, of->semantic);
    *there = attribute != NULL;
    if (!attribute)
        return HEWN_OK;
    HEWN_TRY(hewn_gltf_items_of(&scene->data, attribute->accessor, out, error));
    bool colour = strcmp(of->semantic, "COLOR_0") == 0;
    out->normalised = out->component_type != HEWN_GLTF_FLOAT && (out->normalised || colour);
    return check_items(scene, of, set, out, error);
}

/* Finds a layer's scalar and components: as many as any set has. 0 components: nothing that can be taken. */
static hewn_result find_type(hewn_gltf_scene *scene, layer *of, hewn_error *error)
{
    layer_types types = {.all_bytes = true, .all_whole = true};
    of->everywhere = true;
    for (size_t s = 0; s < scene->set_count; s++) {
        hewn_gltf_items items;
        bool there;
        HEWN_TRY(open_items(scene, of, &scene->sets[s], &items, &there, error));
        of->everywhere = of->everywhere && there;
        if (!there)
            continue;
        uint32_t components = (uint32_t)items.components;
        bool real = items.component_type == HEWN_GLTF_FLOAT, large = items.component_type == HEWN_GLTF_UINT;
        of->components = components > of->components ? components : of->components;
        types.all_bytes = types.all_bytes && items.component_type == HEWN_GLTF_UBYTE && items.normalised;
        types.all_whole = types.all_whole && !real && !large && !items.normalised;
        types.any_long = types.any_long || large;
        types.any_matrix = types.any_matrix || (items.matrix && !real);
    }
    if (types.any_matrix) /* with gaps between its columns */
        of->components = 0;
    choose_scalar(of, &types);
    return HEWN_OK;
}

/* --- values ------------------------------------------------------------------------------------------------------- */

static hewn_result open_source(channel_maker *maker, const hewn_gltf_instance *instance, const hewn_gltf_set *set,
                               layer_source *out, hewn_error *error)
{
    *out = (layer_source){0};
    HEWN_TRY(open_items(maker->scene, maker->layer, set, &out->items, &out->there, error));
    out->straight = hewn_gltf_is_straight(instance->matrix);
    out->sign = hewn_gltf_cofactors(instance->matrix, out->cofactors) ? -1 : 1;
    return HEWN_OK;
}

/* Normals stay at right angles to what the matrix makes of the surface, and keep length 1. */
static void turn_normal(const layer_source *source, double n[3])
{
    const double *c = source->cofactors;
    double turned[3];
    if (source->straight)
        return;
    for (int row = 0; row < 3; row++)
        turned[row] = source->sign * (c[row] * n[0] + c[3 + row] * n[1] + c[6 + row] * n[2]);
    double length = hypot(hypot(turned[0], turned[1]), turned[2]);
    for (int row = 0; row < 3; row++)
        n[row] = length > 0 && isfinite(length) ? turned[row] / length : 0;
}

static void store(hewn_scalar scalar, const double *numbers, uint32_t count, char *to)
{
    for (uint32_t k = 0; k < count; k++) {
        switch (scalar) {
        case HEWN_SCALAR_FLOAT: ((float *)(void *)to)[k] = (float)numbers[k]; break;
        case HEWN_SCALAR_DOUBLE: ((double *)(void *)to)[k] = numbers[k]; break;
        case HEWN_SCALAR_UINT8: ((uint8_t *)(void *)to)[k] = (uint8_t)lround(255 * numbers[k]); break;
        case HEWN_SCALAR_INT32: ((int32_t *)(void *)to)[k] = (int32_t)numbers[k]; break;
        }
    }
}

/* The value of vertex `index` of a set. Where there is none, colours are white and opaque and all else is 0. */
static hewn_result make_value(const channel_maker *maker, const layer_source *source, uint64_t index, char *to,
                              hewn_error *error)
{
    const layer *of = maker->layer;
    double numbers[16] = {0};
    bool colour = of->semantic[0] == 'C';
    for (uint32_t k = 0; k < of->components; k++)
        numbers[k] = colour ? 1 : 0;
    if (source->there)
        hewn_gltf_numbers(&source->items, index, numbers);
    for (uint32_t k = 0; k < of->components; k++)
        if (!isfinite(numbers[k]))
            return hewn_fail_at(error, HEWN_BAD_INPUT, maker->scene->data.name, 0, "%s of vertex %llu is not finite",
                                of->semantic, (unsigned long long)index);
    if (of->semantic[0] == 'N')
        turn_normal(source, numbers);
    else if (of->semantic[0] == 'T' && source->there)
        numbers[1] = 1 - numbers[1]; /* from the upper left corner to the lower left */
    store(of->scalar, numbers, of->components, to);
    return HEWN_OK;
}

/* --- channels of vertices ----------------------------------------------------------------------------------------- */

/* Marks the wedges that triangles use: only between those may a vertex differ. */
static hewn_result mark_used(hewn_gltf_scene *scene, bool *used, hewn_error *error)
{
    for (size_t i = 0; i < scene->instance_count; i++) {
        const hewn_gltf_instance *instance = &scene->instances[i];
        for (size_t p = 0; p < instance->part_count; p++) {
            const hewn_gltf_part *part = &scene->parts[instance->first_part + p];
            hewn_gltf_corners corners;
            uint64_t at[3];
            HEWN_TRY(hewn_gltf_corners_of(scene, instance, part->primitive, &corners, error));
            for (uint64_t t = 0; t < corners.triangles; t++)
                if (hewn_gltf_triangle(&corners, t, at))
                    for (int k = 0; k < 3; k++)
                        used[scene->sets[part->set].first_wedge + at[k]] = true;
        }
    }
    return HEWN_OK;
}

/* Fills in the vertices of a set; of several wedges the first counts, but used ones come before the others. */
static hewn_result fill_set(channel_maker *maker, const hewn_gltf_instance *instance, const hewn_gltf_set *set,
                            bool used, hewn_error *error)
{
    layer_source source;
    double value[16];
    HEWN_TRY(open_source(maker, instance, set, &source, error));
    for (uint64_t i = 0; i < set->count && !maker->differs; i++) {
        uint64_t wedge = set->first_wedge + i, vertex = maker->scene->wedge_vertices[wedge];
        char *to = (char *)maker->channel->values + maker->size * vertex;
        if (!maker->used) {
            HEWN_TRY(make_value(maker, &source, i, to, error));
            continue;
        }
        if (maker->used[wedge] != used || (!used && maker->seen[vertex]))
            continue;
        HEWN_TRY(make_value(maker, &source, i, (char *)value, error));
        maker->differs = maker->seen[vertex] && memcmp(to, value, maker->size) != 0;
        memcpy(to, value, maker->size);
        maker->seen[vertex] = true;
    }
    return HEWN_OK;
}

static hewn_result fill_vertices(channel_maker *maker, bool used, hewn_error *error)
{
    hewn_gltf_scene *scene = maker->scene;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const hewn_gltf_instance *instance = &scene->instances[i];
        for (size_t s = 0; s < instance->set_count; s++)
            HEWN_TRY(fill_set(maker, instance, &scene->sets[instance->first_set + s], used, error));
    }
    return HEWN_OK;
}

/* --- channels of corners ------------------------------------------------------------------------------------------ */

static hewn_result fill_part(channel_maker *maker, const hewn_gltf_instance *instance, const hewn_gltf_part *part,
                             hewn_error *error)
{
    hewn_gltf_scene *scene = maker->scene;
    hewn_gltf_corners corners;
    layer_source source;
    uint64_t at[3];
    HEWN_TRY(hewn_gltf_corners_of(scene, instance, part->primitive, &corners, error));
    HEWN_TRY(open_source(maker, instance, &scene->sets[part->set], &source, error));
    char *to = (char *)maker->channel->values + 3 * maker->size * part->first_face;
    for (uint64_t t = 0; t < corners.triangles; t++) {
        if (!hewn_gltf_triangle(&corners, t, at))
            continue;
        for (int k = 0; k < 3; k++, to += maker->size)
            HEWN_TRY(make_value(maker, &source, at[k], to, error));
    }
    return HEWN_OK;
}

static hewn_result fill_corners(channel_maker *maker, hewn_error *error)
{
    hewn_gltf_scene *scene = maker->scene;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const hewn_gltf_instance *instance = &scene->instances[i];
        for (size_t p = 0; p < instance->part_count; p++)
            HEWN_TRY(fill_part(maker, instance, &scene->parts[instance->first_part + p], error));
    }
    return HEWN_OK;
}

/* Gives a channel of vertices, still to be filled in, to the corners. */
static hewn_result move_to_corners(channel_maker *maker, hewn_error *error)
{
    hewn_gltf_scene *scene = maker->scene;
    uint64_t count = hewn_model_corner_count(&scene->builder.model);
    HEWN_TRY(hewn_gltf_spend(&scene->data, count, maker->size, error));
    hewn_free(maker->channel->values);
    maker->channel->info.domain = HEWN_DOMAIN_CORNER;
    maker->channel->values = hewn_alloc_zero(count, maker->size);
    return maker->channel->values ? HEWN_OK : fail_memory(scene, error);
}

static hewn_result add_layer(hewn_gltf_scene *scene, const layer *of, bool *used, bool *seen, hewn_error *error)
{
    hewn_model *model = &scene->builder.model;
    hewn_attribute_info info = {of->name, HEWN_DOMAIN_VERT, of->scalar, of->components};
    channel_maker maker = {.scene = scene, .layer = of, .used = used, .seen = seen};
    maker.size = of->components * hewn_scalar_size(of->scalar);
    HEWN_TRY(hewn_gltf_spend(&scene->data, model->vertex_count, maker.size, error));
    HEWN_TRY(hewn_model_add_channel(model, &info, &maker.channel, error));
    if (seen)
        memset(seen, 0, model->vertex_count * sizeof *seen);
    HEWN_TRY(fill_vertices(&maker, true, error));
    if (maker.differs) {
        HEWN_TRY(move_to_corners(&maker, error));
        return fill_corners(&maker, error);
    }
    return used ? fill_vertices(&maker, false, error) : HEWN_OK;
}

/* --- names -------------------------------------------------------------------------------------------------------- */

/* Like hewn_channel_value(), but a name that is there already gets a number, so that each call gives another value. */
static hewn_result new_value(hewn_channel *channel, const char *name, uint64_t number, int32_t *out, hewn_error *error)
{
    uint32_t before = channel->name_count;
    hewn_text text = {0};
    if (name[0])
        HEWN_TRY(hewn_channel_value(channel, name, out, error));
    while (channel->name_count == before) {
        hewn_text_clear(&text);
        hewn_text_print(&text, "%s%s%llu", name, name[0] ? "." : "unnamed ", (unsigned long long)++number);
        hewn_result result = hewn_text_status(&text, error);
        if (result == HEWN_OK)
            result = hewn_channel_value(channel, text.bytes, out, error);
        hewn_text_clear(&text);
        HEWN_TRY(result);
    }
    return HEWN_OK;
}

static hewn_result add_names(hewn_gltf_scene *scene, const char *name, hewn_channel **out, hewn_error *error)
{
    hewn_attribute_info info = {name, HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    HEWN_TRY(hewn_gltf_spend(&scene->data, scene->builder.model.face_count, sizeof(int32_t), error));
    return hewn_model_add_channel(&scene->builder.model, &info, out, error);
}

static void set_part(hewn_channel *channel, const hewn_gltf_part *part, int32_t value)
{
    for (uint64_t face = 0; face < part->face_count; face++)
        ((int32_t *)channel->values)[part->first_face + face] = value;
}

static hewn_result add_objects(hewn_gltf_scene *scene, hewn_error *error)
{
    hewn_channel *channel;
    HEWN_TRY(add_names(scene, "object", &channel, error));
    for (size_t i = 0; i < scene->instance_count; i++) {
        const hewn_gltf_instance *instance = &scene->instances[i];
        int32_t value;
        HEWN_TRY(new_value(channel, instance->name, i, &value, error));
        for (size_t p = 0; p < instance->part_count; p++)
            set_part(channel, &scene->parts[instance->first_part + p], value);
    }
    return HEWN_OK;
}

/* Materials are numbered as faces come to them; faces without one get -1. */
static hewn_result add_materials(hewn_gltf_scene *scene, int32_t *values, hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    hewn_channel *channel;
    HEWN_TRY(add_names(scene, "material", &channel, error));
    for (size_t i = 0; i < gltf->material_count; i++)
        values[i] = -1;
    for (size_t p = 0; p < scene->part_count; p++) {
        int material = gltf->primitives[scene->parts[p].primitive].material, none = -1;
        int32_t *value = material < 0 ? &none : &values[material];
        if (material >= 0 && *value < 0)
            HEWN_TRY(new_value(channel, gltf->materials[material], (uint64_t)material, value, error));
        set_part(channel, &scene->parts[p], *value);
    }
    return HEWN_OK;
}

static hewn_result add_materials_if_named(hewn_gltf_scene *scene, hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    bool named = false;
    for (size_t p = 0; p < scene->part_count; p++) {
        int material = gltf->primitives[scene->parts[p].primitive].material;
        if (material < HEWN_GLTF_NONE || (material >= 0 && (size_t)material >= gltf->material_count))
            return hewn_gltf_fail(scene, "a primitive names a material that does not exist", error);
        named = named || (material >= 0 && gltf->materials[material][0]);
    }
    if (!named)
        return HEWN_OK;
    int32_t *values = hewn_alloc(gltf->material_count, sizeof *values);
    hewn_result result = values ? add_materials(scene, values, error) : fail_memory(scene, error);
    hewn_free(values);
    return result;
}

static hewn_result add_base_colors(hewn_gltf_scene *scene, hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    static const float white[4] = {1, 1, 1, 1};
    static const hewn_attribute_info info = {"color", HEWN_DOMAIN_FACE, HEWN_SCALAR_FLOAT, 4};
    hewn_channel *channel;
    bool any = false;
    for (size_t p = 0; p < scene->part_count; p++) {
        int material = gltf->primitives[scene->parts[p].primitive].material;
        if (material >= 0 && (size_t)material < gltf->material_count)
            any = any || memcmp(gltf->colors[material], white, sizeof white) != 0;
    }
    if (!any)
        return HEWN_OK;
    HEWN_TRY(hewn_gltf_spend(&scene->data, scene->builder.model.face_count, sizeof white, error));
    HEWN_TRY(hewn_model_add_channel(&scene->builder.model, &info, &channel, error));
    for (size_t p = 0; p < scene->part_count; p++) {
        const hewn_gltf_part *part = &scene->parts[p];
        int material = gltf->primitives[part->primitive].material;
        bool has = material >= 0 && (size_t)material < gltf->material_count;
        for (uint64_t face = 0; face < part->face_count; face++)
            memcpy((float *)channel->values + 4 * (part->first_face + face), has ? gltf->colors[material] : white,
                   sizeof white);
    }
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static bool has_channel(const hewn_model *model, const char *name)
{
    return hewn_model_find_channel(model, HEWN_DOMAIN_VERT, name) ||
           hewn_model_find_channel(model, HEWN_DOMAIN_CORNER, name);
}

static hewn_result add_layers(hewn_gltf_scene *scene, bool *used, bool *seen, hewn_error *error)
{
    layer layers[MOST_LAYERS];
    size_t count;
    if (used)
        HEWN_TRY(mark_used(scene, used, error));
    HEWN_TRY(find_layers(scene, layers, &count, error));
    for (size_t i = 0; i < count; i++) {
        HEWN_TRY(find_type(scene, &layers[i], error));
        bool wanted = layers[i].components > 0 && (layers[i].everywhere || layers[i].semantic[0] != 'N');
        if (wanted && !has_channel(&scene->builder.model, layers[i].name)) /* "_uv" and "__uv" come to the same */
            HEWN_TRY(add_layer(scene, &layers[i], used, seen, error));
    }
    return HEWN_OK;
}

hewn_result hewn_gltf_add_channels(hewn_gltf_scene *scene, hewn_error *error)
{
    const hewn_model *model = &scene->builder.model;
    bool *used = NULL, *seen = NULL;
    if (model->vertex_count < scene->wedge_count) { /* else every wedge is a vertex of its own */
        used = hewn_alloc_zero(scene->wedge_count, sizeof *used);
        seen = hewn_alloc_zero(model->vertex_count, sizeof *seen);
        if (!used || !seen) {
            hewn_free(used);
            hewn_free(seen);
            return fail_memory(scene, error);
        }
    }
    hewn_result result = add_layers(scene, used, seen, error);
    hewn_free(used);
    hewn_free(seen);
    if (result == HEWN_OK)
        result = add_materials_if_named(scene, error);
    if (result == HEWN_OK && scene->instance_count > 1)
        result = add_objects(scene, error);
    if (result == HEWN_OK && scene->base_colors)
        result = add_base_colors(scene, error);
    return result;
}
