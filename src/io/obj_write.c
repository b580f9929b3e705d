/* Wavefront OBJ: v (with colours), vt, vn, o, g, usemtl, s and f.
 *
 * Numbers are as short as they read back exactly: positions of a model as doubles, those of triangle buffers as floats.
 * A reader that takes the latter for doubles gets numbers that round to the same floats, but for the rare text that
 * lies within a double's rounding of the middle between two floats. Channels of vertices are written in their order and
 * numbered like the vertices; of corners, each value once, in the order of first use. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/remark.h"
#include "io/shim/number.h"
#include "io/stream.h"

enum {
    VERTEX_ROOM = 4 + 6 * HEWN_NUMBER_ROOM,
    CORNER_ROOM = 3 + 3 * HEWN_NUMBER_ROOM,
    LABEL_ROOM = 10 + HEWN_NUMBER_ROOM,
    LABELS = 3
};

static const uint32_t NONE = 0xFFFFFFFFu;

/* Texture coordinates or normals. */
typedef struct obj_values {
    const hewn_channel *channel;
    uint32_t *of;     /* NULL: of vertices. Else the value that each corner has, */
    uint64_t *sample; /* and a corner that has each value */
    uint64_t count;
    size_t sample_room;
} obj_values;

typedef struct obj_own {
    const hewn_channel *color, *smooth, *labels[LABELS];
    obj_values uvs, normals;
} obj_own;

static const char *const label_names[LABELS] = {"object", "group", "material"};
static const char *const label_words[LABELS] = {"o", "g", "usemtl"};

/* --- numbers ------------------------------------------------------------------------------------------------------ */

static char *put_position(const hewn_writing *job, uint64_t v, char *to)
{
    for (int axis = 0; axis < 3; axis++) {
        *to++ = ' ';
        to = job->floats ? hewn_number_print_float(to, job->floats[3 * v + axis])
                         : hewn_number_print_double(to, job->doubles[3 * v + axis]);
    }
    return to;
}

/* Bytes are parts of 255. */
static char *put_components(const hewn_channel *channel, uint64_t index, uint32_t components, char *to)
{
    for (uint32_t k = 0; k < components; k++) {
        double value = hewn_channel_number(channel, index, k);
        *to++ = ' ';
        if (channel->info.scalar == HEWN_SCALAR_DOUBLE)
            to = hewn_number_print_double(to, value);
        else
            to = hewn_number_print_float(to, (float)(channel->info.scalar == HEWN_SCALAR_UINT8 ? value / 255 : value));
    }
    return to;
}

static char *put_vertex(const hewn_writing *job, uint64_t v, char *to)
{
    const obj_own *own = job->own;
    *to++ = 'v';
    to = put_position(job, v, to);
    if (own->color)
        to = put_components(own->color, v, 3, to);
    *to++ = '\n';
    return to;
}

static char *put_value(const obj_values *values, uint64_t i, char letter, char *to)
{
    *to++ = 'v';
    *to++ = letter;
    to = put_components(values->channel, values->of ? values->sample[i] : i, values->channel->info.components, to);
    *to++ = '\n';
    return to;
}

static char *put_uv(const hewn_writing *job, uint64_t i, char *to)
{
    return put_value(&((const obj_own *)job->own)->uvs, i, 't', to);
}

