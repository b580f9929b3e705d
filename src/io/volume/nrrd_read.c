/* NRRD files, with their samples in the same file, in another one, or in several. */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "io/unpack.h"
#include "io/volume/file_list.h"
#include "io/volume/formats.h"
#include "io/volume/nrrd_header.h"

/* --- axes --------------------------------------------------------------------------------------------------------- */

/* Whether an axis is of space: it has a direction there; without a space it is what its kind says, and without kinds
 * the first three are. */
static bool is_spatial(const hewn_nrrd_header *header, uint32_t at)
{
    const hewn_nrrd_axis *axis = &header->axes[at];
    if (header->space > 0 && axis->has_direction)
        return axis->direction[0] != 0 || axis->direction[1] != 0 || axis->direction[2] != 0 || header->space < 4;
    if (header->space > 0) {
        for (uint32_t i = 0; i < header->dimension; i++)
            if (header->axes[i].has_direction)
                return false;
    }
    return axis->has_kind ? !axis->not_domain : at < 3;
}

/* Spacing and place of the first sample of an axis that has no direction. */
static void get_extent(const hewn_nrrd_axis *axis, double *spacing, double *begin)
{
    double intervals = axis->cell ? (double)axis->size : (double)axis->size - 1;
    bool ranged = isfinite(axis->min) && isfinite(axis->max) && intervals > 0;
    *spacing = !isnan(axis->spacing) ? axis->spacing : ranged ? (axis->max - axis->min) / intervals : 1;
    *begin = isfinite(axis->min) ? axis->min + (axis->cell ? *spacing / 2 : 0) : 0;
}

static hewn_result set_axes(const hewn_volume_source *source, const hewn_nrrd_header *header, hewn_file_axis *axes,
                            hewn_volume *volume, hewn_error *error)
{
    double columns[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, origin[3] = {0};
    int found = 0;
    for (uint32_t i = 0; i < header->dimension; i++) {
        const hewn_nrrd_axis *axis = &header->axes[i];
        bool spatial = is_spatial(header, i);
        axes[i] = (hewn_file_axis){axis->size, spatial ? found : -1};
        if (spatial && found == 3)
            return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "more than three axes are of space");
        if (spatial) {
            volume->dims[found] = (uint32_t)axis->size;
            for (int row = 0; axis->has_direction && row < 3; row++)
                columns[found][row] = axis->direction[row];
            if (!axis->has_direction)
                get_extent(axis, &columns[found][found], &origin[found]);
            found++;
        } else if (__builtin_mul_overflow(volume->frame_count, axis->size, &volume->frame_count)) {
            return hewn_fail_at(error, HEWN_LIMIT, source->name, 0,
                                "the header tells of more frames than can be counted");
        }
    }
    for (int missing = found; missing < 3; missing++) { /* across those that are there */
        const double *a = columns[0], *b = columns[1];
        if (missing == 2 && header->space == 3)
            for (int row = 0; row < 3; row++)
                columns[2][row] = a[(row + 1) % 3] * b[(row + 2) % 3] - a[(row + 2) % 3] * b[(row + 1) % 3];
        double length = hypot(hypot(columns[missing][0], columns[missing][1]), columns[missing][2]);
        for (int row = 0; row < 3 && length > 0; row++)
            columns[missing][row] /= length;
    }
    hewn_volume_place(volume, columns, header->space > 0 ? header->origin : origin);
    return HEWN_OK;
}

static const hewn_unit *unit_of(hewn_word word)
{
    static const char *const micro[] = {"um", "\xc2\xb5m", "\xce\xbcm", "micron", "microns", "micrometer"};
    char name[16] = {0};
    if ((size_t)(word.end - word.begin) >= sizeof name || word.begin == word.end)
        return NULL;
    memcpy(name, word.begin, (size_t)(word.end - word.begin));
    for (size_t i = 0; i < sizeof micro / sizeof *micro; i++)
        if (strcmp(name, micro[i]) == 0)
            return hewn_unit_find("um");
    return hewn_unit_find(strcmp(name, "millimeter") == 0 ? "mm" : name);
}

/* --- where samples begin ------------------------------------------------------------------------------------------ */

static hewn_result skip_lines(const hewn_volume_source *source, int64_t lines, size_t *at, hewn_error *error)
{
    for (; lines > 0; lines--) {
        const char *end = *at < source->length ? memchr(source->bytes + *at, '\n', source->length - *at) : NULL;
        if (!end)
            return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "there are fewer lines than are to be skipped");
        *at = (size_t)(end - source->bytes) + 1;
    }
    return HEWN_OK;
}

