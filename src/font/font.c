#include "font/font.h"

#include <hb-ft.h>
#include <hb-ot.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include FT_OUTLINE_H

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"

enum { FONT_LIMIT = 1 << 28 };

/* What FreeType says of an error, in its words. */
static const char *reason_of(FT_Error code)
{
    const char *text = FT_Error_String(code);
    switch (FT_ERROR_BASE(code)) {
    case FT_Err_Unknown_File_Format: return "it is no font file that is known";
    case FT_Err_Invalid_Table: return "one of its tables is broken";
    case FT_Err_Invalid_Outline: return "an outline is broken";
    case FT_Err_Invalid_Stream_Operation:
    case FT_Err_Invalid_Stream_Read: return "it ends too early";
    case FT_Err_Invalid_File_Format: return "its data are broken";
    case FT_Err_Out_Of_Memory: return "out of memory";
    case FT_Err_Invalid_Argument: return "it has no such face";
    default: return text ? text : "FreeType cannot read it";
    }
}

static hewn_result fail(FT_Error code, const char *what, hewn_error *error)
{
    bool memory = FT_ERROR_BASE(code) == FT_Err_Out_Of_Memory;
    return hewn_fail(error, memory ? HEWN_OUT_OF_MEMORY : HEWN_BAD_INPUT, "%s: %s (FreeType's error 0x%02x)", what,
                     reason_of(code), (unsigned)code);
}

static hewn_result check_face(hewn_font *font, hewn_error *error)
{
    FT_Face face = font->face;
    if (!FT_IS_SFNT(face) || !FT_IS_SCALABLE(face) || face->units_per_EM < 16)
        return hewn_fail(error, HEWN_BAD_INPUT, "not a font with TrueType or OpenType outlines");
    font->units = face->units_per_EM;
    font->grid = exp2(floor(log2(131072 / font->units)));
    snprintf(font->name, sizeof font->name, "%s%s%s", face->family_name ? face->family_name : "",
             face->family_name && face->style_name ? " " : "", face->style_name ? face->style_name : "");
    for (char *at = font->name; *at; at++)
        if ((unsigned char)*at < 0x20 || *at == 0x7F)
            *at = '?';
    return HEWN_OK;
}

static hewn_result open_shaper(hewn_font *font, hewn_error *error)
{
    hb_face_t *face = hb_ft_face_create(font->face, NULL);
    font->shaper = hb_font_create(face);
    hb_face_destroy(face);
    if (font->shaper == hb_font_get_empty())
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a font");
    hb_ot_font_set_funcs(font->shaper);
    hb_font_set_scale(font->shaper, (int)font->units, (int)font->units);
    return HEWN_OK;
}

/* Takes the bytes, also where it fails. */
static hewn_result open_bytes(char *bytes, size_t length, uint32_t face, hewn_font **out, hewn_error *error)
{
    hewn_font *font = hewn_alloc_zero(1, sizeof *font);
    if (!font) {
        hewn_free(bytes);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a font");
    }
    font->bytes = bytes;
    hewn_result result = HEWN_OK;
    FT_Error code = FT_Init_FreeType(&font->library);
    if (code == 0 && face <= 0xFFFF)
        code = FT_New_Memory_Face(font->library, (const FT_Byte *)bytes, (FT_Long)length, (FT_Long)face, &font->face);
    if (code != 0 || !font->face)
        result = fail(code ? code : FT_Err_Invalid_Argument, "not a font that can be read", error);
    if (result == HEWN_OK)
        result = check_face(font, error);
    if (result == HEWN_OK)
        result = open_shaper(font, error);
    if (result != HEWN_OK)
        hewn_font_destroy(&font);
    *out = font;
    return result;
}

