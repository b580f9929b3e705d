#include "hewn/atlas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "atlas/charset.h"
#include "atlas/colours.h"
#include "atlas/glyph.h"
#include "atlas/pack.h"
#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

enum { MOST_SIDE = 16384, GAP = 1, BLOCK = 64 };

static const char *const names[] = {"msdf", "sdf", "psdf", "mtsdf"};
enum { TYPES = sizeof names / sizeof *names };

bool hewn_atlas_type_named(const char *name, hewn_atlas_type *out)
{
    for (unsigned i = 0; i < TYPES; i++)
        if (strcmp(name, names[i]) == 0) {
            *out = (hewn_atlas_type)i;
            return true;
        }
    return false;
}

const char *hewn_atlas_type_name(hewn_atlas_type type)
{
    return (unsigned)type < TYPES ? names[type] : "unknown";
}

void hewn_atlas_destroy(hewn_atlas *atlas)
{
    hewn_free(atlas->texels);
    hewn_free(atlas->glyphs);
    hewn_free(atlas->missing);
    hewn_free(atlas->kerning);
    *atlas = (hewn_atlas){0};
}

/* A glyph that has an outline: its letter's picture. */
typedef struct drawing {
    uint32_t glyph, character;
    hewn_glyph_outline outline;
    double move[2]; /* of the outline in texels, to the lower left corner of its rectangle */
    size_t softened;
    hewn_result result;
    hewn_error error;
} drawing;

/* An atlas under way. */
typedef struct making {
    hewn_font *font;
    const hewn_atlas_desc *desc;
    hewn_atlas *atlas;
    uint32_t *glyphs; /* of each of the atlas' glyphs */
    double scale;     /* texels to a unit of the font */
    drawing *drawings;
    hewn_packed *packed; /* of each drawing */
    size_t count;
} making;

/* --- characters ----------------------------------------------------------------------------------------------------
 */

static hewn_result no_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an atlas");
}

/* The characters without repeats, rising. */
static hewn_result sort_characters(const hewn_atlas_desc *desc, uint32_t **out, size_t *count, hewn_error *error)
{
    hewn_charset set = {0};
    hewn_result result = HEWN_OK;
    *out = NULL;
    for (size_t i = 0; i < desc->character_count && result == HEWN_OK; i++)
        result = hewn_charset_add(&set, desc->characters[i], desc->characters[i], error);
    if (result == HEWN_OK)
        result = hewn_charset_list(&set, out, error);
    *count = set.count;
    hewn_charset_clear(&set);
    return result;
}

static hewn_result find_glyphs(making *own, hewn_error *error)
{
    hewn_atlas *atlas = own->atlas;
    size_t count;
    uint32_t *sorted;
    HEWN_TRY(sort_characters(own->desc, &sorted, &count, error));
    atlas->glyphs = hewn_alloc_zero(count, sizeof *atlas->glyphs);
    atlas->missing = hewn_alloc(count, sizeof *atlas->missing);
    own->glyphs = hewn_alloc(count, sizeof *own->glyphs);
    bool there = atlas->glyphs && atlas->missing && own->glyphs;
    for (size_t i = 0; there && i < count; i++) {
        uint32_t glyph = hewn_font_glyph(own->font, sorted[i]);
        if (glyph == 0) {
            atlas->missing[atlas->missing_count++] = sorted[i];
            continue;
        }
        own->glyphs[atlas->glyph_count] = glyph;
        atlas->glyphs[atlas->glyph_count++] =
            (hewn_atlas_glyph){.character = sorted[i], .advance = hewn_font_advance(own->font, glyph)};
    }
    hewn_free(sorted);
    if (!there)
        return no_memory(error);
    if (atlas->glyph_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "the font has none of the %zu characters that were asked for", count);
    return HEWN_OK;
}

/* --- outlines ------------------------------------------------------------------------------------------------------
 */

static int by_glyph(const void *left, const void *right)
{
    const drawing *p = left, *q = right;
    if (p->glyph != q->glyph)
        return p->glyph < q->glyph ? -1 : 1;
    return (p->character > q->character) - (p->character < q->character);
}

static hewn_result blame_letter(const drawing *own, hewn_error *error)
{
    return hewn_fail(error, own->result, "U+%04X: %s", own->character, own->error.message);
}

/* A drawing a glyph, the first character that it stands for beside it. */
static hewn_result list_drawings(making *own, hewn_error *error)
{
    own->drawings = hewn_alloc_zero(own->atlas->glyph_count, sizeof *own->drawings);
    own->packed = hewn_alloc_zero(own->atlas->glyph_count, sizeof *own->packed);
    if (!own->drawings || !own->packed)
        return no_memory(error);
    for (size_t i = 0; i < own->atlas->glyph_count; i++)
        own->drawings[i] = (drawing){.glyph = own->glyphs[i], .character = own->atlas->glyphs[i].character};
    qsort(own->drawings, own->atlas->glyph_count, sizeof *own->drawings, by_glyph);
    for (size_t i = 0; i < own->atlas->glyph_count; i++)
        if (own->count == 0 || own->drawings[i].glyph != own->drawings[own->count - 1].glyph)
            own->drawings[own->count++] = own->drawings[i];
    return HEWN_OK;
}

