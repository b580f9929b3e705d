/* NIfTI-1 (Cox and others 2004) and NIfTI-2 (2011), in one file or two, and ANALYZE 7.5, their ancestor. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/bytes.h"
#include "io/volume/formats.h"

/* What both versions' headers say. */
typedef struct nifti_header {
    const char *name;
    bool big_endian, second, nifti, separate; /* second: NIfTI-2; separate: samples in another file */
    int64_t dim[8];
    double pixdim[8], quatern[3], offset[3], srow[12];
    int64_t vox_offset, type;
    double slope, intercept;
    int64_t qform, sform, units;
    char description[81];
} nifti_header;

/* --- taking numbers from bytes ------------------------------------------------------------------------------------ */

typedef struct reader {
    const char *bytes;
    bool big;
} reader;

static int64_t get_i16(const reader *from, size_t at)
{
    const char *bytes = from->bytes + at;
    return (int16_t)(from->big ? hewn_get_u16_big(bytes) : hewn_get_u16(bytes));
}

static int64_t get_i32(const reader *from, size_t at)
{
    const char *bytes = from->bytes + at;
    return (int32_t)(from->big ? hewn_get_u32_big(bytes) : hewn_get_u32(bytes));
}

static int64_t get_i64(const reader *from, size_t at)
{
    const char *bytes = from->bytes + at;
    return (int64_t)(from->big ? hewn_get_u64_big(bytes) : hewn_get_u64(bytes));
}

static double get_real(const reader *from, size_t at, bool wide)
{
    const char *bytes = from->bytes + at;
    if (wide)
        return from->big ? hewn_get_double_big(bytes) : hewn_get_double(bytes);
    return (double)(from->big ? hewn_get_float_big(bytes) : hewn_get_float(bytes));
}

static void get_reals(const reader *from, size_t at, bool wide, size_t count, double *out)
{
    for (size_t i = 0; i < count; i++)
        out[i] = get_real(from, at + i * (wide ? 8 : 4), wide);
}

static void read_first(const reader *from, nifti_header *out)
{
    for (size_t i = 0; i < 8; i++)
        out->dim[i] = get_i16(from, 40 + 2 * i);
    get_reals(from, 76, false, 8, out->pixdim);
    double offset = get_real(from, 108, false);
    out->vox_offset = offset >= 0 && offset < 0x1p62 ? (int64_t)offset : -1;
    out->type = get_i16(from, 70);
    memcpy(out->description, from->bytes + 148, 80);
    if (!out->nifti)
        return;
    out->slope = get_real(from, 112, false);
    out->intercept = get_real(from, 116, false);
    out->units = (unsigned char)from->bytes[123];
    out->qform = get_i16(from, 252);
    out->sform = get_i16(from, 254);
    get_reals(from, 256, false, 3, out->quatern);
    get_reals(from, 268, false, 3, out->offset);
    get_reals(from, 280, false, 12, out->srow);
}

static void read_second(const reader *from, nifti_header *out)
{
    for (size_t i = 0; i < 8; i++)
        out->dim[i] = get_i64(from, 16 + 8 * i);
    get_reals(from, 104, true, 8, out->pixdim);
    out->vox_offset = get_i64(from, 168);
    out->type = get_i16(from, 12);
    memcpy(out->description, from->bytes + 240, 80);
    out->slope = get_real(from, 176, true);
    out->intercept = get_real(from, 184, true);
    out->qform = get_i32(from, 344);
    out->sform = get_i32(from, 348);
    get_reals(from, 352, true, 3, out->quatern);
    get_reals(from, 376, true, 3, out->offset);
    get_reals(from, 400, true, 12, out->srow);
    out->units = get_i32(from, 500);
}

static hewn_result read_header(const hewn_volume_source *source, nifti_header *out, hewn_error *error)
{
    *out = (nifti_header){.name = source->name};
    uint32_t little = source->length >= 4 ? hewn_get_u32(source->bytes) : 0;
    uint32_t big = source->length >= 4 ? hewn_get_u32_big(source->bytes) : 0;
    out->big_endian = big == 348 || big == 540;
    out->second = little == 540 || big == 540;
    if (!out->big_endian && little != 348 && little != 540)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "not a NIfTI file: its header is of no known size");
    if (source->length < (out->second ? 540 : 348))
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "the file ends in its header");
    const reader from = {source->bytes, out->big_endian};
    const char *magic = source->bytes + (out->second ? 4 : 344);
    char number = out->second ? '2' : '1';
    out->nifti = magic[0] == 'n' && (magic[1] == '+' || magic[1] == 'i') && magic[2] == number && magic[3] == '\0';
    out->separate = !out->nifti || magic[1] == 'i';
    if (out->second && !out->nifti)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "not a NIfTI-2 file: its magic is another");
    if (out->second)
        read_second(&from, out);
    else
        read_first(&from, out);
    return HEWN_OK;
}

