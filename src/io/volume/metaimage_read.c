/* MetaImage (.mha, .mhd), as MetaIO and ITK write it: lines "Key = value", the last of which says where the samples
 * are. Its world is LPS. */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "io/unpack.h"
#include "io/volume/file_list.h"
#include "io/volume/formats.h"

enum { MOST_AXES = 10 };

typedef struct meta_header {
    const char *name;
    uint32_t axes, line;
    uint64_t size[MOST_AXES], channels;
    double spacing[MOST_AXES], origin[MOST_AXES], matrix[MOST_AXES * MOST_AXES];
    bool has_size, has_type, has_spacing, big_endian, text, packed;
    hewn_voxel type;
    int64_t header_size; /* of the file with the samples; -1: they end with it */
    double slope, intercept;
    hewn_word unit, comment, data_file;
    size_t samples_at; /* past the header, where the samples are in the same file */
} meta_header;

static hewn_result bad(const meta_header *header, hewn_word key, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, header->line, "%.*s: %s", (int)(key.end - key.begin),
                        key.begin, what);
}

/* Numbers with blanks between; how many there are, up to `most`; -1 where a word is none. */
static int get_numbers(hewn_word value, double *out, int most)
{
    hewn_scan scan = {value.begin, value.end, NULL, 1};
    int count = 0;
    for (; count < most; count++) {
        hewn_word word = hewn_scan_word_in_line(&scan);
        if (word.begin == word.end)
            break;
        if (!hewn_word_double(word, &out[count]))
            return -1;
    }
    return count;
}

static hewn_result read_sizes(meta_header *header, hewn_word key, hewn_word value, hewn_error *error)
{
    hewn_scan scan = {value.begin, value.end, NULL, 1};
    for (uint32_t i = 0; i < header->axes; i++) {
        int64_t size;
        if (!hewn_word_integer(hewn_scan_word_in_line(&scan), &size) || size < 1 || size > UINT32_MAX)
            return bad(header, key, "not a whole number above 0 for each axis", error);
        header->size[i] = (uint64_t)size;
    }
    header->has_size = header->axes > 0;
    return header->has_size ? HEWN_OK : bad(header, key, "comes before NDims", error);
}

static hewn_result read_type(meta_header *header, hewn_word key, hewn_word value, hewn_error *error)
{
    static const struct {
        const char *name;
        hewn_voxel type;
    } names[] = {
        {"MET_CHAR", HEWN_VOXEL_INT8},       {"MET_ASCII_CHAR", HEWN_VOXEL_INT8},   {"MET_UCHAR", HEWN_VOXEL_UINT8},
        {"MET_SHORT", HEWN_VOXEL_INT16},     {"MET_USHORT", HEWN_VOXEL_UINT16},     {"MET_INT", HEWN_VOXEL_INT32},
        {"MET_UINT", HEWN_VOXEL_UINT32},     {"MET_LONG", HEWN_VOXEL_INT32},        {"MET_ULONG", HEWN_VOXEL_UINT32},
        {"MET_LONG_LONG", HEWN_VOXEL_INT64}, {"MET_ULONG_LONG", HEWN_VOXEL_UINT64}, {"MET_FLOAT", HEWN_VOXEL_FLOAT},
        {"MET_DOUBLE", HEWN_VOXEL_DOUBLE}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (hewn_word_is(value, names[i].name)) {
            header->type = names[i].type;
            header->has_type = true;
            return HEWN_OK;
        }
    }
    return bad(header, key, "not a type of numbers", error);
}

static hewn_result read_reals(meta_header *header, hewn_word key, hewn_word value, double *out, int count,
                              hewn_error *error)
{
    return header->axes > 0 && get_numbers(value, out, count) == count
               ? HEWN_OK
               : bad(header, key, "not as many numbers as the axes need", error);
}

static hewn_result read_whole(meta_header *header, hewn_word key, hewn_word value, int64_t least, int64_t *out,
                              hewn_error *error)
{
    return hewn_word_integer(value, out) && *out >= least && *out < INT64_MAX / 2
               ? HEWN_OK
               : bad(header, key, "not a whole number that can be there", error);
}

static bool is_true(hewn_word value)
{
    return value.begin < value.end && (*value.begin == 'T' || *value.begin == 't' || *value.begin == '1');
}

static bool is_one_of(hewn_word key, const char *a, const char *b, const char *c)
{
    return hewn_word_is(key, a) || hewn_word_is(key, b) || (c && hewn_word_is(key, c));
}