/* FreeType reads for one thread at a time; what is left of overlaps is found by all. */
static hewn_result read_outlines(making *own, hewn_error *error)
{
    double grid = own->font->grid, units = own->font->units;
    for (size_t first = 0; first < own->count; first += BLOCK) {
        size_t end = first + BLOCK < own->count ? first + BLOCK : own->count;
        HEWN_TRY(hewn_progress_report(own->desc->progress, "atlas", 0.3 * (double)first / (double)own->count, error));
        for (size_t i = first; i < end; i++) {
            drawing *at = &own->drawings[i];
            at->result = hewn_glyph_outline_read(own->font, at->glyph, &at->outline, &at->error);
            if (at->result != HEWN_OK)
                return blame_letter(at, error);
        }
#pragma omp parallel for schedule(dynamic)
        for (size_t i = first; i < end; i++)
            own->drawings[i].result =
                hewn_glyph_outline_resolve(&own->drawings[i].outline, grid, units, &own->drawings[i].error);
        for (size_t i = first; i < end; i++)
            if (own->drawings[i].result != HEWN_OK)
                return blame_letter(&own->drawings[i], error);
    }
    return HEWN_OK;
}

/* --- places --------------------------------------------------------------------------------------------------------
 */

/* The rectangle of a letter: its outline with half the range around, and as much as rounds that to texels. */
static hewn_result measure(making *own, size_t i, hewn_error *error)
{
    drawing *at = &own->drawings[i];
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    uint32_t sides[2];
    for (size_t k = 0; k < at->outline.count; k++)
        hewn_bezier_bound(&at->outline.curves[k], lo, hi);
    for (int axis = 0; axis < 2; axis++) {
        double length = own->scale * (hi[axis] - lo[axis]) + own->atlas->range;
        if (!(length < MOST_SIDE - 1))
            return hewn_fail(error, HEWN_LIMIT, "U+%04X: it would be %.0f texels large; %d are the most", at->character,
                             length, (int)MOST_SIDE);
        sides[axis] = (uint32_t)ceil(length) + 1;
        at->move[axis] = 0.5 * (sides[axis] - own->scale * (lo[axis] + hi[axis]));
    }
    own->packed[i] = (hewn_packed){.width = sides[0], .height = sides[1]};
    return HEWN_OK;
}

static hewn_result place(making *own, hewn_error *error)
{
    const hewn_atlas_desc *desc = own->desc;
    hewn_atlas *atlas = own->atlas;
    size_t seen = 0;
    for (size_t i = 0; i < own->count; i++) { /* those without an outline need no place */
        if (own->drawings[i].outline.count == 0) {
            hewn_glyph_outline_clear(&own->drawings[i].outline);
            continue;
        }
        drawing kept = own->drawings[i];
        own->drawings[i].outline = (hewn_glyph_outline){0};
        own->drawings[seen++] = kept;
    }
    own->count = seen;
    for (size_t i = 0; i < seen; i++)
        HEWN_TRY(measure(own, i, error));
    if (desc->width == 0) {
        HEWN_TRY(hewn_pack_square(own->packed, seen, GAP, desc->power_of_two, MOST_SIDE, &atlas->width, error));
        atlas->height = atlas->width;
        return HEWN_OK;
    }
    bool fit;
    atlas->width = desc->width;
    atlas->height = desc->height;
    HEWN_TRY(hewn_pack(own->packed, seen, GAP, desc->width, desc->height, &fit, error));
    return fit ? HEWN_OK
               : hewn_fail(error, HEWN_LIMIT, "the letters do not fit into an image of %u x %u texels", desc->width,
                           desc->height);
}

static int by_drawn_glyph(const void *key, const void *item)
{
    const uint32_t *glyph = key;
    const drawing *own = item;
    return (*glyph > own->glyph) - (*glyph < own->glyph);
}

static void tell_places(making *own)
{
    for (size_t i = 0; i < own->atlas->glyph_count; i++) {
        hewn_atlas_glyph *glyph = &own->atlas->glyphs[i];
        const drawing *drawn =
            bsearch(&own->glyphs[i], own->drawings, own->count, sizeof *own->drawings, by_drawn_glyph);
        if (!drawn)
            continue;
        const hewn_packed *packed = &own->packed[drawn - own->drawings];
        glyph->seen = true;
        glyph->x = packed->x;
        glyph->y = packed->y;
        glyph->width = packed->width;
        glyph->height = packed->height;
        const double sides[2] = {packed->width, packed->height};
        for (int axis = 0; axis < 2; axis++) {
            glyph->plane[axis] = (0.5 - drawn->move[axis]) / own->atlas->size;
            glyph->plane[axis + 2] = (sides[axis] - 0.5 - drawn->move[axis]) / own->atlas->size;
        }
    }
}

/* --- texels --------------------------------------------------------------------------------------------------------
 */

