/* Stanford PLY, binary little-endian: polygons, and all channels under the names by which ply_layout.h knows them
 * again.
 */
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/text.h"
#include "io/bytes.h"
#include "io/ply_channels.h"
#include "io/remark.h"
#include "io/stream.h"

/* --- items -------------------------------------------------------------------------------------------------------- */

/* The values of elements `index` to `index + count - 1` of a channel. */
static char *put_values(const hewn_channel *channel, uint64_t index, uint64_t count, char *to)
{
    size_t components = channel->info.components, first = (size_t)index * components;
    size_t end = first + (size_t)count * components;
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT:
        for (size_t i = first; i < end; i++)
            to = hewn_put_float(to, ((const float *)channel->values)[i]);
        break;
    case HEWN_SCALAR_DOUBLE:
        for (size_t i = first; i < end; i++)
            to = hewn_put_double(to, ((const double *)channel->values)[i]);
        break;
    case HEWN_SCALAR_INT32:
        for (size_t i = first; i < end; i++)
            to = hewn_put_u32(to, (uint32_t)((const int32_t *)channel->values)[i]);
        break;
    case HEWN_SCALAR_UINT8:
        memcpy(to, (const uint8_t *)channel->values + first, end - first);
        return to + (end - first);
    }
    return to;
}

static size_t item_size(const hewn_channel *channel)
{
    return channel->info.components * hewn_scalar_size(channel->info.scalar);
}

static char *put_vertex(const hewn_writing *job, uint64_t v, char *to)
{
    for (uint64_t i = 3 * v; job->floats && i < 3 * v + 3; i++)
        to = hewn_put_float(to, job->floats[i]);
    for (uint64_t i = 3 * v; !job->floats && i < 3 * v + 3; i++)
        to = job->all_float ? hewn_put_float(to, (float)job->doubles[i]) : hewn_put_double(to, job->doubles[i]);
    for (uint32_t i = 0; i < job->channel_count; i++)
        if (job->channels[i].info.domain == HEWN_DOMAIN_VERT)
            to = put_values(&job->channels[i], v, 1, to);
    return to;
}

/* A list's length, as wide as the longest one of the file needs. */
static char *put_length(const hewn_writing *job, uint64_t length, uint32_t components, char *to)
{
    uint64_t longest = *(const uint64_t *)job->own * components;
    if (longest > UINT8_MAX)
        return hewn_put_u32(to, (uint32_t)(length * components));
    *to = (char)(length * components);
    return to + 1;
}

static char *put_face(const hewn_writing *job, uint64_t face, char *to)
{
    uint64_t first = hewn_writing_first(job, face), count = hewn_writing_first(job, face + 1) - first;
    to = put_length(job, count, 1, to);
    for (uint64_t k = first; k < first + count; k++)
        to = hewn_put_u32(to, job->corners[k]);
    for (uint32_t i = 0; i < job->channel_count; i++) {
        const hewn_channel *channel = &job->channels[i];
        if (channel->info.domain == HEWN_DOMAIN_FACE)
            to = put_values(channel, face, 1, to);
        if (channel->info.domain == HEWN_DOMAIN_CORNER) {
            to = put_length(job, count, channel->info.components, to);
            to = put_values(channel, first, count, to);
        }
    }
    return to;
}

static size_t face_room(const hewn_writing *job, uint64_t face)
{
    size_t head = 4, corner = 4;
    for (uint32_t i = 0; i < job->channel_count; i++) {
        const hewn_channel *channel = &job->channels[i];
        head += channel->info.domain == HEWN_DOMAIN_FACE ? item_size(channel) : 4;
        corner += channel->info.domain == HEWN_DOMAIN_CORNER ? item_size(channel) : 0;
    }
    return hewn_writing_face_room(job, face, head, corner);
}

/* --- header ------------------------------------------------------------------------------------------------------- */

static const char *type_name(hewn_scalar scalar)
{
    switch (scalar) {
    case HEWN_SCALAR_FLOAT: return "float";
    case HEWN_SCALAR_DOUBLE: return "double";
    case HEWN_SCALAR_UINT8: return "uchar";
    case HEWN_SCALAR_INT32: return "int";
    }
    return "";
}

/* `names` holds the names of an element's properties so far, each between two line ends. */
static bool has_name(const hewn_text *names, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = names->bytes; at && (at = strstr(at, name)); at++)
        if (at[-1] == '\n' && at[length] == '\n')
            return true;
    return false;
}

static void add_name(hewn_text *names, const char *name)
{
    hewn_text_print(names, "%s%s\n", names->length == 0 ? "\n" : "", name);
}

