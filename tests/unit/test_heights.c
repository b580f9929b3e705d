/* Heights from pictures: what the samples of each kind of file become, and what is said of bad ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

#include "hewn/heights.h"

enum { COLUMNS = 13, ROWS = 7 };

static char path[64];

static double share(uint32_t x, uint32_t y)
{
    return (double)((x * 37 + y * 101) % 256) / 255;
}

/* A picture by libpng: depth 8 or 16, with alpha or interlaced. */
static void write_png(int depth, int colour, bool interlaced)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, COLUMNS, ROWS, depth, colour, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    int channels = colour == PNG_COLOR_TYPE_RGB ? 3 : colour == PNG_COLOR_TYPE_GRAY_ALPHA ? 2 : 1;
    static uint8_t bytes[ROWS][COLUMNS * 8];
    png_bytep rows[ROWS];
    for (uint32_t y = 0; y < ROWS; y++) {
        rows[y] = bytes[y];
        for (uint32_t x = 0; x < COLUMNS; x++)
            for (int c = 0; c < channels; c++) {
                uint32_t value = c == 0 ? (uint32_t)lround(255 * share(x, y)) : 77;
                size_t at = (size_t)((int)x * channels + c);
                if (depth == 16) {
                    bytes[y][2 * at] = (uint8_t)value;
                    bytes[y][2 * at + 1] = (uint8_t)value; /* 257 times as much */
                } else {
                    bytes[y][at] = (uint8_t)value;
                }
            }
    }
    png_write_image(png, rows);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(file), 0);
}

static void expect_shares(void)
{
    hewn_heightmap map;
    hewn_error error = {0};
    if (hewn_heightmap_read(path, NULL, &map, &error) != HEWN_OK)
        fail_msg("%s: %s", path, error.message);
    assert_int_equal(map.columns, COLUMNS);
    assert_int_equal(map.rows, ROWS);
    for (uint32_t y = 0; y < ROWS; y++)
        for (uint32_t x = 0; x < COLUMNS; x++) /* the file's last row has the least y */
            assert_true(fabs((double)map.values[x + COLUMNS * y] - share(x, ROWS - 1 - y)) < 1e-6);
    hewn_heightmap_destroy(&map);
}

static void expect_error(hewn_result code, const char *message)
{
    hewn_heightmap map;
    hewn_error error = {0};
    hewn_result result = hewn_heightmap_read(path, NULL, &map, &error);
    if (result != code || !strstr(error.message, message))
        fail_msg("%s: %s, expected '%s'", hewn_result_name(result), error.message, message);
    assert_null(map.values);
}

static void pictures_are_shares(void **state)
{
    (void)state;
    strcpy(path + strlen(path) - 3, "png");
    write_png(8, PNG_COLOR_TYPE_GRAY, false);
    expect_shares();
    write_png(16, PNG_COLOR_TYPE_GRAY, false);
    expect_shares();
    write_png(16, PNG_COLOR_TYPE_GRAY, true);
    expect_shares();
    write_png(16, PNG_COLOR_TYPE_GRAY_ALPHA, false);
    expect_shares();
    write_png(8, PNG_COLOR_TYPE_RGB, false);
    expect_error(HEWN_BAD_INPUT, "colours");
}

static void broken_pictures_are_refused(void **state)
{
    (void)state;
    strcpy(path + strlen(path) - 3, "png");
    write_png(16, PNG_COLOR_TYPE_GRAY, false);
    FILE *file = fopen(path, "rb");
    static char bytes[4096];
    size_t length = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    for (size_t cut = 0; cut < length; cut += 5) {
        file = fopen(path, "wb");
        assert_int_equal(fwrite(bytes, 1, cut, file), cut);
        fclose(file);
        hewn_heightmap map;
        hewn_error error = {0};
        hewn_result result = hewn_heightmap_read(path, NULL, &map, &error);
        bool whole = result == HEWN_OK && cut + 12 >= length; /* only what ends the file is missing */
        if (!whole && (result != HEWN_BAD_INPUT || map.values || !strstr(error.file, ".png")))
            fail_msg("%zu of %zu bytes: %s: %s", cut, length, hewn_result_name(result), error.message);
        hewn_heightmap_destroy(&map);
    }
}

static void write_tiff(bool floats, bool bad)
{
    TIFF *tiff = TIFFOpen(path, "w");
    assert_non_null(tiff);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, COLUMNS);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, ROWS);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, floats ? 32 : 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, floats ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, ROWS);
    for (uint32_t y = 0; y < ROWS; y++) {
        float values[COLUMNS];
        uint16_t words[COLUMNS];
        for (uint32_t x = 0; x < COLUMNS; x++) {
            values[x] = bad && x == 4 && y == 2 ? NAN : (float)share(x, y);
            words[x] = (uint16_t)lround(65535 * share(x, y));
        }
        assert_int_equal(TIFFWriteScanline(tiff, floats ? (void *)values : (void *)words, y, 0), 1);
    }
    TIFFClose(tiff);
}

static void tiffs_are_heights(void **state)
{
    (void)state;
    strcpy(path + strlen(path) - 3, "tif");
    write_tiff(true, false);
    expect_shares();
    write_tiff(false, false);
    expect_shares();
    write_tiff(true, true);
    expect_error(HEWN_BAD_INPUT, "column 4 of row 2");
}

static int make_name(void **state)
{
    (void)state;
    snprintf(path, sizeof path, "/tmp/hewn-heights-%ld.tif", (long)getpid());
    return 0;
}

static int remove_files(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        strcpy(path + strlen(path) - 3, i ? "png" : "tif");
        unlink(path);
    }
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_shares),
        cmocka_unit_test(broken_pictures_are_refused),
        cmocka_unit_test(tiffs_are_heights),
    };
    return cmocka_run_group_tests(tests, make_name, remove_files);
}
