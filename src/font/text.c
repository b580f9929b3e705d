/* Lines of text: glyphs and their places from HarfBuzz, outlines of those that may overlap made one, each of these an
 * exact distance, and all together their minimum, which is exact because they lie apart. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/utf8.h"
#include "field/internal.h"
#include "font/font.h"

/* Work grows with the square of a group's sides. */
enum { TEXT_LIMIT = 10000, GROUP_SIDES = 8192, ALL_SIDES = 1 << 18 };

/* A glyph where it stands, in steps of the grid. */
typedef struct letter {
    uint32_t glyph;
    int64_t x, y;
    int64_t lo[2], hi[2]; /* of its outline */
    uint32_t group;       /* the first letter that its box touches, through others or itself */
    hewn_grid_sides sides;
} letter;

/* A text under way. */
typedef struct setting {
    hewn_font *font;
    const hewn_text_desc *desc;
    hb_buffer_t *buffer;
    letter *letters;
    size_t count, room;
    double step; /* of the grid, in scene units */
    int64_t baseline;
} setting;

static hewn_result check_text(const char *text, hewn_error *error)
{
    size_t count = 0;
    for (const char *at = text; *at; count++) {
        uint32_t value;
        size_t length = hewn_utf8_next(at, SIZE_MAX, &value);
        if (length == 0)
            return hewn_fail(error, HEWN_BAD_INPUT, "byte %zu of the text is not UTF-8", (size_t)(at - text) + 1);
        if (value < 0x20 && value != '\n' && value != '\t' && value != '\r')
            return hewn_fail(error, HEWN_BAD_INPUT, "character %zu of the text is a control character (U+%04X)",
                             count + 1, value);
        at += length;
    }
    if (count > TEXT_LIMIT)
        return hewn_fail(error, HEWN_LIMIT, "the text has %zu characters; %d are the most", count, (int)TEXT_LIMIT);
    return HEWN_OK;
}

/* --- lines ---------------------------------------------------------------------------------------------------------
 */

static hewn_result missing(const char *line, uint32_t cluster, hewn_error *error)
{
    uint32_t value = 0;
    size_t length = hewn_utf8_next(line + cluster, SIZE_MAX, &value);
    return hewn_fail(error, HEWN_BAD_INPUT, "the font has no glyph for '%.*s' (U+%04X)", (int)length, line + cluster,
                     value);
}

static hewn_result shape(setting *own, const char *line, size_t length, hewn_error *error)
{
    hb_buffer_clear_contents(own->buffer);
    hb_buffer_add_utf8(own->buffer, line, (int)length, 0, (int)length);
    hb_buffer_set_language(own->buffer, hb_language_from_string("und", -1)); /* not that of the user's machine */
    hb_buffer_guess_segment_properties(own->buffer);
    const hb_feature_t unkerned = {HB_TAG('k', 'e', 'r', 'n'), 0, 0, (unsigned)-1};
    hb_shape(own->font->shaper, own->buffer, &unkerned, own->desc->no_kerning ? 1 : 0);
    return hb_buffer_allocation_successful(own->buffer)
               ? HEWN_OK
               : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a text");
}

static hewn_result add_letter(setting *own, const letter *given, hewn_error *error)
{
    void *items = own->letters;
    HEWN_TRY(hewn_reserve(&items, &own->room, own->count + 1, sizeof *own->letters, error));
    own->letters = items;
    own->letters[own->count++] = *given;
    return HEWN_OK;
}

static hewn_result add_line(setting *own, const char *line, size_t length, hewn_error *error)
{
    unsigned count = 0;
    size_t first = own->count;
    int64_t grid = (int64_t)own->font->grid, x = 0, spacing = llround(own->desc->spacing / own->step);
    HEWN_TRY(shape(own, line, length, error));
    const hb_glyph_info_t *glyphs = hb_buffer_get_glyph_infos(own->buffer, &count);
    const hb_glyph_position_t *places = hb_buffer_get_glyph_positions(own->buffer, &count);
    for (unsigned i = 0; i < count; i++) {
        bool blank = line[glyphs[i].cluster] == '\t' || line[glyphs[i].cluster] == '\r';
        if (glyphs[i].codepoint == 0 && !blank)
            return missing(line, glyphs[i].cluster, error);
        letter own_letter = {.glyph = glyphs[i].codepoint,
                             .x = x + places[i].x_offset * grid,
                             .y = own->baseline + places[i].y_offset * grid};
        if (!blank)
            HEWN_TRY(add_letter(own, &own_letter, error));
        bool marks = i + 1 < count && glyphs[i + 1].cluster == glyphs[i].cluster; /* they stay where their letter is */
        if (line[glyphs[i].cluster] != '\r')
            x += (places[i].x_advance) * grid + (marks ? 0 : spacing);
        if (x > HEWN_GRID_MOST || x < -HEWN_GRID_MOST)
            return hewn_fail(error, HEWN_LIMIT, "a line of the text is too long");
    }
    x -= count > 0 ? spacing : 0;
    int64_t back = own->desc->align == HEWN_ALIGN_LEFT ? 0 : own->desc->align == HEWN_ALIGN_RIGHT ? x : x / 2;
    for (size_t i = first; i < own->count; i++)
        own->letters[i].x -= back;
    return HEWN_OK;
}