/* --- what they mean ----------------------------------------------------------------------------------------------- */

static hewn_result set_type(const nifti_header *header, hewn_volume *volume, hewn_error *error)
{
    static const struct {
        int64_t code;
        hewn_voxel type;
    } codes[] = {{2, HEWN_VOXEL_UINT8},    {4, HEWN_VOXEL_INT16},    {8, HEWN_VOXEL_INT32},    {16, HEWN_VOXEL_FLOAT},
                 {64, HEWN_VOXEL_DOUBLE},  {256, HEWN_VOXEL_INT8},   {512, HEWN_VOXEL_UINT16}, {768, HEWN_VOXEL_UINT32},
                 {1024, HEWN_VOXEL_INT64}, {1280, HEWN_VOXEL_UINT64}};
    static const struct {
        int64_t code;
        const char *name;
    } others[] = {{1, "single bits"},        {32, "complex numbers"},   {128, "colours"}, {1536, "128-bit floats"},
                  {1792, "complex numbers"}, {2048, "complex numbers"}, {2304, "colours"}};
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
        if (codes[i].code == header->type) {
            volume->type = codes[i].type;
            return HEWN_OK;
        }
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i].code == header->type)
            return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0,
                                "the voxels are %s (type %d), which have no surface", others[i].name,
                                (int)header->type);
    return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0, "type %lld of voxels is unknown",
                        (long long)header->type);
}

static hewn_result set_dims(const nifti_header *header, hewn_volume *volume, hewn_error *error)
{
    int64_t axes = header->dim[0];
    if (axes < 1 || axes > 7)
        return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0, "the header tells of %lld axes, not 1 to 7",
                            (long long)axes);
    for (int64_t i = 1; i <= axes; i++) {
        int64_t size = header->dim[i];
        if (size < (i <= 3 ? 1 : 0) || size > UINT32_MAX)
            return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0,
                                "the header tells of %lld voxels along axis %lld", (long long)size, (long long)i);
        if (i <= 3)
            volume->dims[i - 1] = (uint32_t)size;
        else if (size > 0 && __builtin_mul_overflow(volume->frame_count, (uint64_t)size, &volume->frame_count))
            return hewn_fail_at(error, HEWN_LIMIT, header->name, 0,
                                "the header tells of more frames than can be counted");
    }
    return HEWN_OK;
}

/* Lengths of the voxels' edges. An axis that is not there needs none, and some programs write negative ones. */
static void get_spacing(const nifti_header *header, double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        bool flat = header->dim[0] <= axis || header->dim[axis + 1] == 1;
        double given = fabs(header->pixdim[axis + 1]);
        out[axis] = flat && !(given > 0) ? 1 : given;
    }
}

/* Method 2 of the standard: a rotation as a quaternion whose first part is left out, which is not negative. */
static void set_quatern(const nifti_header *header, hewn_volume *volume)
{
    double b = header->quatern[0], c = header->quatern[1], d = header->quatern[2], spacing[3];
    double rest = 1 - (b * b + c * c + d * d), a = 0;
    if (rest > 1e-7) {
        a = sqrt(rest);
    } else { /* half a turn, rounded: bring it to length 1 */
        double length = sqrt(b * b + c * c + d * d);
        b /= length;
        c /= length;
        d /= length;
    }
    get_spacing(header, spacing);
    double third = header->pixdim[0] < 0 ? -spacing[2] : spacing[2];
    double columns[3][3] = {
        {spacing[0] * (a * a + b * b - c * c - d * d), spacing[0] * 2 * (b * c + a * d),
         spacing[0] * 2 * (b * d - a * c)},
        {spacing[1] * 2 * (b * c - a * d), spacing[1] * (a * a + c * c - b * b - d * d),
         spacing[1] * 2 * (c * d + a * b)},
        {third * 2 * (b * d + a * c), third * 2 * (c * d - a * b), third * (a * a + d * d - b * b - c * c)}};
    hewn_volume_place(volume, columns, header->offset);
    volume->anatomical = true;
}

