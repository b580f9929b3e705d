#include "io/heights_read.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"

static const char png_begins[8] = {'\x89', 'P', 'N', 'G', '\r', '\n', '\x1a', '\n'};

void hewn_heightmap_destroy(hewn_heightmap *map)
{
    if (!map)
        return;
    hewn_free(map->values);
    *map = (hewn_heightmap){0};
}

static bool ends_in_png(const char *path)
{
    size_t length = strlen(path);
    return length >= 4 && strcasecmp(path + length - 4, ".png") == 0;
}

static hewn_result read_png(const char *path, hewn_heightmap *out, hewn_error *error)
{
    enum { FILE_MOST = 1 << 30 };
    char *bytes;
    size_t length;
    HEWN_TRY(hewn_file_read(path, FILE_MOST, &bytes, &length, error));
    hewn_result result = HEWN_OK;
    if (length < sizeof png_begins || memcmp(bytes, png_begins, sizeof png_begins) != 0)
        result = hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "not a PNG file by its first bytes");
    else
        result = hewn_png_read(bytes, length, path, out, error);
    hewn_free(bytes);
    return result;
}

/* --- slices of volumes ----------------------------------------------------------------------------------------------
 */

/* What a value is divided by. */
static double greatest_of(hewn_voxel type)
{
    return type == HEWN_VOXEL_UINT8 ? UINT8_MAX : type == HEWN_VOXEL_UINT16 ? UINT16_MAX : 1;
}

static hewn_result take_slice(const hewn_volume *volume, const char *path, hewn_heightmap *out, hewn_error *error)
{
    uint64_t count = (uint64_t)volume->dims[0] * volume->dims[1];
    if (volume->dims[2] != 1 || volume->frame_count != 1)
        return hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "it has %u slices of %llu values; heights are one of one",
                            volume->dims[2], (unsigned long long)volume->frame_count);
    if (count > HEWN_HEIGHTS_MOST)
        return hewn_fail_at(error, HEWN_LIMIT, path, 0, "it has more than 2^28 values");
    out->values = hewn_alloc(count, sizeof *out->values);
    if (!out->values)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, path, 0, "out of memory for %llu heights",
                            (unsigned long long)count);
    out->columns = volume->dims[0];
    out->rows = volume->dims[1];
    double greatest = greatest_of(volume->type);
    for (uint64_t i = 0; i < count; i++)
        out->values[i] = (float)(hewn_volume_value(volume, i) / greatest);
    return HEWN_OK;
}

static hewn_result read_volume(const char *path, const hewn_raw_desc *raw, hewn_heightmap *out, hewn_error *error)
{
    hewn_volume_read_desc desc = {.memory_limit = (uint64_t)4 << 30};
    hewn_volume volume;
    desc.format = hewn_volume_format_of_file(path);
    if (desc.format == HEWN_VOLUME_UNKNOWN && raw && raw->dims[0] > 0)
        desc.format = HEWN_VOLUME_RAW;
    if (desc.format == HEWN_VOLUME_RAW) {
        if (!raw || raw->dims[0] == 0 || raw->dims[1] == 0)
            return hewn_fail_at(error, HEWN_BAD_INPUT, path, 0,
                                "a raw file does not say how many columns and rows it "
                                "has: give dims");
        desc.raw = *raw;
        desc.raw.dims[2] = 1;
    }
    if (desc.format == HEWN_VOLUME_UNKNOWN)
        return hewn_fail_at(error, HEWN_BAD_INPUT, path, 0,
                            "heights are read from .png, .tif, .raw, .npy or .nrrd, and it is none of them");
    HEWN_TRY(hewn_volume_read(path, &desc, &volume, error));
    hewn_result result = take_slice(&volume, path, out, error);
    hewn_volume_destroy(&volume);
    return result;
}

/* --- all ------------------------------------------------------------------------------------------------------------
 */

hewn_result hewn_heightmap_check(const hewn_heightmap *map, const char *name, hewn_error *error)
{
    if (map->columns < 2 || map->rows < 2)
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "it has %u x %u values; heights need at least 2 x 2",
                            map->columns, map->rows);
    for (uint64_t i = 0; i < (uint64_t)map->columns * map->rows; i++)
        if (!isfinite(map->values[i]))
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0,
                                "the value in column %u of row %u is no finite number (both counted from 0)",
                                (unsigned)(i % map->columns), (unsigned)(i / map->columns));
    return HEWN_OK;
}

static void turn_over(hewn_heightmap *map)
{
    for (uint32_t y = 0; y < map->rows / 2; y++)
        for (uint32_t x = 0; x < map->columns; x++) {
            float *a = map->values + (size_t)map->columns * y + x;
            float *b = map->values + (size_t)map->columns * (map->rows - 1 - y) + x;
            float held = *a;
            *a = *b;
            *b = held;
        }
}

hewn_result hewn_heightmap_read(const char *path, const hewn_raw_desc *raw, hewn_heightmap *out, hewn_error *error)
{
    if (!path || !out)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_heightmap_read: no file, or no place for its values");
    *out = (hewn_heightmap){0};
    hewn_result result = ends_in_png(path) ? read_png(path, out, error) : read_volume(path, raw, out, error);
    if (result == HEWN_OK)
        result = hewn_heightmap_check(out, path, error);
    if (result == HEWN_OK)
        turn_over(out);
    else
        hewn_heightmap_destroy(out);
    return result;
}
