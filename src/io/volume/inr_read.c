/* INRIMAGE-4, of Inria's image library: a header of lines "KEY=value" filled up to a multiple of 256 bytes, then
 * samples. */
#include <string.h>

#include "base/error.h"
#include "io/scan.h"
#include "io/volume/formats.h"

enum { BLOCK = 256, MOST_BLOCKS = 64 };

typedef struct inr_header {
    const char *name;
    uint64_t components;
    bool real, is_signed, big_endian, has_type;
    int64_t bits;
    double spacing[3], origin[3];
    uint32_t dims[3];
} inr_header;

static hewn_result read_key(inr_header *header, hewn_word key, hewn_word value, uint32_t line, hewn_error *error)
{
    static const char *const sizes[] = {"XDIM", "YDIM", "ZDIM", "VDIM"};
    static const char *const spacings[] = {"VX", "VY", "VZ"}, *const origins[] = {"TX", "TY", "TZ"};
    int64_t whole;
    for (int i = 0; i < 4; i++) {
        if (!hewn_word_is(key, sizes[i]))
            continue;
        if (!hewn_word_integer(value, &whole) || whole < 1 || whole > UINT32_MAX)
            return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, line, "%s is not a size", sizes[i]);
        if (i < 3)
            header->dims[i] = (uint32_t)whole;
        else
            header->components = (uint64_t)whole;
    }
    for (int i = 0; i < 3; i++) {
        double *out = hewn_word_is(key, spacings[i])  ? &header->spacing[i]
                      : hewn_word_is(key, origins[i]) ? &header->origin[i]
                                                      : NULL;
        if (out && !hewn_word_double(value, out))
            return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, line, "not a number");
    }
    if (hewn_word_is(key, "TYPE")) {
        header->real = hewn_word_is(value, "float") || hewn_word_is(value, "double");
        header->is_signed = hewn_word_is(value, "signed fixed");
        header->has_type = header->real || header->is_signed || hewn_word_is(value, "unsigned fixed");
    } else if (hewn_word_is(key, "PIXSIZE")) {
        hewn_scan scan = {value.begin, value.end, header->name, line};
        if (!hewn_word_integer(hewn_scan_word_in_line(&scan), &header->bits))
            return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, line, "PIXSIZE is not a number of bits");
    } else if (hewn_word_is(key, "CPU")) {
        header->big_endian = hewn_word_is(value, "sun") || hewn_word_is(value, "sgi");
    }
    return HEWN_OK;
}

static bool find_type(const inr_header *header, hewn_voxel *out)
{
    static const hewn_voxel reals[] = {HEWN_VOXEL_FLOAT, HEWN_VOXEL_DOUBLE};
    static const hewn_voxel whole[2][4] = {{HEWN_VOXEL_UINT8, HEWN_VOXEL_UINT16, HEWN_VOXEL_UINT32, HEWN_VOXEL_UINT64},
                                           {HEWN_VOXEL_INT8, HEWN_VOXEL_INT16, HEWN_VOXEL_INT32, HEWN_VOXEL_INT64}};
    int power = header->bits == 8 ? 0 : header->bits == 16 ? 1 : header->bits == 32 ? 2 : header->bits == 64 ? 3 : -1;
    if (!header->has_type || power < 0 || (header->real && power < 2))
        return false;
    *out = header->real ? reals[power - 2] : whole[header->is_signed][power];
    return true;
}

/* Where the samples begin: after the first block that ends with "##}" and a line end. */
static size_t header_end(const hewn_volume_source *source)
{
    for (size_t end = BLOCK; end <= source->length && end <= (size_t)BLOCK * MOST_BLOCKS; end += BLOCK)
        if (memcmp(source->bytes + end - 4, "##}\n", 4) == 0)
            return end;
    return 0;
}

hewn_result hewn_inr_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    inr_header header = {.name = source->name, .components = 1, .spacing = {1, 1, 1}};
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    size_t end = header_end(source);
    if (source->length < BLOCK || memcmp(source->bytes, "#INRIMAGE-4#{", 13) != 0 || end == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                            "not an INRIMAGE-4 file, or its header does not end");
    hewn_scan scan = {source->bytes, source->bytes + end, source->name, 1};
    for (hewn_scan_line(&scan); scan.at < scan.end; hewn_scan_line(&scan)) {
        const char *last = scan.at;
        while (last < scan.end && !hewn_is_line_end(*last))
            last++;
        const char *equals = memchr(scan.at, '=', (size_t)(last - scan.at));
        if (equals && *scan.at != '#')
            HEWN_TRY(read_key(&header, (hewn_word){scan.at, equals}, (hewn_word){equals + 1, last}, scan.line, error));
    }
    if (!find_type(&header, &volume.type))
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the header tells no type that is known");
    for (int axis = 0; axis < 3; axis++) {
        volume.dims[axis] = header.dims[axis];
        volume.to_world[5 * axis] = header.spacing[axis];
        volume.to_world[4 * axis + 3] = header.origin[axis];
    }
    volume.frame_count = header.components;
    HEWN_TRY(hewn_volume_head_check(source, &volume, NULL, error));
    HEWN_TRY(hewn_volume_take_samples(source, end, header.big_endian, &volume, error));
    const hewn_file_axis axes[] = {
        {header.components, -1}, {volume.dims[0], 0}, {volume.dims[1], 1}, {volume.dims[2], 2}};
    hewn_result result = hewn_volume_reorder(source, axes, 4, &volume, error);
    if (result == HEWN_OK)
        *out = volume;
    else
        hewn_volume_destroy(&volume);
    return result;
}