static hewn_result read_key(meta_header *header, hewn_word key, hewn_word value, hewn_error *error)
{
    int axes = (int)header->axes;
    int64_t whole;
    if (hewn_word_is(key, "NDims")) {
        if (!hewn_word_integer(value, &whole) || whole < 1 || whole > MOST_AXES || header->axes > 0)
            return bad(header, key, "not one number from 1 to 10", error);
        header->axes = (uint32_t)whole;
        for (uint32_t i = 0; i < header->axes; i++) {
            header->spacing[i] = header->matrix[i * header->axes + i] = 1;
            header->size[i] = 1;
        }
        return HEWN_OK;
    }
    if (hewn_word_is(key, "DimSize"))
        return read_sizes(header, key, value, error);
    if (hewn_word_is(key, "ElementType"))
        return read_type(header, key, value, error);
    if (hewn_word_is(key, "ElementSpacing")) {
        header->has_spacing = true;
        return read_reals(header, key, value, header->spacing, axes, error);
    }
    if (hewn_word_is(key, "ElementSize")) /* of what a sample was measured in; spacing goes before it */
        return header->has_spacing ? HEWN_OK : read_reals(header, key, value, header->spacing, axes, error);
    if (is_one_of(key, "Offset", "Position", "Origin"))
        return read_reals(header, key, value, header->origin, axes, error);
    if (is_one_of(key, "TransformMatrix", "Rotation", "Orientation"))
        return read_reals(header, key, value, header->matrix, axes * axes, error);
    if (hewn_word_is(key, "ElementNumberOfChannels")) {
        HEWN_TRY(read_whole(header, key, value, 1, &whole, error));
        header->channels = (uint64_t)whole;
    } else if (hewn_word_is(key, "HeaderSize")) {
        return read_whole(header, key, value, -1, &header->header_size, error);
    } else if (is_one_of(key, "BinaryDataByteOrderMSB", "ElementByteOrderMSB", NULL)) {
        header->big_endian = is_true(value);
    } else if (hewn_word_is(key, "BinaryData")) {
        header->text = !is_true(value);
    } else if (hewn_word_is(key, "CompressedData")) {
        header->packed = is_true(value);
    } else if (hewn_word_is(key, "ElementToIntensityFunctionSlope")) {
        return read_reals(header, key, value, &header->slope, 1, error);
    } else if (hewn_word_is(key, "ElementToIntensityFunctionOffset")) {
        return read_reals(header, key, value, &header->intercept, 1, error);
    } else if (hewn_word_is(key, "DistanceUnits")) {
        header->unit = value;
    } else if (hewn_word_is(key, "Comment")) {
        header->comment = value;
    }
    return HEWN_OK;
}

static hewn_word trim(const char *begin, const char *end)
{
    while (begin < end && hewn_is_blank(*begin))
        begin++;
    while (end > begin && hewn_is_blank(end[-1]))
        end--;
    return (hewn_word){begin, end};
}

static hewn_result read_header(const hewn_volume_source *source, meta_header *header, hewn_error *error)
{
    hewn_scan scan = {source->bytes, source->bytes + source->length, source->name, 1};
    *header = (meta_header){.name = source->name, .channels = 1, .slope = 1};
    while (scan.at < scan.end) {
        const char *end = scan.at;
        while (end < scan.end && !hewn_is_line_end(*end))
            end++;
        header->line = scan.line;
        const char *equals = memchr(scan.at, '=', (size_t)(end - scan.at));
        hewn_word line = trim(scan.at, end);
        if (!equals && line.begin < line.end)
            return hewn_scan_fail(&scan, line, "expected \"Key = value\"", error);
        hewn_word key = trim(scan.at, equals ? equals : end), value = trim(equals ? equals + 1 : end, end);
        hewn_scan_line(&scan);
        if (hewn_word_is(key, "ElementDataFile")) {
            header->data_file = value;
            header->samples_at = (size_t)(scan.at - source->bytes);
            break;
        }
        if (equals)
            HEWN_TRY(read_key(header, key, value, error));
    }
    const char *missing = !header->has_size                                  ? "DimSize"
                          : !header->has_type                                ? "ElementType"
                          : header->data_file.begin == header->data_file.end ? "ElementDataFile"
                                                                             : NULL;
    if (missing)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the header has no %s", missing);
    return HEWN_OK;
}