/* The properties by which other programs know a channel: so many names as it has components, or NULL. */
static const char *const *known_names(const hewn_attribute_info *info)
{
    static const char *const normal[] = {"nx", "ny", "nz"}, *const uv[] = {"s", "t"},
                             *const color[] = {"red", "green", "blue", "alpha"};
    bool real = info->scalar == HEWN_SCALAR_FLOAT || info->scalar == HEWN_SCALAR_DOUBLE;
    bool byte = info->scalar == HEWN_SCALAR_UINT8;
    if (strcmp(info->name, "normal") == 0 && info->components == 3 && real)
        return normal;
    if (strcmp(info->name, "color") == 0 && (info->components == 3 || info->components == 4) && (real || byte))
        return color;
    if (strcmp(info->name, "uv") == 0 && info->components == 2 && real && info->domain == HEWN_DOMAIN_VERT)
        return uv;
    return NULL;
}

/* Property `k` of a channel called `base`; for `base` NULL by its known name. */
static void property_name(const hewn_attribute_info *info, const char *base, uint32_t k, char *to, size_t room)
{
    if (!base)
        snprintf(to, room, "%s", known_names(info)[k]);
    else if (info->components == 1)
        snprintf(to, room, "%s", base);
    else
        snprintf(to, room, "%s_%u", base, k);
}

/* Whether all properties of a channel of that name are free, which are then taken. */
static bool take_names(hewn_text *names, const hewn_attribute_info *info, const char *base, char *spare, size_t room)
{
    for (uint32_t k = 0; k < info->components; k++) {
        property_name(info, base, k, spare, room);
        if (has_name(names, spare))
            return false;
    }
    for (uint32_t k = 0; k < info->components; k++) {
        property_name(info, base, k, spare, room);
        add_name(names, spare);
    }
    return true;
}

/* The channel's name as one word. */
static void clean_name(char *to, const char *prefix, const char *name)
{
    sprintf(to, "%s%s", prefix, name);
    for (char *at = to; *at; at++)
        if ((unsigned char)*at <= ' ' || *at == 0x7f || *at == '\\')
            *at = '_';
}

typedef struct head_maker {
    const hewn_writing *job;
    hewn_text *head;
    hewn_text names;
    bool out_of_memory;
} head_maker;

static void print_values(head_maker *maker, const hewn_channel *channel, const char *base, char *spare, size_t room)
{
    for (uint32_t k = 0; k < channel->info.components; k++) {
        property_name(&channel->info, base, k, spare, room);
        hewn_text_print(maker->head, "property %s %s\n", type_name(channel->info.scalar), spare);
    }
}

/* The names that an INT32 channel's values have, by the name that the channel will be read with. */
static void print_value_names(head_maker *maker, const hewn_channel *channel, const char *read_as)
{
    for (uint32_t i = 0; i < channel->name_count && channel->info.scalar == HEWN_SCALAR_INT32; i++) {
        hewn_text_print(maker->head, "comment value %s %s %u = ", hewn_ply_domain_name(channel->info.domain), read_as,
                        i);
        size_t begin = maker->head->length;
        hewn_text_append(maker->head, channel->names[i]);
        for (size_t k = begin; k < maker->head->length; k++)
            if (maker->head->bytes[k] == '\n' || maker->head->bytes[k] == '\r')
                maker->head->bytes[k] = ' ';
        hewn_text_append(maker->head, "\n");
    }
}

static void print_list(head_maker *maker, const hewn_channel *channel, char *base)
{
    const hewn_attribute_info *info = &channel->info;
    bool real = info->scalar == HEWN_SCALAR_FLOAT || info->scalar == HEWN_SCALAR_DOUBLE;
    bool texcoord = strcmp(info->name, "uv") == 0 && info->components == 2 && real;
    clean_name(base, texcoord ? "texcoord" : "corner_", texcoord ? "" : info->name);
    while (!texcoord && has_name(&maker->names, base)) /* that one is kept free */
        strcat(base, "_");
    add_name(&maker->names, base);
    bool wide = *(const uint64_t *)maker->job->own * info->components > UINT8_MAX;
    print_value_names(maker, channel, base + strlen("corner_"));
    hewn_text_print(maker->head, "property list %s %s %s\n", wide ? "int" : "uchar", type_name(info->scalar), base);
}

