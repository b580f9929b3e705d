/* NumPy's arrays: a magic, a version, and a Python dictionary of three keys as text (NumPy Enhancement Proposal 1). */
#include <string.h>

#include "base/error.h"
#include "io/bytes.h"
#include "io/volume/formats.h"

enum { MOST_AXES = 4 };

typedef struct npy_header {
    const char *at, *end; /* of the text that is left */
    const char *name;
    bool big_endian, fortran, has_type, has_order, has_shape;
    hewn_voxel type;
    uint64_t shape[MOST_AXES];
    uint32_t axes;
} npy_header;

static hewn_result bad(const npy_header *header, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0, "the array's header %s", what);
}

static void skip_blanks(npy_header *header)
{
    while (header->at < header->end && (*header->at == ' ' || *header->at == '\n' || *header->at == '\t'))
        header->at++;
}

static bool take(npy_header *header, const char *text)
{
    size_t length = strlen(text);
    skip_blanks(header);
    if ((size_t)(header->end - header->at) < length || memcmp(header->at, text, length) != 0)
        return false;
    header->at += length;
    return true;
}

/* Text between quotes of either kind. */
static bool take_string(npy_header *header, char out[16])
{
    skip_blanks(header);
    if (header->at == header->end || (*header->at != '\'' && *header->at != '"'))
        return false;
    const char *begin = header->at + 1, *end = memchr(begin, *header->at, (size_t)(header->end - begin));
    if (!end || end - begin > 15)
        return false;
    memcpy(out, begin, (size_t)(end - begin));
    out[end - begin] = '\0';
    header->at = end + 1;
    return true;
}

static hewn_result read_type(npy_header *header, hewn_error *error)
{
    static const struct {
        const char *code;
        hewn_voxel type;
    } codes[] = {{"i1", HEWN_VOXEL_INT8},   {"u1", HEWN_VOXEL_UINT8},  {"b1", HEWN_VOXEL_UINT8},
                 {"i2", HEWN_VOXEL_INT16},  {"u2", HEWN_VOXEL_UINT16}, {"i4", HEWN_VOXEL_INT32},
                 {"u4", HEWN_VOXEL_UINT32}, {"i8", HEWN_VOXEL_INT64},  {"u8", HEWN_VOXEL_UINT64},
                 {"f2", HEWN_VOXEL_HALF},   {"f4", HEWN_VOXEL_FLOAT},  {"f8", HEWN_VOXEL_DOUBLE}};
    char text[16];
    if (!take_string(header, text))
        return bad(header, "has no simple type of element (\"descr\")", error);
    bool ordered = text[0] == '<' || text[0] == '>' || text[0] == '|' || text[0] == '=';
    const char *code = ordered ? text + 1 : text;
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
        if (strcmp(code, codes[i].code) == 0) {
            header->type = codes[i].type;
            header->big_endian = text[0] == '>';
            header->has_type = true;
            return HEWN_OK;
        }
    }
    return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0,
                        "elements of the type '%s' are not numbers of a kind that volumes have", text);
}

static hewn_result read_shape(npy_header *header, hewn_error *error)
{
    if (!take(header, "("))
        return bad(header, "has no shape", error);
    while (!take(header, ")")) {
        uint64_t size = 0;
        skip_blanks(header);
        const char *begin = header->at;
        for (; header->at < header->end && *header->at >= '0' && *header->at <= '9'; header->at++)
            if (size <= UINT32_MAX)
                size = 10 * size + (uint64_t)(*header->at - '0');
        if (header->at == begin || header->axes == MOST_AXES)
            return bad(header, "has a shape that is not of 1 to 4 whole numbers", error);
        header->shape[header->axes++] = size;
        (void)(take(header, "L") || true); /* Python 2 wrote long numbers so */
        if (!take(header, ",") && (header->at == header->end || *header->at != ')'))
            return bad(header, "has a shape that is not of 1 to 4 whole numbers", error);
    }
    header->has_shape = true;
    return header->axes > 0 ? HEWN_OK : bad(header, "tells of a single number, not of a volume", error);
}

static hewn_result read_dictionary(npy_header *header, hewn_error *error)
{
    if (!take(header, "{"))
        return bad(header, "is not a dictionary", error);
    while (!take(header, "}")) {
        char key[16];
        if (!take_string(header, key) || !take(header, ":"))
            return bad(header, "is damaged", error);
        if (strcmp(key, "descr") == 0) {
            HEWN_TRY(read_type(header, error));
        } else if (strcmp(key, "shape") == 0) {
            HEWN_TRY(read_shape(header, error));
        } else if (strcmp(key, "fortran_order") == 0) {
            header->fortran = take(header, "True");
            header->has_order = header->fortran || take(header, "False");
        } else {
            return bad(header, "has a key that it should not have", error);
        }
        skip_blanks(header);
        if (!take(header, ",") && (header->at == header->end || *header->at != '}'))
            return bad(header, "is damaged", error);
    }
    return header->has_type && header->has_order && header->has_shape ? HEWN_OK : bad(header, "is incomplete", error);
}

/* The axis along which neighbours lie side by side is i: the last one, or Fortran's first. The slowest of four is that
 * of frames. */
static hewn_result set_dims(const npy_header *header, hewn_volume *volume, hewn_error *error)
{
    for (uint32_t i = 0; i < header->axes; i++) {
        uint64_t size = header->shape[header->fortran ? i : header->axes - 1 - i];
        if (i < 3 && size > UINT32_MAX)
            return bad(header, "has a shape past what is possible", error);
        if (i < 3)
            volume->dims[i] = (uint32_t)size;
        else
            volume->frame_count = size;
    }
    return HEWN_OK;
}

hewn_result hewn_npy_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    npy_header header = {.name = source->name};
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    if (source->length < 12 || memcmp(source->bytes, "\x93NUMPY", 6) != 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "not an array of NumPy's");
    int version = (unsigned char)source->bytes[6];
    if (version < 1 || version > 3)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "version %d of NumPy's format is unknown", version);
    size_t begin = version == 1 ? 10 : 12;
    size_t length = version == 1 ? hewn_get_u16(source->bytes + 8) : hewn_get_u32(source->bytes + 8);
    if (length > source->length - begin)
        return bad(&header, "is longer than the file", error);
    header.at = source->bytes + begin;
    header.end = header.at + length;
    HEWN_TRY(read_dictionary(&header, error));
    HEWN_TRY(set_dims(&header, &volume, error));
    volume.type = header.type;
    HEWN_TRY(hewn_volume_head_check(source, &volume, NULL, error));
    HEWN_TRY(hewn_volume_take_samples(source, begin + length, header.big_endian, &volume, error));
    *out = volume;
    return HEWN_OK;
}
