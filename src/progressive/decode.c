/* The way back from bytes. No number is believed before it was compared with what is there. */
#include <math.h>
#include <string.h>
#include <zlib.h>

#include "base/alloc.h"
#include "progressive/block.h"
#include "progressive/stream.h"

/* Reading stops at the first fault; what is read after it is 0. */
typedef struct reader {
    const unsigned char *at, *end; /* of the block */
    const unsigned char *bytes;    /* of the file */
    const char *fault;             /* NULL: none yet */
    uint64_t fault_at;
    const char *name;
    hewn_progressive *to;
    bool floats;
    uint32_t *current; /* the wedges of triangles' corners as they are now */
    size_t current_room;
} reader;

static void find_fault(reader *from, const char *fault)
{
    if (from->fault)
        return;
    from->fault = fault;
    from->fault_at = (uint64_t)(from->at - from->bytes);
    from->at = from->end;
}

static hewn_result status(const reader *from, hewn_error *error)
{
    if (!from->fault)
        return HEWN_OK;
    return hewn_fail_at(error, HEWN_BAD_INPUT, from->name, 0, "byte %llu: %s", (unsigned long long)from->fault_at,
                        from->fault);
}

static size_t left(const reader *from)
{
    return (size_t)(from->end - from->at);
}

/* --- numbers ------------------------------------------------------------------------------------------------------ */

static uint64_t get_low_first(reader *from, size_t bytes)
{
    uint64_t value = 0;
    if (left(from) < bytes) {
        find_fault(from, "a block ends in the middle of a number");
        return 0;
    }
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)from->at[i] << (8 * i);
    from->at += bytes;
    return value;
}

static uint32_t get_varint(reader *from)
{
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
        const uint64_t byte = get_low_first(from, 1);
        value |= (byte & 0x7f) << shift;
        if (byte < 0x80 && value <= UINT32_MAX)
            return (uint32_t)value;
    }
    find_fault(from, "a number is larger than 32 bits hold");
    return 0;
}

/* A number below `bound`, which names something that is there. */
static uint32_t get_index(reader *from, uint64_t bound, const char *fault)
{
    const uint32_t value = get_varint(from);
    if (value < bound)
        return value;
    find_fault(from, fault);
    return 0;
}

