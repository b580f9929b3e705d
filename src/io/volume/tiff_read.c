/* TIFF files whose pages are the slices of a volume, as microscopes and ImageJ write them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <tiffio.h>

#include "base/error.h"
#include "base/progress.h"
#include "io/shim/number.h"
#include "io/volume/formats.h"

/* libtiff reads from memory through these. */
typedef struct tiff_stream {
    const hewn_volume_source *source;
    uint64_t at;
    char message[256]; /* the first complaint */
} tiff_stream;

static tmsize_t read_bytes(thandle_t handle, void *to, tmsize_t length)
{
    tiff_stream *stream = (tiff_stream *)handle;
    uint64_t left = stream->at < stream->source->length ? stream->source->length - stream->at : 0;
    tmsize_t given = (uint64_t)length < left ? length : (tmsize_t)left;
    memcpy(to, stream->source->bytes + (given > 0 ? stream->at : 0), (size_t)given);
    stream->at += (uint64_t)given;
    return given;
}

static tmsize_t write_bytes(thandle_t handle, void *from, tmsize_t length)
{
    (void)handle;
    (void)from;
    (void)length;
    return 0;
}

static toff_t seek(thandle_t handle, toff_t offset, int whence)
{
    tiff_stream *stream = (tiff_stream *)handle;
    uint64_t base = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? stream->at : stream->source->length;
    return stream->at = base + offset;
}

static int close_nothing(thandle_t handle)
{
    (void)handle;
    return 0;
}

static toff_t size_of(thandle_t handle)
{
    return ((tiff_stream *)handle)->source->length;
}

static int keep_message(TIFF *file, void *user, const char *module, const char *format, va_list arguments)
{
    tiff_stream *stream = user;
    (void)file;
    (void)module;
    if (stream->message[0] == '\0')
        vsnprintf(stream->message, sizeof stream->message, format, arguments);
    return 1; /* and nothing goes to stderr */
}

static int keep_silent(TIFF *file, void *user, const char *module, const char *format, va_list arguments)
{
    (void)file;
    (void)user;
    (void)module;
    (void)format;
    (void)arguments;
    return 1;
}

/* One page. */
typedef struct page {
    uint32_t width, height;
    uint16_t bits, kind, samples, planar, photometric;
} page;

static page read_page(TIFF *file)
{
    page out = {0};
    TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &out.width);
    TIFFGetField(file, TIFFTAG_IMAGELENGTH, &out.height);
    TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &out.bits);
    TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLEFORMAT, &out.kind);
    TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &out.samples);
    TIFFGetField(file, TIFFTAG_PHOTOMETRIC, &out.photometric);
    return out;
}

static bool find_type(const page *from, hewn_voxel *out)
{
    static const struct {
        uint16_t kind, bits;
        hewn_voxel type;
    } types[] = {{SAMPLEFORMAT_UINT, 8, HEWN_VOXEL_UINT8},    {SAMPLEFORMAT_UINT, 16, HEWN_VOXEL_UINT16},
                 {SAMPLEFORMAT_UINT, 32, HEWN_VOXEL_UINT32},  {SAMPLEFORMAT_UINT, 64, HEWN_VOXEL_UINT64},
                 {SAMPLEFORMAT_INT, 8, HEWN_VOXEL_INT8},      {SAMPLEFORMAT_INT, 16, HEWN_VOXEL_INT16},
                 {SAMPLEFORMAT_INT, 32, HEWN_VOXEL_INT32},    {SAMPLEFORMAT_INT, 64, HEWN_VOXEL_INT64},
                 {SAMPLEFORMAT_IEEEFP, 16, HEWN_VOXEL_HALF},  {SAMPLEFORMAT_IEEEFP, 32, HEWN_VOXEL_FLOAT},
                 {SAMPLEFORMAT_IEEEFP, 64, HEWN_VOXEL_DOUBLE}};
    uint16_t kind = from->kind == SAMPLEFORMAT_VOID ? SAMPLEFORMAT_UINT : from->kind;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (types[i].kind == kind && types[i].bits == from->bits) {
            *out = types[i].type;
            return true;
        }
    }
    return false;
}

static hewn_result bad(const tiff_stream *stream, uint32_t slice, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, stream->source->name, 0, "page %u: %s%s%s", slice + 1, what,
                        stream->message[0] ? ": " : "", stream->message);
}

static hewn_result check_page(const tiff_stream *stream, const page *from, const page *first, uint32_t slice,
                              hewn_error *error)
{
    hewn_voxel type;
    if (from->samples != 1 || from->photometric == PHOTOMETRIC_PALETTE)
        return bad(stream, slice, "pixels are colours, not single numbers", error);
    if (from->width == 0 || from->height == 0 || !find_type(from, &type))
        return bad(stream, slice, "pixels are not of a type that volumes have", error);
    if (from->width != first->width || from->height != first->height || from->bits != first->bits ||
        from->kind != first->kind)
        return bad(stream, slice, "differs in size or type from the first one", error);
    return HEWN_OK;
}

/* --- ImageJ ------------------------------------------------------------------------------------------------------- */

/* The number after "key=" at a line's beginning in the description; `missing` where there is none. */
static double find_number(const char *text, const char *key, double missing)
{
    size_t length = strlen(key);
    for (const char *at = text; at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL) {
        double value;
        if (strncmp(at, key, length) == 0 && at[length] == '=' &&
            hewn_number_parse_double(at + length + 1, at + strlen(at), &value) && isfinite(value))
            return value;
    }
    return missing;
}