static void draw(const making *own, size_t i)
{
    const hewn_atlas *atlas = own->atlas;
    const hewn_packed *packed = &own->packed[i];
    drawing *at = &own->drawings[i];
    double corner = own->desc->corner > 0 ? own->desc->corner : 8;
    hewn_shape shape;
    at->result = hewn_shape_create(&at->outline, own->scale, at->move, corner * M_PI / 180, &shape, &at->error);
    if (at->result != HEWN_OK)
        return;
    size_t stride = (size_t)atlas->width * atlas->channels;
    const hewn_texels texels = {.width = packed->width,
                                .height = packed->height,
                                .channels = atlas->channels,
                                .first = atlas->texels + packed->y * stride + (size_t)packed->x * atlas->channels,
                                .stride = stride};
    at->result = hewn_glyph_draw(&shape, atlas->type, atlas->range, &texels, &at->softened, &at->error);
    hewn_shape_clear(&shape);
}

static hewn_result draw_all(making *own, hewn_error *error)
{
    hewn_atlas *atlas = own->atlas;
    atlas->texels = hewn_alloc_zero((size_t)atlas->width * atlas->height, atlas->channels);
    if (!atlas->texels)
        return no_memory(error);
    for (size_t first = 0; first < own->count; first += BLOCK) {
        size_t end = first + BLOCK < own->count ? first + BLOCK : own->count;
        HEWN_TRY(
            hewn_progress_report(own->desc->progress, "atlas", 0.3 + 0.7 * (double)first / (double)own->count, error));
#pragma omp parallel for schedule(dynamic)
        for (size_t i = first; i < end; i++)
            draw(own, i);
        for (size_t i = first; i < end; i++) {
            if (own->drawings[i].result != HEWN_OK)
                return blame_letter(&own->drawings[i], error);
            atlas->softened += own->drawings[i].softened;
        }
    }
    return HEWN_OK;
}

/* --- the whole -----------------------------------------------------------------------------------------------------
 */

static hewn_result check(const hewn_font *font, const hewn_atlas_desc *desc, hewn_error *error)
{
    if (!font || !desc || desc->character_count == 0 || !desc->characters)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an atlas needs a font and characters");
    for (size_t i = 0; i < desc->character_count; i++)
        if (desc->characters[i] > HEWN_CHARACTER_MOST)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "character %zu, U+%X, is beyond U+10FFFF", i,
                             desc->characters[i]);
    if ((unsigned)desc->type >= TYPES)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no type of atlas %u", (unsigned)desc->type);
    if (!(desc->size >= 0) || (desc->size > 0 && desc->size < 1) || desc->size > 4096)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the em is 1 to 4096 texels, not %g", desc->size);
    if (!(desc->range >= 0) || (desc->range > 0 && desc->range < 0.1) || desc->range > 1024)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the range is 0.1 to 1024 texels, not %g", desc->range);
    if (!(desc->corner >= 0) || !(desc->corner < 180))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a corner turns by 0 to 180 degrees, not %g", desc->corner);
    if ((desc->width == 0) != (desc->height == 0) || desc->width > MOST_SIDE || desc->height > MOST_SIDE)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an image has 1 to %d texels a side, not %u x %u",
                         (int)MOST_SIDE, desc->width, desc->height);
    return HEWN_OK;
}

static hewn_result find_kerning(making *own, hewn_error *error)
{
    hewn_atlas *atlas = own->atlas;
    uint32_t *characters = hewn_alloc(atlas->glyph_count, sizeof *characters);
    if (!characters)
        return no_memory(error);
    for (size_t i = 0; i < atlas->glyph_count; i++)
        characters[i] = atlas->glyphs[i].character;
    hewn_result result = hewn_font_kerning(own->font, characters, atlas->glyph_count, own->desc->progress,
                                           &atlas->kerning, &atlas->kerning_count, error);
    hewn_free(characters);
    return result;
}

static hewn_result make(making *own, hewn_error *error)
{
    HEWN_TRY(find_glyphs(own, error));
    if (!own->desc->no_kerning)
        HEWN_TRY(find_kerning(own, error));
    HEWN_TRY(list_drawings(own, error));
    HEWN_TRY(read_outlines(own, error));
    HEWN_TRY(place(own, error));
    tell_places(own);
    return draw_all(own, error);
}

hewn_result hewn_atlas_create(hewn_font *font, const hewn_atlas_desc *desc, hewn_atlas *out, hewn_error *error)
{
    *out = (hewn_atlas){0};
    HEWN_TRY(check(font, desc, error));
    out->type = desc->type;
    out->size = desc->size > 0 ? desc->size : 32;
    out->range = desc->range > 0 ? desc->range : 4;
    out->channels = desc->type == HEWN_ATLAS_MSDF ? 3 : desc->type == HEWN_ATLAS_MTSDF ? 4 : 1;
    hewn_font_measure(font, &out->metrics);
    making own = {.font = font, .desc = desc, .atlas = out, .scale = out->size / font->units};
    hewn_result result = make(&own, error);
    for (size_t i = 0; own.drawings && i < own.count; i++)
        hewn_glyph_outline_clear(&own.drawings[i].outline);
    hewn_free(own.drawings);
    hewn_free(own.packed);
    hewn_free(own.glyphs);
    if (result != HEWN_OK)
        hewn_atlas_destroy(out);
    return result;
}