static float get_float(reader *from)
{
    const uint32_t bits = (uint32_t)get_low_first(from, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double get_double(reader *from)
{
    const uint64_t bits = get_low_first(from, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void get_row(reader *from, hewn_domain domain, unsigned char *row)
{
    const hewn_progressive *to = from->to;
    if (left(from) < to->row[domain]) {
        find_fault(from, "a block ends in the middle of attributes");
        return;
    }
    for (uint32_t i = 0; i < to->shape.channel_count; i++) {
        const hewn_attribute_info *info = &to->shape.channels[i].info;
        const size_t size = hewn_scalar_size(info->scalar), bytes = info->components * size;
        if (info->domain != domain)
            continue;
        progressive_copy_scalars(row, from->at, info->components, size);
        from->at += bytes;
        row += bytes;
    }
}

/* A string of at most so many bytes, without a NUL in it. The caller's; NULL after a fault or without memory. */
static char *get_string(reader *from, size_t most)
{
    const size_t length = get_varint(from);
    if (from->fault)
        return NULL;
    if (length > most || length > left(from) || memchr(from->at, 0, length)) {
        find_fault(from, "a name is too long or has a zero byte");
        return NULL;
    }
    char *string = hewn_alloc(length + 1, 1);
    if (!string)
        return NULL;
    memcpy(string, from->at, length);
    string[length] = '\0';
    from->at += length;
    return string;
}

/* --- blocks ------------------------------------------------------------------------------------------------------- */

typedef enum arrival { AT_BLOCK, AT_END, AT_CUT } arrival;

/* Goes to the next block, whose content is then between `at` and `end`; `type` gets its type. */
static arrival next_block(reader *from, const unsigned char *end, char type[5], hewn_error *error, hewn_result *result)
{
    const unsigned char *begin = from->at;
    *result = HEWN_OK;
    type[0] = '\0';
    if (begin == end)
        return AT_END;
    from->end = end;
    if (left(from) < PROGRESSIVE_BLOCK_HEAD)
        return AT_CUT;
    memcpy(type, begin, 4);
    type[4] = '\0';
    from->at += 4;
    const uint64_t length = get_low_first(from, 8);
    if (length > left(from) || left(from) - length < PROGRESSIVE_BLOCK_TAIL) {
        from->at = begin;
        return AT_CUT;
    }
    from->at += length;
    const uint32_t sum = (uint32_t)crc32_z(0, begin, (size_t)(from->at - begin));
    if (get_low_first(from, 4) != sum) {
        from->at = begin;
        find_fault(from, "the checksum of a block is wrong: the file is damaged");
        *result = status(from, error);
        return AT_CUT;
    }
    from->at = begin + PROGRESSIVE_BLOCK_HEAD;
    from->end = from->at + length;
    return AT_BLOCK;
}

/* All of a block must have been read. */
static hewn_result leave_block(reader *from, hewn_error *error)
{
    if (!from->fault && from->at != from->end)
        find_fault(from, "a block is longer than what it should hold");
    HEWN_TRY(status(from, error));
    from->at += PROGRESSIVE_BLOCK_TAIL;
    return HEWN_OK;
}

/* --- head --------------------------------------------------------------------------------------------------------- */

static hewn_result get_channel(reader *from, hewn_error *error)
{
    hewn_attribute_info info = {.domain = (hewn_domain)get_low_first(from, 1),
                                .scalar = (hewn_scalar)get_low_first(from, 1),
                                .components = (uint32_t)get_low_first(from, 1)};
    hewn_channel *channel;
    int32_t value;
    char *name = get_string(from, 65535);
    HEWN_TRY(status(from, error));
    if (!name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    info.name = name;
    hewn_result result = hewn_model_add_channel(&from->to->shape, &info, &channel, error);
    hewn_free(name);
    if (result == HEWN_INVALID_ARGUMENT)
        find_fault(from, "an attribute has a name that is taken, or a kind that does not exist");
    if (from->fault)
        return status(from, error);
    HEWN_TRY(result);
    for (uint32_t count = get_varint(from), i = 0; i < count && !from->fault; i++) {
        name = get_string(from, 65535);
        HEWN_TRY(status(from, error));
        result = name ? hewn_channel_value(channel, name, &value, error)
                      : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
        hewn_free(name);
        if (result == HEWN_OK && value != (int32_t)i)
            find_fault(from, "two values of an attribute have one name");
        HEWN_TRY(result);
    }
    return status(from, error);
}

/* What the counts say together; each is below 2^30. */
static void check_counts(reader *from)
{
    const hewn_progressive *to = from->to;
    bool right = to->full_vertices == to->base_vertices + to->full_splits && to->base_wedges <= to->full_wedges &&
                 to->base_triangles <= to->full_triangles;
    right &= to->corner_values || (to->full_wedges == to->full_vertices && to->base_wedges == to->base_vertices);
    right &= to->polygons || (to->faces == to->full_triangles && to->corners == 3 * to->faces);
    right &= to->full_triangles <= to->base_triangles + 2 * to->full_splits;
    if (!right)
        find_fault(from, "the counts in the head contradict each other");
}

static void get_counts(reader *from)
{
    hewn_progressive *to = from->to;
    uint64_t *const wide[] = {&to->full_vertices, &to->full_wedges, &to->full_triangles,
                              &to->full_splits,   &to->faces,       &to->corners};
    uint32_t *const narrow[] = {&to->base_vertices, &to->base_wedges, &to->base_triangles};
    for (size_t i = 0; i < 9; i++) {
        const uint64_t count = get_low_first(from, 4);
        if (count > UINT32_MAX / 4)
            find_fault(from, "a count in the head is larger than a progressive mesh can be");
        if (i < 6)
            *wide[i] = count;
        else
            *narrow[i - 6] = (uint32_t)count;
    }
}

static hewn_result get_marks(reader *from, hewn_error *error)
{
    hewn_progressive *to = from->to;
    const uint64_t count = get_low_first(from, 4);
    if (count > 64)
        find_fault(from, "more marks than halvings of a mesh");
    HEWN_TRY(status(from, error));
    to->marks = hewn_alloc_zero(count, sizeof *to->marks);
    if (!to->marks)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    to->mark_count = (uint32_t)count;
    for (uint64_t i = 0; i < count; i++) {
        hewn_progressive_mark *mark = &to->marks[i];
        mark->splits = get_low_first(from, 4);
        mark->triangles = get_low_first(from, 4);
        mark->error = get_double(from);
        mark->error_low = get_double(from);
        if (mark->splits > to->full_splits || (i > 0 && mark->splits <= to->marks[i - 1].splits) ||
            !(mark->error >= 0 && isfinite(mark->error)) || !(mark->error_low >= 0 && mark->error_low <= mark->error))
            find_fault(from, "a mark is out of order or its error no length");
    }
    return status(from, error);
}

static hewn_result get_head(reader *from, hewn_error *error)
{
    hewn_progressive *to = from->to;
    const uint64_t flags = get_low_first(from, 1), up = get_low_first(from, 1);
    char *unit = get_string(from, 16);
    if (!from->fault && (flags > 7 || up > HEWN_AXIS_PLUS_X))
        find_fault(from, "the head has flags or an axis that are not known");
    if (unit && unit[0] && !(to->shape.unit = hewn_unit_find(unit)))
        find_fault(from, "the head has a unit that is not known");
    hewn_free(unit);
    HEWN_TRY(status(from, error));
    from->floats = flags & PROGRESSIVE_FLOATS;
    to->polygons = flags & PROGRESSIVE_POLYGONS;
    to->shape.up_known = flags & PROGRESSIVE_UP_KNOWN;
    to->shape.up = (hewn_axis)up;
    get_counts(from);
    for (uint64_t count = get_low_first(from, 4), i = 0; i < count && !from->fault; i++)
        HEWN_TRY(get_channel(from, error));
    HEWN_TRY(status(from, error));
    hewn_progressive_find_rows(to);
    check_counts(from);
    HEWN_TRY(status(from, error));
    HEWN_TRY(get_marks(from, error));
    return leave_block(from, error);
}

/* --- vertices and triangles --------------------------------------------------------------------------------------- */

/* Room must be there. */
static void get_vertex(reader *from)
{
    hewn_progressive *to = from->to;
    const size_t v = to->vertex_count++;
    for (size_t axis = 0; axis < 3; axis++) {
        const double value = from->floats ? (double)get_float(from) : get_double(from);
        if (!isfinite(value))
            find_fault(from, "a position is not finite");
        to->positions[3 * v + axis] = value;
    }
    get_row(from, HEWN_DOMAIN_VERT, to->vertex_rows + v * to->row[HEWN_DOMAIN_VERT]);
}

static void get_wedge(reader *from, uint32_t vertex)
{
    hewn_progressive *to = from->to;
    const size_t w = to->wedge_count++;
    to->wedge_vertices[w] = vertex;
    if (to->corner_values)
        get_row(from, HEWN_DOMAIN_CORNER, to->wedge_rows + w * to->row[HEWN_DOMAIN_CORNER]);
}

static void get_triangle(reader *from)
{
    hewn_progressive *to = from->to;
    const size_t t = to->triangle_count++;
    for (size_t k = 0; k < 3; k++)
        from->current[3 * t + k] = to->triangles[3 * t + k] =
            get_index(from, to->wedge_count, "a triangle has a corner that does not exist");
    get_row(from, HEWN_DOMAIN_FACE, to->triangle_rows + t * to->row[HEWN_DOMAIN_FACE]);
}

static hewn_result make_room(reader *from, size_t vertices, size_t wedges, size_t triangles, hewn_error *error)
{
    hewn_progressive *to = from->to;
    HEWN_TRY(hewn_progressive_grow(to, vertices, wedges, triangles, error));
    return hewn_reserve((void **)&from->current, &from->current_room, 3 * (to->triangle_count + triangles),
                        sizeof *from->current, error);
}

static hewn_result get_base(reader *from, hewn_error *error)
{
    hewn_progressive *to = from->to;
    const uint64_t vertex = (from->floats ? 12 : 24) + to->row[HEWN_DOMAIN_VERT];
    const uint64_t wedge = to->corner_values ? 1 + to->row[HEWN_DOMAIN_CORNER] : 0;
    const uint64_t needed = to->base_vertices * vertex + to->base_wedges * wedge +
                            to->base_triangles * (3 + (uint64_t)to->row[HEWN_DOMAIN_FACE]);
    if (needed > left(from))
        find_fault(from, "the base is shorter than its vertices and triangles need");
    HEWN_TRY(status(from, error));
    HEWN_TRY(make_room(from, to->base_vertices, to->base_wedges, to->base_triangles, error));
    for (uint32_t v = 0; v < to->base_vertices && !from->fault; v++)
        get_vertex(from);
    for (uint32_t w = 0; w < to->base_wedges && !from->fault; w++)
        get_wedge(from, to->corner_values
                            ? get_index(from, to->vertex_count, "a corner belongs to a vertex that does not exist")
                            : w);
    for (uint32_t t = 0; t < to->base_triangles && !from->fault; t++)
        get_triangle(from);
    return leave_block(from, error);
}

/* --- splits ------------------------------------------------------------------------------------------------------- */

/* A triangle that a split adds has both of its ends and a third vertex. */
static void check_triangle(reader *from, uint32_t parent, uint32_t vertex)
{
    const hewn_progressive *to = from->to;
    uint32_t v[3];
    unsigned parents = 0, vertices = 0;
    for (size_t k = 0; k < 3; k++) {
        v[k] = to->wedge_vertices[to->triangles[3 * (to->triangle_count - 1) + k]];
        parents += v[k] == parent;
        vertices += v[k] == vertex;
    }
    if (parents != 1 || vertices != 1)
        find_fault(from, "a triangle that a split adds is not at the edge that it opens");
}

static void get_changes(reader *from, uint32_t parent, uint32_t first_wedge, uint32_t first_triangle, uint32_t count)
{
    hewn_progressive *to = from->to;
    uint64_t corner = 0;
    for (uint32_t i = 0; i < count && !from->fault; i++) {
        const uint32_t step = get_varint(from);
        corner += step;
        if ((i > 0 && step == 0) || corner >= 3 * (uint64_t)first_triangle ||
            to->wedge_vertices[from->current[corner]] != parent) {
            find_fault(from, "a split changes a corner that is not its parent's");
            return;
        }
        const uint32_t offset = to->corner_values ? get_index(from, to->wedge_count - first_wedge,
                                                              "a split gives a corner that does not exist")
                                                  : 0;
        to->changes[to->change_count++] =
            (progressive_change){(uint32_t)corner, from->current[corner], first_wedge + offset};
        from->current[corner] = first_wedge + offset;
    }
}

static hewn_result get_split(reader *from, hewn_error *error)
{
    hewn_progressive *to = from->to;
    const uint32_t vertex = (uint32_t)to->vertex_count;
    HEWN_TRY(make_room(from, 1, 0, 0, error));
    HEWN_TRY(hewn_progressive_grow_splits(to, 1, 0, error));
    progressive_split split = {.parent = get_index(from, vertex, "a split's parent does not exist"),
                               .error = get_float(from),
                               .first_wedge = (uint32_t)to->wedge_count,
                               .first_triangle = (uint32_t)to->triangle_count,
                               .first_change = (uint32_t)to->change_count};
    if (!(split.error >= 0) || isinf(split.error))
        find_fault(from, "a split's error is no length");
    get_vertex(from);
    const uint32_t wedges = to->corner_values ? get_varint(from) : 1;
    if (wedges < 1 || (to->corner_values && wedges > left(from) / to->row[HEWN_DOMAIN_CORNER]))
        find_fault(from, "a split has a number of corners that cannot be");
    HEWN_TRY(status(from, error));
    HEWN_TRY(make_room(from, 0, wedges, 2, error));
    for (uint32_t w = 0; w < wedges; w++)
        get_wedge(from, vertex);
    const uint32_t triangles = get_varint(from);
    if (triangles < 1 || triangles > 2)
        find_fault(from, "a split adds neither one triangle nor two");
    for (uint32_t t = 0; t < triangles && !from->fault; t++) {
        get_triangle(from);
        check_triangle(from, split.parent, vertex);
    }
    const uint32_t changes = get_varint(from);
    if (changes > left(from))
        find_fault(from, "a split changes more corners than the block has bytes for");
    HEWN_TRY(status(from, error));
    HEWN_TRY(hewn_progressive_grow_splits(to, 1, changes, error));
    to->splits[to->split_count++] = split;
    get_changes(from, split.parent, split.first_wedge, split.first_triangle, changes);
    return status(from, error);
}

static hewn_result get_splits(reader *from, hewn_error *error)
{
    const hewn_progressive *to = from->to;
    const uint32_t count = get_varint(from);
    if (count > to->full_splits - to->split_count)
        find_fault(from, "there are more splits than the head says");
    for (uint32_t i = 0; i < count && !from->fault; i++)
        HEWN_TRY(get_split(from, error));
    return leave_block(from, error);
}

/* --- the input's own order ---------------------------------------------------------------------------------------- */

/* Numbers of which each from 0 on comes once; the caller's. */
static hewn_result get_order(reader *from, size_t count, uint32_t **out, hewn_error *error)
{
    uint8_t *seen = hewn_alloc_zero(count, 1);
    int64_t last = 0;
    *out = hewn_alloc(count, sizeof **out);
    for (size_t i = 0; seen && *out && i < count && !from->fault; i++) {
        const int64_t step = get_varint(from);
        last += step % 2 ? -(step + 1) / 2 : step / 2;
        if (last < 0 || last >= (int64_t)count || seen[last])
            find_fault(from, "the order of the input names an element twice, or one that does not exist");
        else
            seen[last] = 1;
        (*out)[i] = (uint32_t)last;
    }
    const bool made = seen && *out;
    hewn_free(seen);
    HEWN_TRY(status(from, error));
    return made ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
}

static hewn_result get_polygons(reader *from, hewn_error *error)
{
    hewn_progressive *to = from->to;
    if (to->faces > left(from) || to->corners > left(from) ||
        to->faces * (uint64_t)to->row[HEWN_DOMAIN_FACE] > left(from))
        find_fault(from, "the block is shorter than the polygons need");
    HEWN_TRY(status(from, error));
    to->polygon_first = hewn_alloc_zero(to->faces + 1, sizeof *to->polygon_first);
    to->polygon_wedges = hewn_alloc(to->corners, sizeof *to->polygon_wedges);
    to->polygon_rows = hewn_alloc(to->faces, to->row[HEWN_DOMAIN_FACE]);
    if (!to->polygon_first || !to->polygon_wedges || !to->polygon_rows)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    uint64_t corner = 0;
    for (uint64_t f = 0; f < to->faces && !from->fault; f++) {
        const uint32_t count = get_varint(from);
        if (count > to->corners - corner)
            find_fault(from, "polygons have more corners than the head says");
        for (uint32_t k = 0; k < count && !from->fault; k++)
            to->polygon_wedges[corner++] =
                get_index(from, to->wedge_count, "a polygon has a corner that does not exist");
        to->polygon_first[f + 1] = corner;
        get_row(from, HEWN_DOMAIN_FACE, to->polygon_rows + f * to->row[HEWN_DOMAIN_FACE]);
    }
    if (corner != to->corners)
        find_fault(from, "polygons have fewer corners than the head says");
    return status(from, error);
}

static hewn_result get_end(reader *from, hewn_error *error)
{
    hewn_progressive *to = from->to;
    if (to->split_count != to->full_splits || to->wedge_count != to->full_wedges ||
        to->triangle_count != to->full_triangles)
        find_fault(from, "the splits are not those that the head says");
    HEWN_TRY(status(from, error));
    if (to->vertex_count > left(from))
        find_fault(from, "the block is shorter than the order of the vertices needs");
    HEWN_TRY(status(from, error));
    HEWN_TRY(get_order(from, to->vertex_count, &to->vertex_origins, error));
    if (to->polygons) {
        HEWN_TRY(get_polygons(from, error));
    } else {
        if (to->triangle_count > left(from))
            find_fault(from, "the block is shorter than the order of the triangles needs");
        HEWN_TRY(status(from, error));
        HEWN_TRY(get_order(from, to->triangle_count, &to->triangle_origins, error));
    }
    HEWN_TRY(leave_block(from, error));
    to->complete = true;
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

/* Blocks come in this order: HEAD, BASE, any number of SPLT, ORDR. `*stage` counts what was there. */
static hewn_result get_block(reader *from, const char *type, int *stage, hewn_error *error)
{
    if (*stage == 0 && strcmp(type, "HEAD") == 0)
        return ++*stage, get_head(from, error);
    if (*stage == 1 && strcmp(type, "BASE") == 0)
        return ++*stage, get_base(from, error);
    if (*stage == 2 && strcmp(type, "SPLT") == 0)
        return get_splits(from, error);
    if (*stage == 2 && strcmp(type, "ORDR") == 0)
        return ++*stage, get_end(from, error);
    find_fault(from, "a block of unknown type, or one that does not belong here");
    return status(from, error);
}

static hewn_result cut_off(const reader *from, int stage, bool partial, hewn_error *error)
{
    const unsigned long long at = (unsigned long long)(from->at - from->bytes);
    if (stage < 2)
        return hewn_fail_at(error, HEWN_BAD_INPUT, from->name, 0,
                            "the file ends before its base is there (block at byte %llu)", at);
    if (partial)
        return HEWN_OK;
    return hewn_fail_at(error, HEWN_BAD_INPUT, from->name, 0,
                        "the file is cut off in the block at byte %llu; %llu of its %llu splits are whole", at,
                        (unsigned long long)from->to->split_count, (unsigned long long)from->to->full_splits);
}

static hewn_result get_all(reader *from, size_t length, bool partial, hewn_error *error)
{
    const unsigned char *end = from->bytes + length;
    char type[5];
    int stage = 0;
    hewn_result result;
    if (length < PROGRESSIVE_START || memcmp(from->bytes, PROGRESSIVE_MAGIC, 8) != 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, from->name, 0,
                            "this is no progressive mesh: it does not begin as one");
    from->at = from->bytes + 8;
    from->end = end;
    const uint64_t version = get_low_first(from, 4);
    if (version != PROGRESSIVE_VERSION)
        return hewn_fail_at(error, HEWN_BAD_INPUT, from->name, 0,
                            "version %llu of the format is not known, only version %d", (unsigned long long)version,
                            PROGRESSIVE_VERSION);
    for (;;) {
        const arrival found = next_block(from, end, type, error, &result);
        HEWN_TRY(result);
        if (found == AT_CUT || (found == AT_END && stage < 3))
            return cut_off(from, stage, partial, error);
        if (found == AT_END)
            return HEWN_OK;
        HEWN_TRY(get_block(from, type, &stage, error));
    }
}

hewn_result hewn_progressive_decode(const char *bytes, size_t length, const char *name, bool partial,
                                    hewn_progressive **out, hewn_error *error)
{
    reader from = {.bytes = (const unsigned char *)bytes, .name = name};
    *out = NULL;
    from.to = hewn_alloc_zero(1, sizeof *from.to);
    if (!from.to)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    hewn_result result = get_all(&from, length, partial, error);
    hewn_free(from.current);
    if (result == HEWN_OK)
        *out = from.to;
    else
        hewn_progressive_destroy(&from.to);
    return result;
}