/* Spacing and unit, which only ImageJ's description gives sense to: the resolution of others is that of a printer. */
static void read_description(TIFF *file, hewn_volume *volume)
{
    char *text = NULL;
    float across = 0, down = 0;
    if (!TIFFGetField(file, TIFFTAG_IMAGEDESCRIPTION, &text) || !text || strncmp(text, "ImageJ=", 7) != 0)
        return;
    TIFFGetField(file, TIFFTAG_XRESOLUTION, &across);
    TIFFGetField(file, TIFFTAG_YRESOLUTION, &down);
    volume->to_world[0] = across > 0 && isfinite(across) ? 1 / (double)across : 1;
    volume->to_world[5] = down > 0 && isfinite(down) ? 1 / (double)down : 1;
    double spacing = fabs(find_number(text, "spacing", volume->to_world[0]));
    volume->to_world[10] = spacing > 0 ? spacing : 1;
    const char *unit = strstr(text, "\nunit=");
    if (unit && (strncmp(unit + 6, "micron", 6) == 0 || strncmp(unit + 6, "um", 2) == 0 ||
                 strncmp(unit + 6, "\\u00B5m", 7) == 0 || strncmp(unit + 6, "\xc2\xb5m", 3) == 0))
        volume->unit = hewn_unit_find("um");
    else if (unit && strncmp(unit + 6, "mm", 2) == 0)
        volume->unit = hewn_unit_find("mm");
    else if (unit && strncmp(unit + 6, "cm", 2) == 0)
        volume->unit = hewn_unit_find("cm");
}

/* --- pixels ------------------------------------------------------------------------------------------------------- */

static bool read_strips(TIFF *file, char *slice, size_t slice_bytes)
{
    size_t made = 0;
    uint32_t strips = TIFFNumberOfStrips(file);
    for (uint32_t strip = 0; strip < strips && made < slice_bytes; strip++) {
        tmsize_t got = TIFFReadEncodedStrip(file, strip, slice + made, (tmsize_t)(slice_bytes - made));
        if (got <= 0)
            return false;
        made += (size_t)got;
    }
    return made == slice_bytes;
}

/* Makes sure that what a page claims can be: libtiff unpacks at most some 1,000-fold, and raw data stand as they are.
 */
static bool is_likely(TIFF *file, const tiff_stream *stream, size_t slice_bytes, uint32_t slices)
{
    uint16_t packing = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(file, TIFFTAG_COMPRESSION, &packing);
    uint64_t most = packing == COMPRESSION_NONE ? 1 : 8192;
    return slice_bytes <= stream->source->length * most / slices;
}

static hewn_result read_slices(TIFF *file, const tiff_stream *stream, const page *first, hewn_volume *volume,
                               hewn_error *error)
{
    size_t slice_bytes = (size_t)volume->dims[0] * volume->dims[1] * hewn_voxel_size(volume->type);
    if (!TIFFSetDirectory(file, 0) || !is_likely(file, stream, slice_bytes, volume->dims[2]))
        return hewn_fail_at(error, HEWN_BAD_INPUT, stream->source->name, 0,
                            "the pages tell of more pixels than the file can hold");
    HEWN_TRY(hewn_volume_make_room(stream->source, volume, error));
    for (uint32_t k = 0; k < volume->dims[2]; k++) {
        if (k > 0 && !TIFFReadDirectory(file))
            return bad(stream, k, "cannot be read", error);
        page next = read_page(file);
        HEWN_TRY(check_page(stream, &next, first, k, error));
        if (TIFFIsTiled(file))
            return bad(stream, k, "is in tiles, which are not supported", error);
        if (!read_strips(file, (char *)volume->memory + k * slice_bytes, slice_bytes))
            return bad(stream, k, "its pixels cannot be read", error);
        HEWN_TRY(hewn_progress_report(stream->source->desc->progress, "load", (double)k / volume->dims[2], error));
    }
    return HEWN_OK;
}

static hewn_result read_pages(TIFF *file, const tiff_stream *stream, hewn_volume *volume, hewn_error *error)
{
    page first = read_page(file);
    HEWN_TRY(check_page(stream, &first, &first, 0, error));
    find_type(&first, &volume->type);
    volume->dims[0] = first.width;
    volume->dims[1] = first.height;
    volume->dims[2] = 1;
    read_description(file, volume);
    while (volume->dims[2] < UINT16_MAX && TIFFReadDirectory(file))
        volume->dims[2]++;
    HEWN_TRY(hewn_volume_head_check(stream->source, volume, NULL, error));
    return read_slices(file, stream, &first, volume, error);
}

hewn_result hewn_tiff_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    tiff_stream stream = {.source = source};
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, source->name, 0, "out of memory");
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &stream);
    TIFFOpenOptionsSetWarningHandlerExtR(options, keep_silent, NULL);
    TIFF *file = TIFFClientOpenExt(source->name, "rm", &stream, read_bytes, write_bytes, seek, close_nothing, size_of,
                                   NULL, NULL, options);
    TIFFOpenOptionsFree(options);
    if (!file)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "not a TIFF file%s%s",
                            stream.message[0] ? ": " : "", stream.message);
    hewn_result result = read_pages(file, &stream, &volume, error);
    TIFFClose(file);
    if (result == HEWN_OK)
        *out = volume;
    else
        hewn_volume_destroy(&volume);
    return result;
}
