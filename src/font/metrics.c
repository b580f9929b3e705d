/* What a font says about lines, characters and pairs of them. */
#include <hb-ot.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "font/font.h"

void hewn_font_measure(const hewn_font *font, hewn_font_metrics *out)
{
    hb_font_extents_t extents = {0};
    hb_font_get_h_extents(font->shaper, &extents);
    double unit = 1 / font->units;
    double height = extents.ascender - extents.descender + extents.line_gap;
    *out = (hewn_font_metrics){.line_height = height > 0 ? height * unit : 1.2,
                               .ascender = extents.ascender * unit,
                               .descender = extents.descender * unit,
                               .underline_y = font->face->underline_position * unit,
                               .underline_thickness = font->face->underline_thickness * unit};
}

uint32_t hewn_font_glyph(const hewn_font *font, uint32_t character)
{
    hb_codepoint_t glyph = 0;
    return hb_font_get_nominal_glyph(font->shaper, character, &glyph) ? glyph : 0;
}

double hewn_font_advance(const hewn_font *font, uint32_t glyph)
{
    return hb_font_get_glyph_h_advance(font->shaper, glyph) / font->units;
}

static hewn_result no_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a font's characters");
}

hewn_result hewn_font_characters(const hewn_font *font, uint32_t **out, size_t *count, hewn_error *error)
{
    *out = NULL;
    *count = 0;
    hb_set_t *set = hb_set_create();
    hb_face_collect_unicodes(hb_font_get_face(font->shaper), set);
    bool good = hb_set_allocation_successful(set);
    size_t room = good ? hb_set_get_population(set) : 0;
    uint32_t *items = good ? hewn_alloc(room, sizeof *items) : NULL;
    hb_codepoint_t at = HB_SET_VALUE_INVALID;
    while (items && *count < room && hb_set_next(set, &at))
        if (hewn_font_glyph(font, at) != 0)
            items[(*count)++] = at;
    hb_set_destroy(set);
    *out = items;
    return items ? HEWN_OK : no_memory(error);
}

/* --- kerning -------------------------------------------------------------------------------------------------------
 */

/* Pairs under way. */
typedef struct kerner {
    hewn_font *font;
    hb_buffer_t *buffer;
    hb_set_t *glyphs; /* that the font's rules name; empty: it has no rules */
    bool any;         /* rules may be about any glyph */
    hewn_kerning *items;
    size_t count, room;
} kerner;

static void find_glyphs(kerner *own)
{
    hb_face_t *face = hb_font_get_face(own->font->shaper);
    static const hb_tag_t features[] = {HB_TAG('k', 'e', 'r', 'n'), 0};
    hb_set_t *lookups = hb_set_create();
    hb_codepoint_t lookup = HB_SET_VALUE_INVALID;
    hb_ot_layout_collect_lookups(face, HB_OT_TAG_GPOS, NULL, NULL, features, lookups);
    hb_blob_t *table = hb_face_reference_table(face, HB_TAG('k', 'e', 'r', 'n'));
    own->any = hb_set_is_empty(lookups) && hb_blob_get_length(table) > 0;
    hb_blob_destroy(table);
    while (hb_set_next(lookups, &lookup))
        hb_ot_layout_lookup_collect_glyphs(face, HB_OT_TAG_GPOS, lookup, NULL, own->glyphs, NULL, NULL);
    hb_set_destroy(lookups);
}

/* How wide two characters are beside one another; false where they do not stay the two glyphs that they are alone. */
static bool measure(const kerner *own, const uint32_t two[2], bool kerned, double *width)
{
    static const hb_tag_t off[] = {HB_TAG('l', 'i', 'g', 'a'), HB_TAG('c', 'l', 'i', 'g'), HB_TAG('r', 'l', 'i', 'g'),
                                   HB_TAG('c', 'a', 'l', 't'), HB_TAG('k', 'e', 'r', 'n')};
    enum { COUNT = sizeof off / sizeof *off };
    hb_feature_t features[COUNT];
    unsigned count = 0;
    for (unsigned i = 0; i < COUNT; i++)
        features[i] = (hb_feature_t){off[i], 0, 0, (unsigned)-1};
    hb_buffer_clear_contents(own->buffer);
    hb_buffer_add_utf32(own->buffer, two, 2, 0, 2);
    hb_buffer_set_language(own->buffer, hb_language_from_string("und", -1));
    hb_buffer_guess_segment_properties(own->buffer);
    hb_buffer_set_direction(own->buffer, HB_DIRECTION_LTR);
    hb_shape(own->font->shaper, own->buffer, features, kerned ? COUNT - 1 : COUNT);
    const hb_glyph_info_t *glyphs = hb_buffer_get_glyph_infos(own->buffer, &count);
    const hb_glyph_position_t *places = hb_buffer_get_glyph_positions(own->buffer, &count);
    if (count != 2 || glyphs[0].codepoint != hewn_font_glyph(own->font, two[0]) ||
        glyphs[1].codepoint != hewn_font_glyph(own->font, two[1]))
        return false;
    *width = (places[0].x_advance + places[1].x_advance) / own->font->units;
    return true;
}

static hewn_result add_pair(kerner *own, const uint32_t two[2], hewn_error *error)
{
    double kerned, plain, alone = 0;
    for (int i = 0; i < 2; i++)
        alone += hewn_font_advance(own->font, hewn_font_glyph(own->font, two[i]));
    if (!measure(own, two, true, &kerned) || kerned == alone || !measure(own, two, false, &plain) || kerned == plain)
        return HEWN_OK;
    void *items = own->items;
    HEWN_TRY(hewn_reserve(&items, &own->room, own->count + 1, sizeof *own->items, error));
    own->items = items;
    own->items[own->count++] = (hewn_kerning){two[0], two[1], kerned - plain};
    return HEWN_OK;
}

static bool is_named(const kerner *own, uint32_t character)
{
    uint32_t glyph = hewn_font_glyph(own->font, character);
    return glyph != 0 && (own->any || hb_set_has(own->glyphs, glyph));
}

hewn_result hewn_font_kerning(hewn_font *font, const uint32_t *characters, size_t count, const hewn_progress *progress,
                              hewn_kerning **out, size_t *pairs, hewn_error *error)
{
    kerner own = {.font = font, .buffer = hb_buffer_create(), .glyphs = hb_set_create()};
    find_glyphs(&own);
    hewn_result result = HEWN_OK;
    for (size_t i = 0; i < count && result == HEWN_OK; i++) {
        result = hewn_progress_report(progress, "kerning", (double)i / (double)count, error);
        for (size_t k = 0; k < count && result == HEWN_OK && is_named(&own, characters[i]); k++)
            if (is_named(&own, characters[k]))
                result = add_pair(&own, (const uint32_t[2]){characters[i], characters[k]}, error);
    }
    if (result == HEWN_OK && !hb_buffer_allocation_successful(own.buffer))
        result = no_memory(error);
    hb_buffer_destroy(own.buffer);
    hb_set_destroy(own.glyphs);
    if (result != HEWN_OK)
        hewn_free(own.items);
    *out = result == HEWN_OK ? own.items : NULL;
    *pairs = result == HEWN_OK ? own.count : 0;
    return result;
}
