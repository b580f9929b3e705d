/* Any bytes as a font, and a text set in it: a field that can be evaluated, or an error. */
#include <math.h>
#include <stdlib.h>

#include "hewn/font.h"

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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    hewn_font *font;
    hewn_error error = {0};
    hewn_result result = hewn_font_from_memory(data, size, 0, &font, &error);
    if (result == HEWN_OK) {
        (void)hewn_font_name(font);
        set(font);
        hewn_font_destroy(&font);
    } else if (font || error.code != result || error.message[0] == '\0' ||
               (result != HEWN_BAD_INPUT && result != HEWN_OUT_OF_MEMORY)) {
        abort();
    }
    return 0;
}