static hewn_result add_lines(setting *own, const char *text, hewn_error *error)
{
    hb_font_extents_t extents = {0};
    hb_font_get_h_extents(own->font->shaper, &extents);
    double height = extents.ascender - extents.descender + extents.line_gap;
    height = (height > 0 ? height : 1.2 * own->font->units) * own->font->grid;
    height *= own->desc->line_spacing > 0 ? own->desc->line_spacing : 1;
    for (size_t line = 0;; line++) {
        size_t length = strcspn(text, "\n");
        if (height * (double)line > (double)HEWN_GRID_MOST)
            return hewn_fail(error, HEWN_LIMIT, "the text has too many lines");
        own->baseline = -llround(height * (double)line);
        HEWN_TRY(add_line(own, text, length, error));
        if (text[length] == '\0')
            return HEWN_OK;
        text += length + 1;
    }
}

/* --- groups --------------------------------------------------------------------------------------------------------
 */

static hewn_result outline_letters(setting *own, hewn_error *error)
{
    size_t all = 0;
    for (size_t i = 0; i < own->count; i++) {
        letter *at = &own->letters[i];
        HEWN_TRY(hewn_font_add_glyph(own->font, at->glyph, at->x, at->y, &at->sides, error));
        if (at->sides.count > GROUP_SIDES)
            return hewn_fail(error, HEWN_LIMIT, "glyph %u of the font is too involved", at->glyph);
        all += at->sides.count;
        if (all > ALL_SIDES)
            return hewn_fail(error, HEWN_LIMIT, "the text has too many letters, or too involved ones");
        for (int axis = 0; axis < 2; axis++) {
            at->lo[axis] = HEWN_GRID_MOST;
            at->hi[axis] = -HEWN_GRID_MOST;
        }
        for (size_t k = 0; k < at->sides.count; k++) {
            const int64_t start[2] = {at->sides.items[k].a.x, at->sides.items[k].a.y};
            for (int axis = 0; axis < 2; axis++) {
                at->lo[axis] = start[axis] < at->lo[axis] ? start[axis] : at->lo[axis];
                at->hi[axis] = start[axis] > at->hi[axis] ? start[axis] : at->hi[axis];
            }
        }
    }
    return HEWN_OK;
}

static uint32_t group_of(letter *letters, uint32_t i)
{
    while (letters[i].group != i)
        i = letters[i].group = letters[letters[i].group].group;
    return i;
}

/* Letters whose boxes touch belong together. */
static void group_letters(setting *own)
{
    for (uint32_t i = 0; i < own->count; i++) {
        letter *one = &own->letters[i];
        one->group = i;
        for (uint32_t k = 0; k < i; k++) {
            const letter *other = &own->letters[k];
            if (one->lo[0] > other->hi[0] || other->lo[0] > one->hi[0] || one->lo[1] > other->hi[1] ||
                other->lo[1] > one->hi[1])
                continue;
            uint32_t a = group_of(own->letters, i), b = group_of(own->letters, k);
            own->letters[a > b ? a : b].group = a > b ? b : a;
        }
    }
}

/* The sides of a group's letters, without what lies within others. */
static hewn_result gather(setting *own, uint32_t group, hewn_grid_sides *out, hewn_error *error)
{
    for (uint32_t i = group; i < own->count; i++) {
        letter *at = &own->letters[i];
        if (group_of(own->letters, i) != group)
            continue;
        for (size_t k = 0; k < at->sides.count; k++)
            HEWN_TRY(hewn_grid_add(out, at->sides.items[k].a, at->sides.items[k].b, error));
        if (out->count > GROUP_SIDES)
            return hewn_fail(error, HEWN_LIMIT, "letters that overlap have more than %d sides together",
                             (int)GROUP_SIDES);
    }
    return hewn_grid_nonzero(out, GROUP_SIDES, error);
}

