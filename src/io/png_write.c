/* Pictures as PNG, by libpng. */
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/srgb.h"
#include "hewn/picture.h"
#include "io/png_write.h"

typedef struct writing {
    hewn_output *output;
    hewn_result result; /* of the first write that failed */
    hewn_error *error;
} writing;

static void write_bytes(png_structp png, png_bytep bytes, size_t length)
{
    writing *w = png_get_io_ptr(png);
    w->result = hewn_output_write(w->output, bytes, length, w->error);
    if (w->result != HEWN_OK)
        png_error(png, "write");
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static void be_silent(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static uint8_t srgb(float linear)
{
    return (uint8_t)(255 * hewn_srgb_from_linear(linear > 0 ? fmin((double)linear, 1) : 0) + 0.5);
}

static uint8_t unit_byte(float value)
{
    return (uint8_t)(255 * fmin(fmax(0.5 + 0.5 * (double)value, 0), 1) + 0.5);
}

static void fill_row(const hewn_picture *picture, uint32_t y, uint8_t *row)
{
    if (picture->kind != HEWN_PICTURE_SCALAR) {
        const float *values = picture->values + (size_t)3 * picture->width * y;
        for (size_t i = 0; i < (size_t)3 * picture->width; i++)
            row[i] = picture->kind == HEWN_PICTURE_COLOUR ? srgb(values[i]) : unit_byte(values[i]);
        return;
    }
    const float *values = picture->values + (size_t)picture->width * y;
    double scale = picture->hi > picture->lo ? 65534 / (picture->hi - picture->lo) : 0;
    for (uint32_t x = 0; x < picture->width; x++) {
        double share = fmin(fmax(((double)values[x] - picture->lo) * scale, 0), 65534);
        unsigned grey = isnan(values[x]) ? 65535U : (unsigned)(share + 0.5);
        row[2 * x] = (uint8_t)(grey >> 8);
        row[2 * x + 1] = (uint8_t)grey;
    }
}

static void write_range(png_structp png, png_infop info, const hewn_picture *picture)
{
    char numbers[2][32];
    snprintf(numbers[0], sizeof numbers[0], "%.17g", picture->lo);
    snprintf(numbers[1], sizeof numbers[1], "%.17g", picture->hi);
    png_text texts[2] = {{.compression = PNG_TEXT_COMPRESSION_NONE, .key = (char[]){"lo"}, .text = numbers[0]},
                         {.compression = PNG_TEXT_COMPRESSION_NONE, .key = (char[]){"hi"}, .text = numbers[1]}};
    png_set_text(png, info, texts, 2);
}

/* What is written: a picture, or bytes as they are. */
typedef struct image {
    uint32_t width, height;
    const hewn_picture *picture; /* or NULL */
    const uint8_t *bytes;
    uint32_t channels;
} image;

static int colour_type(const image *own)
{
    bool scalar = own->picture ? own->picture->kind == HEWN_PICTURE_SCALAR : own->channels == 1;
    return scalar ? PNG_COLOR_TYPE_GRAY : own->channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB;
}

/* libpng leaves by longjmp; nothing here is changed after setjmp that is read afterwards. */
static bool write_png(const image *own, png_structp png, png_infop info, uint8_t *row)
{
    if (setjmp(png_jmpbuf(png)))
        return false;
    const hewn_picture *picture = own->picture;
    bool scalar = picture && picture->kind == HEWN_PICTURE_SCALAR;
    png_set_user_limits(png, 0x7FFFFFFF, 0x7FFFFFFF);
    png_set_IHDR(png, info, own->width, own->height, scalar ? 16 : 8, colour_type(own), PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, picture ? 4 : 9);
    if (scalar)
        write_range(png, info, picture);
    else if (picture && picture->kind == HEWN_PICTURE_COLOUR)
        png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (uint32_t y = 0; y < own->height; y++) {
        if (picture)
            fill_row(picture, y, row);
        else
            memcpy(row, own->bytes + (size_t)y * own->width * own->channels, (size_t)own->width * own->channels);
        png_write_row(png, row);
    }
    png_write_end(png, NULL);
    return true;
}

static hewn_result write_all(const image *own, hewn_output *output, hewn_error *error)
{
    writing w = {.output = output, .result = HEWN_OK, .error = error};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, be_silent);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    uint8_t *row = hewn_alloc(own->width, 6);
    bool made = info && row, written = false;
    if (made) {
        png_set_write_fn(png, &w, write_bytes, flush_nothing);
        written = write_png(own, png, info, row);
    }
    if (png)
        png_destroy_write_struct(&png, &info);
    hewn_free(row);
    if (w.result != HEWN_OK)
        return w.result;
    return written ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory writing a picture");
}

hewn_result hewn_png_write_bytes(hewn_output *output, const uint8_t *bytes, uint32_t width, uint32_t height,
                                 uint32_t channels, hewn_error *error)
{
    const image own = {.width = width, .height = height, .bytes = bytes, .channels = channels};
    return write_all(&own, output, error);
}

hewn_result hewn_picture_write(const hewn_picture *picture, const char *path, hewn_error *error)
{
    if (!picture->values || picture->width < 1 || picture->height < 1 || picture->width > 0x7FFFFFFF ||
        picture->height > 0x7FFFFFFF)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a picture of %u x %u pixels cannot be written", picture->width,
                         picture->height);
    const image own = {.width = picture->width, .height = picture->height, .picture = picture};
    hewn_output *output;
    HEWN_TRY(hewn_output_create(path, &output, error));
    hewn_result result = write_all(&own, output, error);
    if (result == HEWN_OK)
        return hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    return result;
}