/* An affine goes before a rotation, as most programs have it; where there is neither, only spacings are known. */
static void set_place(const nifti_header *header, hewn_volume *volume)
{
    double spacing[3];
    get_spacing(header, spacing);
    if (header->sform > 0) {
        memcpy(volume->to_world, header->srow, sizeof header->srow);
        volume->anatomical = true;
    } else if (header->qform > 0) {
        set_quatern(header, volume);
    } else {
        for (int axis = 0; axis < 3; axis++)
            volume->to_world[5 * axis] = spacing[axis];
    }
    int64_t code = header->units & 7;
    volume->unit = hewn_unit_find(code == 1 ? "m" : code == 2 ? "mm" : code == 3 ? "um" : "");
}

/* A slope of 0 or NaN says that there is none. */
static hewn_result set_scale(const nifti_header *header, hewn_volume *volume, hewn_error *error)
{
    if (!header->nifti || header->slope == 0 || isnan(header->slope))
        return HEWN_OK;
    if (isinf(header->slope) || isinf(header->intercept))
        return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0, "the scale of the values is infinite");
    volume->slope = header->slope;
    volume->intercept = isnan(header->intercept) ? 0 : header->intercept;
    return HEWN_OK;
}

/* --- the samples -------------------------------------------------------------------------------------------------- */

/* Where the dot of ".hdr" or ".img" is, before a ".gz"; NULL for other names. */
static const char *pair_extension(const char *path)
{
    size_t length = strlen(path);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0)
        length -= 3;
    if (length < 4 ||
        (strncasecmp(path + length - 4, ".hdr", 4) != 0 && strncasecmp(path + length - 4, ".img", 4) != 0))
        return NULL;
    return path + length - 4;
}

char *hewn_nifti_twin(const char *path)
{
    const char *dot = pair_extension(path);
    char *twin = dot ? hewn_strdup(path) : NULL;
    if (!twin)
        return NULL;
    bool upper = dot[1] < 'a';
    bool header = strncasecmp(dot, ".hdr", 4) == 0;
    memcpy(twin + (dot - path) + 1, header ? (upper ? "IMG" : "img") : (upper ? "HDR" : "hdr"), 3);
    return twin;
}

/* Tries the other file as it is named, and compressed where the header is not, or the other way around. */
static hewn_result open_twin(const hewn_volume_source *header, hewn_volume_source *out, hewn_error *error)
{
    char *twin = header->path ? hewn_nifti_twin(header->path) : NULL;
    if (!twin)
        return hewn_fail_at(
            error, HEWN_BAD_INPUT, header->name, 0,
            "the samples are in a file of their own, which a header has only where its name ends in .hdr");
    size_t length = strlen(twin);
    bool packed = strcasecmp(twin + length - 3, ".gz") == 0;
    hewn_result result = hewn_volume_source_open(twin, header->desc, out, error);
    char *other = hewn_alloc(length + 4, 1);
    if (result == HEWN_IO && other) {
        memcpy(other, twin, length + 1);
        memcpy(other + (packed ? length - 3 : length), packed ? "" : ".gz", packed ? 1 : 4);
        if (hewn_volume_source_open(other, header->desc, out, NULL) == HEWN_OK)
            result = HEWN_OK;
    }
    out->name = out->path = header->name; /* the names above end here */
    hewn_free(other);
    hewn_free(twin);
    return result;
}

static hewn_result take_samples(hewn_volume_source *source, const nifti_header *header, hewn_volume *volume,
                                hewn_error *error)
{
    int64_t least = header->separate ? 0 : header->second ? 544 : 352;
    if (header->vox_offset < 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                            "the header says that samples begin before the file");
    uint64_t offset = (uint64_t)(header->vox_offset < least ? least : header->vox_offset);
    if (!header->separate)
        return hewn_volume_take_samples(source, offset, header->big_endian, volume, error);
    hewn_volume_source samples;
    HEWN_TRY(open_twin(source, &samples, error));
    hewn_result result = hewn_volume_take_samples(&samples, offset, header->big_endian, volume, error);
    hewn_volume_source_close(&samples);
    return result;
}

hewn_result hewn_nifti_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    nifti_header header;
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    HEWN_TRY(read_header(source, &header, error));
    HEWN_TRY(set_type(&header, &volume, error));
    HEWN_TRY(set_dims(&header, &volume, error));
    HEWN_TRY(set_scale(&header, &volume, error));
    set_place(&header, &volume);
    HEWN_TRY(hewn_volume_head_check(source, &volume, NULL, error));
    HEWN_TRY(take_samples(source, &header, &volume, error));
    volume.name = hewn_volume_text(header.description, strlen(header.description));
    *out = volume;
    return HEWN_OK;
}
