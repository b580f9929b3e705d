/* Grey PNG files, by libpng. */
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/heights_read.h"

typedef struct reading {
    const char *bytes;
    size_t length, at;
    const char *name;
    char message[160];  /* libpng's complaint */
    uint8_t *row;       /* of samples as the file has them, */
    png_bytep *rows;    /* or all of them, where it is interlaced */
    hewn_heightmap map; /* until it is whole */
    hewn_result result;
    hewn_error *error;
} reading;

static void take_bytes(png_structp png, png_bytep to, size_t length)
{
    reading *r = png_get_io_ptr(png);
    if (length > r->length - r->at)
        png_error(png, "the file ends early");
    memcpy(to, r->bytes + r->at, length);
    r->at += length;
}

static void keep_complaint(png_structp png, png_const_charp text)
{
    reading *r = png_get_error_ptr(png);
    snprintf(r->message, sizeof r->message, "%s", text);
    png_longjmp(png, 1);
}

static void be_silent(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static bool refuse(reading *r, hewn_result code, const char *text)
{
    r->result = hewn_fail_at(r->error, code, r->name, 0, "%s", text);
    return false;
}

/* The header, and what libpng shall make of samples: one of 8 or 16 bits. */
static bool read_head(reading *r, png_structp png, png_infop info)
{
    png_read_info(png, info);
    png_byte colour = png_get_color_type(png, info), depth = png_get_bit_depth(png, info);
    r->map.columns = png_get_image_width(png, info);
    r->map.rows = png_get_image_height(png, info);
    if (colour & PNG_COLOR_MASK_COLOR)
        return refuse(r, HEWN_BAD_INPUT, "the picture has colours; heights are one grey channel");
    if ((uint64_t)r->map.columns * r->map.rows > HEWN_HEIGHTS_MOST)
        return refuse(r, HEWN_LIMIT, "the picture has more than 2^28 pixels");
    if (depth < 8)
        png_set_expand_gray_1_2_4_to_8(png);
    if (colour & PNG_COLOR_MASK_ALPHA)
        png_set_strip_alpha(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
}

static bool make_room(reading *r, size_t row_bytes, bool whole)
{
    r->map.values = hewn_alloc((size_t)r->map.columns * r->map.rows, sizeof *r->map.values);
    r->row = hewn_alloc(whole ? r->map.rows : 1, row_bytes);
    r->rows = hewn_alloc(whole ? r->map.rows : 1, sizeof *r->rows);
    if (!r->map.values || !r->row || !r->rows)
        return refuse(r, HEWN_OUT_OF_MEMORY, "out of memory for the picture");
    for (uint32_t y = 0; whole && y < r->map.rows; y++)
        r->rows[y] = r->row + row_bytes * y;
    return true;
}

static void convert_row(const reading *r, const uint8_t *row, bool deep, uint32_t y)
{
    float *out = r->map.values + (size_t)r->map.columns * y;
    for (uint32_t x = 0; x < r->map.columns; x++)
        out[x] = deep ? (float)(row[2 * x] << 8 | row[2 * x + 1]) / 65535.0F : (float)row[x] / 255.0F;
}

static bool read_all(reading *r, png_structp png, png_infop info)
{
    if (!read_head(r, png, info))
        return false;
    bool deep = png_get_bit_depth(png, info) == 16, whole = png_get_interlace_type(png, info) != PNG_INTERLACE_NONE;
    if (!make_room(r, png_get_rowbytes(png, info), whole))
        return false;
    if (whole)
        png_read_image(png, r->rows);
    for (uint32_t y = 0; y < r->map.rows; y++) {
        if (!whole)
            png_read_row(png, r->row, NULL);
        convert_row(r, whole ? r->rows[y] : r->row, deep, y);
    }
    return true;
}

hewn_result hewn_png_read(const char *bytes, size_t length, const char *name, hewn_heightmap *out, hewn_error *error)
{
    enum { CHUNK_MOST = 8 << 20, SIDE_MOST = 1 << 20 };
    *out = (hewn_heightmap){0};
    reading *r = hewn_alloc_zero(1, sizeof *r); /* a jump back would leave locals undefined */
    if (!r)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, name, 0, "out of memory for the picture");
    *r = (reading){.bytes = bytes, .length = length, .name = name, .error = error};
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, r, keep_complaint, be_silent);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    bool done = false;
    if (!info) {
        refuse(r, HEWN_OUT_OF_MEMORY, "out of memory for the picture");
    } else if (setjmp(png_jmpbuf(png)) == 0) {
        png_set_read_fn(png, r, take_bytes);
        png_set_user_limits(png, SIDE_MOST, SIDE_MOST);
        png_set_chunk_malloc_max(png, CHUNK_MOST);
        if (read_all(r, png, info))
            *out = r->map;
    } else {
        r->result = hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "not a picture that can be read: %s", r->message);
    }
    done = r->result == HEWN_OK;
    png_destroy_read_struct(&png, &info, NULL);
    if (!done)
        hewn_free(r->map.values);
    hewn_free(r->row);
    hewn_free(r->rows);
    hewn_result result = r->result;
    hewn_free(r);
    return result;
}