/* The matrix lists the direction of each axis, one after the other. */
static hewn_result set_head(const meta_header *header, hewn_volume *volume, hewn_error *error)
{
    double columns[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, origin[3] = {0};
    for (uint32_t axis = 0; axis < header->axes; axis++) {
        if (axis < 3)
            volume->dims[axis] = (uint32_t)header->size[axis];
        else if (__builtin_mul_overflow(volume->frame_count, header->size[axis], &volume->frame_count))
            return hewn_fail_at(error, HEWN_LIMIT, header->name, 0,
                                "the header tells of more frames than can be counted");
        for (uint32_t row = 0; axis < 3 && row < 3 && row < header->axes; row++)
            columns[axis][row] = header->matrix[axis * header->axes + row] * header->spacing[axis];
        if (axis < 3)
            origin[axis] = header->origin[axis];
    }
    if (__builtin_mul_overflow(volume->frame_count, header->channels, &volume->frame_count))
        return hewn_fail_at(error, HEWN_LIMIT, header->name, 0,
                            "the header tells of more channels than can be counted");
    hewn_volume_place(volume, columns, origin);
    hewn_volume_turn_world(volume, true, true);
    volume->anatomical = true;
    volume->type = header->type;
    volume->slope = header->slope;
    volume->intercept = header->intercept;
    volume->unit = hewn_word_is(header->unit, "mm")   ? hewn_unit_find("mm")
                   : hewn_word_is(header->unit, "cm") ? hewn_unit_find("cm")
                   : hewn_word_is(header->unit, "um") ? hewn_unit_find("um")
                                                      : NULL;
    return HEWN_OK;
}

static hewn_result read_samples(hewn_volume_source *source, const meta_header *header, size_t at, hewn_volume *volume,
                                hewn_error *error)
{
    size_t bytes;
    HEWN_TRY(hewn_volume_head_check(source, volume, &bytes, error));
    if (header->text)
        return hewn_volume_parse_samples(source, at, volume, error);
    if (header->packed)
        return hewn_volume_unpack_samples(source, at, HEWN_PACKING_ZLIB, 0, header->big_endian, volume, error);
    if (header->header_size < 0)
        at = bytes <= source->length ? source->length - bytes : 0;
    return hewn_volume_take_samples(source, at, header->big_endian, volume, error);
}

static hewn_result read_part(hewn_volume_source *source, const void *user, hewn_volume *volume, hewn_error *error)
{
    const meta_header *header = user;
    return read_samples(source, header, header->header_size > 0 ? (size_t)header->header_size : 0, volume, error);
}

static hewn_result find_samples(hewn_volume_source *source, const meta_header *header, hewn_volume *volume,
                                hewn_error *error)
{
    hewn_word file = header->data_file;
    hewn_file_list names = {.source = source};
    if (is_one_of(file, "LOCAL", "Local", "local"))
        return read_samples(source, header, header->samples_at, volume, error);
    if (hewn_word_is(file, "LIST") || (file.end - file.begin > 5 && memcmp(file.begin, "LIST ", 5) == 0)) {
        names.lines = source->bytes + header->samples_at;
        return hewn_file_list_read(&names, read_part, header, volume, error);
    }
    if (hewn_file_list_pattern(file, &names))
        return hewn_file_list_read(&names, read_part, header, volume, error);
    return hewn_file_list_one(source, file, read_part, header, volume, error);
}

hewn_result hewn_metaimage_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    meta_header header;
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    HEWN_TRY(read_header(source, &header, error));
    HEWN_TRY(set_head(&header, &volume, error));
    HEWN_TRY(hewn_volume_head_check(source, &volume, NULL, error));
    /* Now: the text may go away with the samples that follow it. */
    volume.name = hewn_volume_text(header.comment.begin, (size_t)(header.comment.end - header.comment.begin));
    hewn_result result = find_samples(source, &header, &volume, error);
    hewn_file_axis axes[MOST_AXES + 1] = {{header.channels, -1}};
    for (uint32_t i = 0; i < header.axes; i++)
        axes[i + 1] = (hewn_file_axis){header.size[i], i < 3 ? (int)i : -1};
    if (result == HEWN_OK)
        result = hewn_volume_reorder(source, axes, header.axes + 1, &volume, error);
    if (result != HEWN_OK) {
        hewn_volume_destroy(&volume);
        return result;
    }
    *out = volume;
    return HEWN_OK;
}
