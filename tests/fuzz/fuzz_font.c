/* Any bytes as a font: a text set in it is a field that can be evaluated, or an error; so is an atlas of some letters.
 */
#include <math.h>
#include <stdlib.h>

#include "hewn/atlas.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void set(hewn_font *font)
{
    static const char *const texts[] = {"OXSD", "AVfi8\xC3\xA9\nA"};
    for (int i = 0; i < 2; i++) {
        hewn_field *field = NULL;
        hewn_error error = {0};
        const hewn_text_desc desc = {.size = 2, .align = HEWN_ALIGN_CENTER, .anchor = HEWN_TEXT_MIDDLE, .spacing = -1};
        if (hewn_field_create(&field, NULL) != HEWN_OK)
            return;
        hewn_node node = hewn_font_text(field, font, texts[i], &desc);
        hewn_result result = hewn_field_status(field, &error);
        const double points[6] = {0, 0.5, 0, 1.5, -0.25, 0};
        double values[2];
        if (hewn_node_is_none(node)) {
            if (result == HEWN_OK || error.message[0] == '\0')
                abort();
        } else if (hewn_field_eval(field, node, points, 2, values, NULL) != HEWN_OK || !isfinite(values[0])) {
            abort();
        }
        hewn_field_destroy(&field);
    }
}

static void draw(hewn_font *font)
{
    static const uint32_t letters[] = {'O', 'X', 'A', '8'};
    const hewn_atlas_desc desc = {.characters = letters, .character_count = 4, .size = 5, .range = 2};
    hewn_atlas atlas;
    hewn_error error = {0};
    hewn_result result = hewn_atlas_create(font, &desc, &atlas, &error);
    if (result != HEWN_OK && (atlas.texels || error.message[0] == '\0'))
        abort();
    if (result == HEWN_OK && (!atlas.texels || atlas.glyph_count + atlas.missing_count != 4))
        abort();
    hewn_atlas_destroy(&atlas);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    hewn_font *font;
    hewn_error error = {0};
    hewn_result result = hewn_font_from_memory(data, size, 0, &font, &error);
    if (result == HEWN_OK) {
        (void)hewn_font_name(font);
        set(font);
        draw(font);
        hewn_font_destroy(&font);
    } else if (font || error.code != result || error.message[0] == '\0' ||
               (result != HEWN_BAD_INPUT && result != HEWN_OUT_OF_MEMORY)) {
        abort();
    }
    return 0;
}