static void print_channel(head_maker *maker, const hewn_channel *channel)
{
    /* Names differ at the latest when there are more "_" than names. */
    size_t room = strlen(channel->info.name) + maker->job->channel_count * 16 + 64;
    char *base = hewn_alloc(room, 1), *spare = hewn_alloc(room, 1);
    maker->out_of_memory = maker->out_of_memory || !base || !spare;
    if (!maker->out_of_memory && channel->info.domain == HEWN_DOMAIN_CORNER) {
        print_list(maker, channel, base);
    } else if (!maker->out_of_memory) {
        bool known =
            known_names(&channel->info) != NULL && take_names(&maker->names, &channel->info, NULL, spare, room);
        clean_name(base, "", channel->info.name);
        while (!known && !take_names(&maker->names, &channel->info, base, spare, room))
            strcat(base, "_");
        print_value_names(maker, channel, base);
        print_values(maker, channel, known ? NULL : base, spare, room);
    }
    hewn_free(base);
    hewn_free(spare);
}

static void print_element(head_maker *maker, bool faces)
{
    const hewn_writing *job = maker->job;
    static const char *const taken[2][3] = {{"x", "y", "z"}, {"vertex_indices", "vertex_index", "texcoord"}};
    bool single = job->floats || job->all_float;
    hewn_text_clear(&maker->names);
    for (int i = 0; i < 3; i++)
        add_name(&maker->names, taken[faces][i]);
    if (faces)
        hewn_text_print(maker->head, "element face %llu\nproperty list %s int vertex_indices\n",
                        (unsigned long long)job->face_count, *(uint64_t *)job->own > UINT8_MAX ? "int" : "uchar");
    else
        hewn_text_print(maker->head, "element vertex %llu\nproperty %s x\nproperty %s y\nproperty %s z\n",
                        (unsigned long long)job->vertex_count, single ? "float" : "double", single ? "float" : "double",
                        single ? "float" : "double");
    for (uint32_t i = 0; i < job->channel_count; i++)
        if ((job->channels[i].info.domain != HEWN_DOMAIN_VERT) == faces)
            print_channel(maker, &job->channels[i]);
}

static hewn_result fits(const hewn_writing *job, hewn_error *error)
{
    if (job->vertex_count > (uint64_t)INT32_MAX + 1)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices are more than a PLY file's int indices can name",
                         (unsigned long long)job->vertex_count);
    return HEWN_OK;
}

/* The most corners that a face has, kept in `own`, say how wide the lengths of lists are. */
static hewn_result measure(hewn_writing *job, hewn_error *error)
{
    uint64_t *longest = hewn_alloc(1, sizeof *longest);
    if (!longest)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    job->own = longest;
    *longest = job->first ? 0 : job->each;
    for (uint64_t face = 0; job->first && face < job->face_count; face++)
        if (job->first[face + 1] - job->first[face] > *longest)
            *longest = job->first[face + 1] - job->first[face];
    for (uint32_t i = 0; i < job->channel_count; i++)
        if (*longest > INT32_MAX / job->channels[i].info.components)
            return hewn_fail(error, HEWN_LIMIT, "a face of %llu corners is more than a PLY file's lists can hold",
                             (unsigned long long)*longest);
    return HEWN_OK;
}

static hewn_result prepare(hewn_writing *job, hewn_error *error)
{
    HEWN_TRY(measure(job, error));
    hewn_text head = {0};
    head_maker maker = {.job = job, .head = &head};
    hewn_text_print(&head, "ply\nformat binary_little_endian 1.0\ncomment Hewn %s\ncomment ", hewn_version());
    hewn_remark_print(&head, job->unit, job->up_known ? &job->up : NULL, job->space);
    hewn_text_print(&head, "\ncomment object %s\n", job->name);
    print_element(&maker, false);
    print_element(&maker, true);
    hewn_text_append(&head, "end_header\n");
    hewn_result names = hewn_text_status(&maker.names, error);
    hewn_text_clear(&maker.names);
    job->head = head.bytes;
    job->head_length = head.length;
    if (maker.out_of_memory || names != HEWN_OK)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    return hewn_text_status(&head, error);
}

static hewn_result write(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    size_t room = 3 * sizeof(double);
    for (uint32_t i = 0; i < job->channel_count; i++)
        room += job->channels[i].info.domain == HEWN_DOMAIN_VERT ? item_size(&job->channels[i]) : 0;
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    hewn_stream vertices = {put_vertex, job->vertex_count, room, NULL, 0, 0.5, NULL};
    HEWN_TRY(hewn_stream_write(job, &vertices, output, error));
    hewn_stream faces = {put_face, job->face_count, 0, face_room, 0.5, 0.5, NULL};
    return hewn_stream_write(job, &faces, output, error);
}

static void release(hewn_writing *job)
{
    hewn_free(job->own);
    job->own = NULL;
}

const hewn_format_writer hewn_ply_writer = {
    .to_stdout = true, .fits = fits, .prepare = prepare, .write = write, .release = release};