hewn_result hewn_font_from_memory(const void *bytes, size_t length, uint32_t face, hewn_font **out, hewn_error *error)
{
    *out = NULL;
    if (!bytes || length > FONT_LIMIT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a font has bytes, and not more than %d of them", FONT_LIMIT);
    char *copy = hewn_alloc(length, 1);
    if (!copy)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a font");
    memcpy(copy, bytes, length);
    return open_bytes(copy, length, face, out, error);
}

hewn_result hewn_font_open(const char *path, uint32_t face, hewn_font **out, hewn_error *error)
{
    char *bytes = NULL;
    size_t length = 0;
    hewn_error reason = {0};
    *out = NULL;
    HEWN_TRY(hewn_file_read(path, FONT_LIMIT, &bytes, &length, error));
    hewn_result result = open_bytes(bytes, length, face, out, &reason);
    return result == HEWN_OK ? HEWN_OK : hewn_fail_at(error, result, path, 0, "%s", reason.message);
}

void hewn_font_destroy(hewn_font **font)
{
    hewn_font *own = *font;
    if (!own)
        return;
    hb_font_destroy(own->shaper);
    if (own->face)
        FT_Done_Face(own->face);
    if (own->library)
        FT_Done_FreeType(own->library);
    hewn_free(own->bytes);
    hewn_free(own);
    *font = NULL;
}

const char *hewn_font_name(const hewn_font *font)
{
    return font->name;
}

/* --- outlines ------------------------------------------------------------------------------------------------------
 */

/* An outline on its way from FreeType. Where `result` is a failure nothing more is handed on. */
typedef struct pen {
    hewn_take_curve *take;
    void *user;
    double scale, move[2], first[2], at[2];
    hewn_result result;
    hewn_error *error;
} pen;

static void place(const pen *own, const FT_Vector *from, double to[2])
{
    to[0] = own->scale * (double)from->x + own->move[0];
    to[1] = own->scale * (double)from->y + own->move[1];
}

static int draw(pen *own, unsigned degree, const double (*points)[2])
{
    if (own->result == HEWN_OK)
        own->result = own->take(own->user, degree, points, own->error);
    memcpy(own->at, points[degree], sizeof own->at);
    return own->result == HEWN_OK ? 0 : FT_Err_Invalid_Outline;
}

static int close_contour(pen *own)
{
    const double back[2][2] = {{own->at[0], own->at[1]}, {own->first[0], own->first[1]}};
    return draw(own, 1, back);
}

static int move_to(const FT_Vector *to, void *user)
{
    pen *own = user;
    int status = close_contour(own);
    place(own, to, own->first);
    memcpy(own->at, own->first, sizeof own->at);
    return status;
}

static int curve_to(const FT_Vector *a, const FT_Vector *b, const FT_Vector *c, unsigned degree, pen *own)
{
    const FT_Vector *given[3] = {a, b, c};
    double points[4][2] = {{own->at[0], own->at[1]}};
    for (unsigned i = 0; i < degree; i++)
        place(own, given[i], points[i + 1]);
    return draw(own, degree, (const double(*)[2])points);
}

static int line_to(const FT_Vector *to, void *user)
{
    return curve_to(to, NULL, NULL, 1, user);
}

static int conic_to(const FT_Vector *control, const FT_Vector *to, void *user)
{
    return curve_to(control, to, NULL, 2, user);
}

static int cubic_to(const FT_Vector *one, const FT_Vector *two, const FT_Vector *to, void *user)
{
    return curve_to(one, two, to, 3, user);
}

hewn_result hewn_font_walk(hewn_font *font, uint32_t glyph, double scale, const double move[2], hewn_take_curve *take,
                           void *user, hewn_error *error)
{
    static const FT_Outline_Funcs calls = {
        .move_to = move_to, .line_to = line_to, .conic_to = conic_to, .cubic_to = cubic_to};
    char what[64];
    snprintf(what, sizeof what, "the font's glyph %u", glyph);
    FT_Error code = FT_Load_Glyph(font->face, glyph, FT_LOAD_NO_SCALE | FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP);
    if (code != 0)
        return fail(code, what, error);
    if (font->face->glyph->format != FT_GLYPH_FORMAT_OUTLINE)
        return hewn_fail(error, HEWN_BAD_INPUT, "%s is no outline", what);
    pen own = {.take = take, .user = user, .scale = scale, .move = {move[0], move[1]}, .error = error};
    code = FT_Outline_Decompose(&font->face->glyph->outline, &calls, &own);
    if (code == 0)
        close_contour(&own);
    HEWN_TRY(own.result);
    return code ? fail(code, what, error) : HEWN_OK;
}

/* Where chords go. */
typedef struct chords {
    hewn_grid_sides *sides;
    double off;
} chords;

static hewn_result add_chords(void *user, unsigned degree, const double (*points)[2], hewn_error *error)
{
    const chords *own = user;
    return hewn_grid_add_curve(own->sides, degree, points, own->off, error);
}

hewn_result hewn_font_add_glyph(hewn_font *font, uint32_t glyph, int64_t x, int64_t y, hewn_grid_sides *sides,
                                hewn_error *error)
{
    chords own = {sides, font->units * font->grid / 4096};
    return hewn_font_walk(font, glyph, font->grid, (const double[2]){(double)x, (double)y}, add_chords, &own, error);
}