static char *put_normal(const hewn_writing *job, uint64_t i, char *to)
{
    return put_value(&((const obj_own *)job->own)->normals, i, 'n', to);
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

static int32_t label_of(const hewn_channel *channel, uint64_t face)
{
    return channel ? ((const int32_t *)channel->values)[face] : 0;
}

/* Whether a face needs a statement first: a first face without a name, or that is not smooth, needs none. */
static bool is_new_label(const hewn_channel *channel, uint64_t face, int32_t usual)
{
    int32_t value = label_of(channel, face);
    if (!channel)
        return false;
    return face > 0 ? value != label_of(channel, face - 1) : usual == 0 ? value != 0 : value >= 0;
}

static const char *name_of(const hewn_channel *channel, int32_t value)
{
    return value >= 0 && (uint32_t)value < channel->name_count ? channel->names[value] : NULL;
}

/* A name stands in one line. It does not end with what a reader would take for a continued line. */
static char *put_name(const char *name, char *to)
{
    for (; *name; name++)
        *to++ = (unsigned char)*name < 0x20 || *name == 0x7f ? ' ' : *name;
    if (to[-1] == '\\')
        to[-1] = '_';
    return to;
}

/* A value that has no name goes by its number, and below 0 it is none. */
static char *put_label(const hewn_channel *channel, uint64_t face, const char *word, char *to)
{
    int32_t value = label_of(channel, face);
    const char *name = name_of(channel, value);
    size_t length = strlen(word);
    memcpy(to, word, length);
    to += length;
    if (value >= 0)
        *to++ = ' ';
    if (name)
        to = put_name(name, to);
    else if (value >= 0)
        to = hewn_number_print_unsigned(to, (uint64_t)value);
    *to++ = '\n';
    return to;
}

static char *put_smooth(const hewn_channel *channel, uint64_t face, char *to)
{
    uint32_t value = (uint32_t)label_of(channel, face);
    *to++ = 's';
    *to++ = ' ';
    to = hewn_number_print_unsigned(to, value);
    *to++ = '\n';
    return to;
}

static uint64_t number_of(const hewn_writing *job, const obj_values *values, uint64_t corner)
{
    return (uint64_t)(values->of ? values->of[corner] : job->corners[corner]) + 1;
}

static char *put_corner(const hewn_writing *job, const obj_own *own, uint64_t corner, char *to)
{
    *to++ = ' ';
    to = hewn_number_print_unsigned(to, (uint64_t)job->corners[corner] + 1);
    if (own->uvs.channel || own->normals.channel)
        *to++ = '/';
    if (own->uvs.channel)
        to = hewn_number_print_unsigned(to, number_of(job, &own->uvs, corner));
    if (own->normals.channel) {
        *to++ = '/';
        to = hewn_number_print_unsigned(to, number_of(job, &own->normals, corner));
    }
    return to;
}

static char *put_face(const hewn_writing *job, uint64_t face, char *to)
{
    const obj_own *own = job->own;
    for (int i = 0; i < LABELS; i++)
        if (is_new_label(own->labels[i], face, -1))
            to = put_label(own->labels[i], face, label_words[i], to);
    if (is_new_label(own->smooth, face, 0))
        to = put_smooth(own->smooth, face, to);
    *to++ = 'f';
    uint64_t end = hewn_writing_first(job, face + 1);
    for (uint64_t corner = hewn_writing_first(job, face); corner < end; corner++)
        to = put_corner(job, own, corner, to);
    *to++ = '\n';
    return to;
}

static size_t face_room(const hewn_writing *job, uint64_t face)
{
    const obj_own *own = job->own;
    size_t labels = LABEL_ROOM;
    for (int i = 0; i < LABELS; i++)
        if (is_new_label(own->labels[i], face, -1)) {
            const char *name = name_of(own->labels[i], label_of(own->labels[i], face));
            labels += LABEL_ROOM + (name ? strlen(name) : 0);
        }
    return hewn_writing_face_room(job, face, 4 + labels, CORNER_ROOM);
}

/* --- sharing the values of corners -------------------------------------------------------------------------------- */

/* An open-addressing table of values by their bits. */
typedef struct value_table {
    uint32_t *slots;
    uint64_t mask;
} value_table;

static const char *bits_of(const hewn_channel *channel, uint64_t corner)
{
    return (const char *)channel->values + corner * channel->info.components * hewn_scalar_size(channel->info.scalar);
}

static uint32_t *find_slot(const value_table *table, const obj_values *values, uint64_t corner)
{
    size_t size = values->channel->info.components * hewn_scalar_size(values->channel->info.scalar);
    const char *wanted = bits_of(values->channel, corner);
    uint64_t at = hewn_hash_bytes(hewn_hash_begin(), wanted, size).a & table->mask;
    while (table->slots[at] != NONE &&
           memcmp(bits_of(values->channel, values->sample[table->slots[at]]), wanted, size) != 0)
        at = (at + 1) & table->mask;
    return &table->slots[at];
}

static hewn_result grow_table(value_table *table, const obj_values *values, hewn_error *error)
{
    uint64_t room = table->slots ? 2 * (table->mask + 1) : 1024;
    uint32_t *slots = hewn_realloc(table->slots, room, sizeof *slots);
    if (!slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    *table = (value_table){slots, room - 1};
    memset(slots, 0xff, room * sizeof *slots);
    for (uint64_t i = 0; i < values->count; i++)
        *find_slot(table, values, values->sample[i]) = (uint32_t)i;
    return HEWN_OK;
}

static hewn_result number_corners(obj_values *values, value_table *table, uint64_t corner_count, hewn_error *error)
{
    for (uint64_t corner = 0; corner < corner_count; corner++) {
        if (!table->slots || 2 * values->count > table->mask)
            HEWN_TRY(grow_table(table, values, error));
        uint32_t *slot = find_slot(table, values, corner);
        if (*slot == NONE) {
            void *items = values->sample;
            HEWN_TRY(hewn_reserve(&items, &values->sample_room, values->count + 1, sizeof *values->sample, error));
            values->sample = items;
            values->sample[values->count] = corner;
            *slot = (uint32_t)values->count++;
        }
        values->of[corner] = *slot;
    }
    return HEWN_OK;
}

static hewn_result share_values(const hewn_writing *job, obj_values *values, hewn_error *error)
{
    value_table table = {0};
    if (job->corner_count >= NONE)
        return hewn_fail(error, HEWN_LIMIT, "%llu corners are more than their values can be numbered for",
                         (unsigned long long)job->corner_count);
    values->of = hewn_alloc(job->corner_count, sizeof *values->of);
    if (!values->of)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    hewn_result result = number_corners(values, &table, job->corner_count, error);
    hewn_free(table.slots);
    return result;
}

/* --- the file ----------------------------------------------------------------------------------------------------- */

static const hewn_channel *find_channel(const hewn_writing *job, hewn_domain domain, const char *name, uint32_t least,
                                        uint32_t most)
{
    const hewn_channel *channel = hewn_writing_channel(job, domain, name);
    return channel && channel->info.components >= least && channel->info.components <= most ? channel : NULL;
}

static const hewn_channel *find_labels(const hewn_writing *job, const char *name)
{
    const hewn_channel *channel = find_channel(job, HEWN_DOMAIN_FACE, name, 1, 1);
    return channel && channel->info.scalar == HEWN_SCALAR_INT32 ? channel : NULL;
}

/* Those of corners say more than those of vertices. */
static hewn_result find_values(const hewn_writing *job, const char *name, uint32_t components, obj_values *values,
                               hewn_error *error)
{
    values->channel = find_channel(job, HEWN_DOMAIN_CORNER, name, components, components);
    if (values->channel)
        return share_values(job, values, error);
    values->channel = find_channel(job, HEWN_DOMAIN_VERT, name, components, components);
    values->count = values->channel ? job->vertex_count : 0;
    return HEWN_OK;
}

/* A model says itself what its objects are; triangles are one. */
static hewn_result make_head(hewn_writing *job, hewn_error *error)
{
    hewn_text head = {0};
    hewn_text_print(&head, "# Hewn %s\n# ", hewn_version());
    hewn_remark_print(&head, job->unit, job->up_known ? &job->up : NULL, job->space);
    hewn_text_append(&head, "\n");
    if (!job->doubles)
        hewn_text_print(&head, "o %s\n", job->name);
    job->head = head.bytes;
    job->head_length = head.length;
    return hewn_text_status(&head, error);
}

static hewn_result prepare(hewn_writing *job, hewn_error *error)
{
    obj_own *own = hewn_alloc_zero(1, sizeof *own);
    if (!own)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    job->own = own;
    own->color = find_channel(job, HEWN_DOMAIN_VERT, "color", 3, 4);
    for (int i = 0; i < LABELS; i++)
        own->labels[i] = find_labels(job, label_names[i]);
    own->smooth = find_labels(job, "smooth");
    HEWN_TRY(find_values(job, "uv", 2, &own->uvs, error));
    HEWN_TRY(find_values(job, "normal", 3, &own->normals, error));
    return make_head(job, error);
}

static hewn_result write(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    const obj_own *own = job->own;
    const hewn_stream streams[] = {
        {put_vertex, job->vertex_count, VERTEX_ROOM, NULL, 0, 0.3, NULL},
        {put_uv, own->uvs.count, VERTEX_ROOM, NULL, 0.3, 0.1, NULL},
        {put_normal, own->normals.count, VERTEX_ROOM, NULL, 0.4, 0.2, NULL},
        {put_face, job->face_count, 0, face_room, 0.6, 0.4, NULL},
    };
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    for (size_t i = 0; i < sizeof streams / sizeof *streams; i++)
        HEWN_TRY(hewn_stream_write(job, &streams[i], output, error));
    return HEWN_OK;
}

static void release(hewn_writing *job)
{
    obj_own *own = job->own;
    if (!own)
        return;
    hewn_free(own->uvs.of);
    hewn_free(own->uvs.sample);
    hewn_free(own->normals.of);
    hewn_free(own->normals.sample);
    hewn_free(own);
    job->own = NULL;
}

const hewn_format_writer hewn_obj_writer = {.to_stdout = true, .prepare = prepare, .write = write, .release = release};