static hewn_result merge_groups(setting *own, hewn_error *error)
{
    for (uint32_t i = 0; i < own->count; i++) {
        if (group_of(own->letters, i) != i)
            continue;
        hewn_grid_sides sides = {0};
        hewn_result result = gather(own, i, &sides, error);
        hewn_grid_sides_clear(&own->letters[i].sides);
        own->letters[i].sides = sides; /* those of the others are not looked at again */
        HEWN_TRY(result);
    }
    return HEWN_OK;
}

/* --- the shape -----------------------------------------------------------------------------------------------------
 */

static double lift(const setting *own)
{
    int64_t lo = HEWN_GRID_MOST, hi = -HEWN_GRID_MOST;
    for (size_t i = 0; i < own->count; i++) {
        lo = own->letters[i].lo[1] < lo ? own->letters[i].lo[1] : lo;
        hi = own->letters[i].hi[1] > hi ? own->letters[i].hi[1] : hi;
    }
    switch (own->desc->anchor) {
    case HEWN_TEXT_TOP: return -own->step * (double)hi;
    case HEWN_TEXT_MIDDLE: return -0.5 * own->step * (double)(lo + hi);
    case HEWN_TEXT_BOTTOM: return -own->step * (double)lo;
    default: return 0;
    }
}

static hewn_result group_shape(const setting *own, hewn_field *field, const letter *group, double up, hewn_node *out,
                               hewn_error *error)
{
    hewn_grid_loops loops;
    HEWN_TRY(hewn_grid_loops_create(&group->sides, &loops, error));
    double *points = hewn_alloc(loops.point_count, 2 * sizeof *points);
    for (size_t i = 0; points && i < loops.point_count; i++) {
        points[2 * i] = own->step * (double)loops.points[i].x;
        points[2 * i + 1] = own->step * (double)loops.points[i].y + up;
    }
    if (points)
        *out = hewn_contours(field, points, loops.counts, loops.count);
    bool there = points != NULL;
    hewn_free(points);
    hewn_grid_loops_destroy(&loops);
    return there ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a text");
}

static hewn_result build(setting *own, hewn_field *field, const char *text, hewn_node *out, hewn_error *error)
{
    HEWN_TRY(add_lines(own, text, error));
    HEWN_TRY(outline_letters(own, error));
    group_letters(own);
    HEWN_TRY(merge_groups(own, error));
    double up = lift(own);
    bool any = false;
    for (uint32_t i = 0; i < own->count; i++) {
        if (own->letters[i].group != i || own->letters[i].sides.count == 0)
            continue;
        hewn_node one = HEWN_NODE_NONE;
        HEWN_TRY(group_shape(own, field, &own->letters[i], up, &one, error));
        *out = any ? hewn_union(field, *out, one) : one;
        any = true;
    }
    return any ? HEWN_OK : hewn_fail(error, HEWN_BAD_INPUT, "there is nothing to see of the text");
}

static hewn_result set(hewn_field *field, hewn_font *font, const char *text, const hewn_text_desc *desc, hewn_node *out,
                       hewn_error *error)
{
    if (!font || !text || !desc)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "it needs a font, a text and a description");
    if (!(desc->size > 0) || !(desc->size < 1e9))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "its size must be above 0 and finite, not %g", desc->size);
    if (!(fabs(desc->spacing) <= 100 * desc->size) || !(desc->line_spacing >= 0) || !(desc->line_spacing <= 100))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a spacing of %g, or of lines of %g, makes no sense",
                         desc->spacing, desc->line_spacing);
    HEWN_TRY(check_text(text, error));
    setting own = {
        .font = font, .desc = desc, .step = desc->size / (font->units * font->grid), .buffer = hb_buffer_create()};
    hewn_result result = build(&own, field, text, out, error);
    hb_buffer_destroy(own.buffer);
    for (size_t i = 0; i < own.count; i++)
        hewn_grid_sides_clear(&own.letters[i].sides);
    hewn_free(own.letters);
    return result;
}

hewn_node hewn_font_text(hewn_field *field, hewn_font *font, const char *text, const hewn_text_desc *desc)
{
    hewn_node out = HEWN_NODE_NONE;
    hewn_error reason = {0};
    if (!field)
        return out;
    hewn_result result = set(field, font, text, desc, &out, &reason);
    return result == HEWN_OK ? out : hewn_field_refuse(field, result, "text: %s", reason.message);
}
