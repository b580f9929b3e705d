/* A progressive mesh as bytes. */
#include <string.h>
#include <zlib.h>

#include "base/alloc.h"
#include "base/text.h"
#include "progressive/block.h"
#include "progressive/stream.h"

/* --- numbers ------------------------------------------------------------------------------------------------------ */

static void put_low_first(hewn_text *to, uint64_t value, int bytes)
{
    char text[8];
    for (int i = 0; i < bytes; i++)
        text[i] = (char)(value >> (8 * i) & 0xff);
    hewn_text_append_bytes(to, text, (size_t)bytes);
}

/* Seven bits a byte, the low ones first; the eighth says that more come. */
static void put_varint(hewn_text *to, uint64_t value)
{
    char text[10];
    size_t length = 0;
    for (; value >= 0x80; value >>= 7)
        text[length++] = (char)(0x80 | (value & 0x7f));
    text[length++] = (char)value;
    hewn_text_append_bytes(to, text, length);
}

static void put_float(hewn_text *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_low_first(to, bits, 4);
}

static void put_double(hewn_text *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_low_first(to, bits, 8);
}

static void put_string(hewn_text *to, const char *string)
{
    const size_t length = strlen(string);
    put_varint(to, length);
    hewn_text_append_bytes(to, string, length);
}

/* A row of channels' values of a domain. */
static void put_row(const hewn_progressive *from, hewn_domain domain, const unsigned char *row, hewn_text *to)
{
    unsigned char values[16 * sizeof(double)];
    for (uint32_t i = 0; i < from->shape.channel_count; i++) {
        const hewn_attribute_info *info = &from->shape.channels[i].info;
        const size_t size = hewn_scalar_size(info->scalar);
        if (info->domain != domain)
            continue;
        progressive_copy_scalars(values, row, info->components, size);
        hewn_text_append_bytes(to, (const char *)values, info->components * size);
        row += info->components * size;
    }
}

/* Differences from one to the next, those below zero between those above. */
static void put_order(const uint32_t *numbers, size_t count, hewn_text *to)
{
    int64_t last = 0;
    for (size_t i = 0; i < count; i++) {
        const int64_t step = (int64_t)numbers[i] - last;
        put_varint(to, step < 0 ? 2 * (uint64_t)-step - 1 : 2 * (uint64_t)step);
        last = numbers[i];
    }
}

static void put_block(const char *type, const hewn_text *content, hewn_text *to)
{
    const size_t begin = to->length;
    hewn_text_append_bytes(to, type, 4);
    put_low_first(to, content->length, 8);
    hewn_text_append_bytes(to, content->bytes ? content->bytes : "", content->length);
    if (to->failed || content->failed) {
        to->failed = true;
        return;
    }
    put_low_first(to, crc32_z(0, (const unsigned char *)to->bytes + begin, to->length - begin), 4);
}

/* --- blocks ------------------------------------------------------------------------------------------------------- */

static bool has_float_positions(const hewn_progressive *from)
{
    for (size_t i = 0; i < 3 * from->vertex_count; i++)
        if ((double)(float)from->positions[i] != from->positions[i])
            return false;
    return true;
}

static void put_channels(const hewn_progressive *from, hewn_text *to)
{
    put_low_first(to, from->shape.channel_count, 4);
    for (uint32_t i = 0; i < from->shape.channel_count; i++) {
        const hewn_channel *channel = &from->shape.channels[i];
        put_low_first(to, (uint64_t)channel->info.domain, 1);
        put_low_first(to, (uint64_t)channel->info.scalar, 1);
        put_low_first(to, channel->info.components, 1);
        put_string(to, channel->info.name);
        put_varint(to, channel->name_count);
        for (uint32_t n = 0; n < channel->name_count; n++)
            put_string(to, channel->names[n]);
    }
}

static void put_head(const hewn_progressive *from, bool floats, hewn_text *to)
{
    const uint64_t counts[] = {from->full_vertices, from->full_wedges, from->full_triangles,
                               from->full_splits,   from->faces,       from->corners,
                               from->base_vertices, from->base_wedges, from->base_triangles};
    put_low_first(to,
                  (floats ? PROGRESSIVE_FLOATS : 0u) | (from->polygons ? PROGRESSIVE_POLYGONS : 0u) |
                      (from->shape.up_known ? PROGRESSIVE_UP_KNOWN : 0u),
                  1);
    put_low_first(to, (uint64_t)from->shape.up, 1);
    put_string(to, from->shape.unit ? from->shape.unit->name : "");
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        put_low_first(to, counts[i], 4);
    put_channels(from, to);
    put_low_first(to, from->mark_count, 4);
    for (uint32_t i = 0; i < from->mark_count; i++) {
        put_low_first(to, from->marks[i].splits, 4);
        put_low_first(to, from->marks[i].triangles, 4);
        put_double(to, from->marks[i].error);
        put_double(to, from->marks[i].error_low);
    }
}

