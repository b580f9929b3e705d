#include "app/volume_arguments.h"

#include <string.h>

#include "app/number.h"
#include "base/error.h"

static const char *const names[] = {"frame", "iso", "grid", "series", "dims", "type", "spacing", "endian", "skip"};

bool hewn_volume_arguments_any(const hewn_arguments *arguments)
{
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (hewn_arguments_has(arguments, names[i]))
            return true;
    return false;
}

/* Takes the part before the next comma; false where there is none left or it is too long. */
static bool next_part(const char **at, char *out, size_t room)
{
    if (!*at)
        return false;
    size_t length = strcspn(*at, ",");
    if (length >= room)
        return false;
    memcpy(out, *at, length);
    out[length] = '\0';
    *at = (*at)[length] == ',' ? *at + length + 1 : NULL;
    return true;
}

static hewn_result read_dims(const char *text, hewn_raw_desc *raw, hewn_error *error)
{
    const char *at = text;
    char part[32];
    uint32_t frames = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (!next_part(&at, part, sizeof part))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--dims takes X,Y,Z or X,Y,Z,N, not '%s'", text);
        HEWN_TRY(hewn_count_parse(part, "--dims", 1, &raw->dims[axis], error));
    }
    if (at && next_part(&at, part, sizeof part))
        HEWN_TRY(hewn_count_parse(part, "--dims", 1, &frames, error));
    raw->frame_count = frames;
    return !at ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "--dims takes X,Y,Z or X,Y,Z,N, not '%s'", text);
}

static hewn_result read_spacing(const char *text, hewn_raw_desc *raw, hewn_error *error)
{
    const char *at = text;
    char part[64];
    for (int axis = 0; axis < 3; axis++) {
        if (!next_part(&at, part, sizeof part))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--spacing takes X,Y,Z, not '%s'", text);
        HEWN_TRY(hewn_number_parse(part, "--spacing", &raw->spacing[axis], error));
        if (!(raw->spacing[axis] > 0))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--spacing takes numbers above 0, not '%s'", part);
    }
    return !at ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "--spacing takes X,Y,Z, not '%s'", text);
}

static hewn_result read_raw(const hewn_arguments *arguments, hewn_raw_desc *raw, hewn_error *error)
{
    const char *dims = hewn_arguments_value(arguments, "dims"), *type = hewn_arguments_value(arguments, "type");
    const char *spacing = hewn_arguments_value(arguments, "spacing"), *skip = hewn_arguments_value(arguments, "skip");
    const char *endian = hewn_arguments_value(arguments, "endian");
    uint32_t offset = 0;
    if (!dims != !type)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a raw file needs both --dims and --type");
    if (dims)
        HEWN_TRY(read_dims(dims, raw, error));
    if (type && !hewn_voxel_find(type, &raw->type))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--type is int8, uint8, int16, uint16, int32, uint32, int64, uint64, half, float or double, "
                         "not '%s'",
                         type);
    if (spacing)
        HEWN_TRY(read_spacing(spacing, raw, error));
    raw->big_endian = endian && strcmp(endian, "big") == 0;
    if (endian && !raw->big_endian && strcmp(endian, "little") != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--endian is little or big, not '%s'", endian);
    if (skip)
        HEWN_TRY(hewn_count_parse(skip, "--skip", 0, &offset, error));
    raw->offset = offset;
    return HEWN_OK;
}

hewn_result hewn_volume_arguments_read(const hewn_arguments *arguments, hewn_volume_arguments *out, hewn_error *error)
{
    const char *frame = hewn_arguments_value(arguments, "frame"), *iso = hewn_arguments_value(arguments, "iso");
    uint32_t number = 0;
    *out = (hewn_volume_arguments){0};
    HEWN_TRY(read_raw(arguments, &out->read.raw, error));
    if (frame)
        HEWN_TRY(hewn_count_parse(frame, "--frame", 0, &number, error));
    out->frame = number;
    out->has_iso = iso != NULL;
    if (iso)
        HEWN_TRY(hewn_iso_parse(iso, &out->iso, error));
    out->read.grid = hewn_arguments_value(arguments, "grid");
    out->read.series = hewn_arguments_value(arguments, "series");
    return HEWN_OK;
}

bool hewn_volume_arguments_wanted(const hewn_arguments *arguments, hewn_volume_format *format)
{
    const char *from = hewn_arguments_value(arguments, "from");
    const char *path = arguments->operand_count > 0 ? arguments->operands[0] : "";
    *format = HEWN_VOLUME_UNKNOWN;
    if (from)
        return hewn_volume_format_find(from, format);
    if (hewn_volume_format_of_file(path) == HEWN_VOLUME_UNKNOWN && hewn_arguments_has(arguments, "dims"))
        *format = HEWN_VOLUME_RAW;
    return *format == HEWN_VOLUME_RAW || hewn_volume_format_of_file(path) != HEWN_VOLUME_UNKNOWN;
}

hewn_result hewn_body_arguments_read(const hewn_arguments *arguments, hewn_body_choice *out, hewn_error *error)
{
    const char *largest = hewn_arguments_value(arguments, "largest");
    const char *least = hewn_arguments_value(arguments, "min-volume");
    uint32_t count = 0;
    *out = (hewn_body_choice){.fill_cavities = hewn_arguments_has(arguments, "fill-cavities")};
    if (largest)
        HEWN_TRY(hewn_count_parse(largest, "--largest", 1, &count, error));
    out->largest = count;
    if (least)
        HEWN_TRY(hewn_number_parse(least, "--min-volume", &out->least_volume, error));
    if (least && !(out->least_volume > 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--min-volume must be greater than 0, not %s", least);
    return HEWN_OK;
}