static int digit_of(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

static hewn_result read_hex(const hewn_volume_source *source, size_t at, bool big, size_t bytes, hewn_volume *volume,
                            hewn_error *error)
{
    size_t left = source->length - at;
    if (bytes > left / 2)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                            "the header tells of %zu bytes of samples, but only %zu hexadecimal digits follow", bytes,
                            left);
    HEWN_TRY(hewn_volume_make_room(source, volume, error));
    char *to = volume->memory;
    for (size_t made = 0; made < 2 * bytes; at++) {
        int digit = at < source->length ? digit_of(source->bytes[at]) : -1;
        bool blank = at < source->length && (hewn_is_blank(source->bytes[at]) || hewn_is_line_end(source->bytes[at]));
        if (digit < 0 && !blank)
            return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the hexadecimal digits end early");
        if (digit < 0)
            continue;
        to[made / 2] = (char)(made % 2 ? (unsigned char)to[made / 2] | (unsigned)digit : (unsigned)digit << 4);
        made++;
    }
    size_t size = hewn_voxel_size(volume->type);
    if (big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__))
        hewn_swap_samples(to, bytes / size, size);
    return HEWN_OK;
}

/* All samples of `volume` from one source, from `at` on. */
static hewn_result read_samples(hewn_volume_source *source, const hewn_nrrd_header *header, size_t at,
                                hewn_volume *volume, hewn_error *error)
{
    size_t bytes;
    HEWN_TRY(hewn_volume_head_check(source, volume, &bytes, error));
    HEWN_TRY(skip_lines(source, header->line_skip, &at, error));
    uint64_t skip = header->byte_skip > 0 ? (uint64_t)header->byte_skip : 0;
    bool packed = header->encoding == HEWN_NRRD_GZIP || header->encoding == HEWN_NRRD_BZIP2;
    if (header->byte_skip < 0 && header->encoding != HEWN_NRRD_RAW)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "byte skip -1 is for raw samples only");
    if (header->byte_skip < 0)
        at = bytes <= source->length ? source->length - bytes : 0;
    if (!packed && skip > source->length - at)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "there are fewer bytes than are to be skipped");
    at += packed ? 0 : (size_t)skip;
    switch (header->encoding) {
    case HEWN_NRRD_RAW: return hewn_volume_take_samples(source, at, header->big_endian, volume, error);
    case HEWN_NRRD_TEXT: return hewn_volume_parse_samples(source, at, volume, error);
    case HEWN_NRRD_HEX: return read_hex(source, at, header->big_endian, bytes, volume, error);
    case HEWN_NRRD_GZIP:
        return hewn_volume_unpack_samples(source, at, HEWN_PACKING_ZLIB, skip, header->big_endian, volume, error);
    case HEWN_NRRD_BZIP2:
        return hewn_volume_unpack_samples(source, at, HEWN_PACKING_BZIP2, skip, header->big_endian, volume, error);
    }
    return HEWN_OK;
}

/* --- samples elsewhere -------------------------------------------------------------------------------------------- */

static hewn_result read_part(hewn_volume_source *source, const void *user, hewn_volume *volume, hewn_error *error)
{
    return read_samples(source, user, 0, volume, error);
}

static hewn_result read_elsewhere(const hewn_volume_source *source, const hewn_nrrd_header *header, hewn_volume *volume,
                                  hewn_error *error)
{
    hewn_file_list names = {.source = source, .lines = header->data_list};
    if (!header->data_list && !hewn_file_list_pattern(header->data_file, &names))
        return hewn_file_list_one(source, header->data_file, read_part, header, volume, error);
    return hewn_file_list_read(&names, read_part, header, volume, error);
}

hewn_result hewn_nrrd_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    hewn_nrrd_header header;
    hewn_file_axis axes[HEWN_NRRD_AXES];
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    HEWN_TRY(hewn_nrrd_header_read(source, &header, error));
    HEWN_TRY(set_axes(source, &header, axes, &volume, error));
    volume.type = header.type;
    volume.anatomical = header.anatomical;
    volume.level_set = header.level_set;
    volume.unit = unit_of(header.unit);
    hewn_volume_turn_world(&volume, header.left, header.posterior);
    HEWN_TRY(hewn_volume_head_check(source, &volume, NULL, error));
    /* Now: the text may go away with the samples that follow it. */
    volume.name = hewn_volume_text(header.content.begin, (size_t)(header.content.end - header.content.begin));
    hewn_result result = header.data_file.begin < header.data_file.end
                             ? read_elsewhere(source, &header, &volume, error)
                             : read_samples(source, &header, header.samples_at, &volume, error);
    if (result == HEWN_OK)
        result = hewn_volume_reorder(source, axes, header.dimension, &volume, error);
    if (result != HEWN_OK) {
        hewn_volume_destroy(&volume);
        return result;
    }
    *out = volume;
    return HEWN_OK;
}