static void put_vertex(const hewn_progressive *from, bool floats, size_t v, hewn_text *to)
{
    for (size_t axis = 0; axis < 3; axis++)
        if (floats)
            put_float(to, (float)from->positions[3 * v + axis]);
        else
            put_double(to, from->positions[3 * v + axis]);
    put_row(from, HEWN_DOMAIN_VERT, from->vertex_rows + v * from->row[HEWN_DOMAIN_VERT], to);
}

static void put_triangle(const hewn_progressive *from, size_t t, hewn_text *to)
{
    for (size_t k = 0; k < 3; k++)
        put_varint(to, from->triangles[3 * t + k]);
    put_row(from, HEWN_DOMAIN_FACE, from->triangle_rows + t * from->row[HEWN_DOMAIN_FACE], to);
}

static void put_wedge_row(const hewn_progressive *from, size_t w, hewn_text *to)
{
    put_row(from, HEWN_DOMAIN_CORNER, from->wedge_rows + w * from->row[HEWN_DOMAIN_CORNER], to);
}

static void put_base(const hewn_progressive *from, bool floats, hewn_text *to)
{
    for (size_t v = 0; v < from->base_vertices; v++)
        put_vertex(from, floats, v, to);
    for (size_t w = 0; from->corner_values && w < from->base_wedges; w++) {
        put_varint(to, from->wedge_vertices[w]);
        put_wedge_row(from, w, to);
    }
    for (size_t t = 0; t < from->base_triangles; t++)
        put_triangle(from, t, to);
}

static void put_split(const hewn_progressive *from, bool floats, size_t i, hewn_text *to)
{
    const progressive_split *split = &from->splits[i];
    const uint32_t wedge_end = progressive_wedges_at(from, i + 1), end = progressive_triangles_at(from, i + 1);
    const uint32_t change_end = progressive_changes_at(from, i + 1);
    put_varint(to, split->parent);
    put_float(to, split->error);
    put_vertex(from, floats, from->base_vertices + i, to);
    if (from->corner_values)
        put_varint(to, wedge_end - split->first_wedge);
    for (uint32_t w = split->first_wedge; from->corner_values && w < wedge_end; w++)
        put_wedge_row(from, w, to);
    put_varint(to, end - split->first_triangle);
    for (uint32_t t = split->first_triangle; t < end; t++)
        put_triangle(from, t, to);
    put_varint(to, change_end - split->first_change);
    uint32_t last = 0;
    for (uint32_t c = split->first_change; c < change_end; c++) {
        put_varint(to, from->changes[c].corner - last);
        last = from->changes[c].corner;
        if (from->corner_values)
            put_varint(to, from->changes[c].after - split->first_wedge);
    }
}

static void put_end(const hewn_progressive *from, hewn_text *to)
{
    put_order(from->vertex_origins, from->vertex_count, to);
    if (!from->polygons) {
        put_order(from->triangle_origins, from->triangle_count, to);
        return;
    }
    for (uint64_t f = 0; f < from->faces; f++) {
        put_varint(to, from->polygon_first[f + 1] - from->polygon_first[f]);
        for (uint64_t c = from->polygon_first[f]; c < from->polygon_first[f + 1]; c++)
            put_varint(to, from->polygon_wedges[c]);
        put_row(from, HEWN_DOMAIN_FACE, from->polygon_rows + f * from->row[HEWN_DOMAIN_FACE], to);
    }
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void finish(const char *type, hewn_text *content, hewn_text *to)
{
    put_block(type, content, to);
    content->length = 0;
}

static void put_splits(const hewn_progressive *from, bool floats, hewn_text *content, hewn_text *to)
{
    for (size_t i = 0; i < from->split_count;) {
        const size_t left = from->split_count - i;
        const size_t end = i + (left < PROGRESSIVE_BLOCK_SPLITS ? left : PROGRESSIVE_BLOCK_SPLITS);
        put_varint(content, end - i);
        for (; i < end; i++)
            put_split(from, floats, i, content);
        finish("SPLT", content, to);
    }
}

hewn_result hewn_progressive_encode(const hewn_progressive *progressive, char **bytes, size_t *length,
                                    hewn_error *error)
{
    hewn_text to = {0}, content = {0};
    const bool floats = has_float_positions(progressive);
    *bytes = NULL;
    *length = 0;
    hewn_text_append_bytes(&to, PROGRESSIVE_MAGIC, 8);
    put_low_first(&to, PROGRESSIVE_VERSION, 4);
    put_head(progressive, floats, &content);
    finish("HEAD", &content, &to);
    put_base(progressive, floats, &content);
    finish("BASE", &content, &to);
    put_splits(progressive, floats, &content, &to);
    if (progressive->complete) {
        put_end(progressive, &content);
        finish("ORDR", &content, &to);
    }
    to.failed |= content.failed;
    hewn_text_clear(&content);
    hewn_result result = hewn_text_status(&to, error);
    if (result != HEWN_OK) {
        hewn_text_clear(&to);
        return result;
    }
    *bytes = to.bytes;
    *length = to.length;
    return HEWN_OK;
}

void hewn_progressive_bytes_free(char *bytes)
{
    hewn_free(bytes);
}
