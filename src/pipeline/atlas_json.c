#include "pipeline/atlas_json.h"

#include "base/json.h"

static void write_bounds(hewn_json *json, const char *key, double left, double bottom, double right, double top)
{
    hewn_json_object(json, key);
    hewn_json_number(json, "left", left);
    hewn_json_number(json, "bottom", bottom);
    hewn_json_number(json, "right", right);
    hewn_json_number(json, "top", top);
    hewn_json_end_object(json);
}

/* The rectangle between the middles of the outermost texels: what is drawn of it never mixes with its neighbours. */
static void write_glyph(hewn_json *json, const hewn_atlas *atlas, const hewn_atlas_glyph *glyph, bool y_down)
{
    double left = glyph->x + 0.5, right = glyph->x + glyph->width - 0.5;
    double top = glyph->y + 0.5, bottom = glyph->y + glyph->height - 0.5, sign = y_down ? -1 : 1;
    hewn_json_object(json, NULL);
    hewn_json_unsigned(json, "unicode", glyph->character);
    hewn_json_number(json, "advance", glyph->advance);
    if (glyph->seen) {
        write_bounds(json, "planeBounds", glyph->plane[0], sign * glyph->plane[1], glyph->plane[2],
                     sign * glyph->plane[3]);
        write_bounds(json, "atlasBounds", left, y_down ? bottom : atlas->height - bottom, right,
                     y_down ? top : atlas->height - top);
    }
    hewn_json_end_object(json);
}

static void write_image(hewn_json *json, const hewn_atlas *atlas, bool y_down)
{
    hewn_json_object(json, "atlas");
    hewn_json_string(json, "type", hewn_atlas_type_name(atlas->type));
    hewn_json_number(json, "distanceRange", atlas->range);
    hewn_json_number(json, "distanceRangeMiddle", 0);
    hewn_json_number(json, "size", atlas->size);
    hewn_json_unsigned(json, "width", atlas->width);
    hewn_json_unsigned(json, "height", atlas->height);
    hewn_json_string(json, "yOrigin", y_down ? "top" : "bottom");
    hewn_json_end_object(json);
}

static void write_metrics(hewn_json *json, const hewn_font_metrics *metrics, bool y_down)
{
    double sign = y_down ? -1 : 1;
    hewn_json_object(json, "metrics");
    hewn_json_number(json, "emSize", 1);
    hewn_json_number(json, "lineHeight", metrics->line_height);
    hewn_json_number(json, "ascender", sign * metrics->ascender);
    hewn_json_number(json, "descender", sign * metrics->descender);
    hewn_json_number(json, "underlineY", sign * metrics->underline_y);
    hewn_json_number(json, "underlineThickness", metrics->underline_thickness);
    hewn_json_end_object(json);
}

void hewn_atlas_write_json(const hewn_atlas *atlas, bool y_down, hewn_text *text)
{
    hewn_json json = hewn_json_begin(text);
    hewn_json_object(&json, NULL);
    write_image(&json, atlas, y_down);
    write_metrics(&json, &atlas->metrics, y_down);
    hewn_json_array(&json, "glyphs");
    for (size_t i = 0; i < atlas->glyph_count; i++)
        write_glyph(&json, atlas, &atlas->glyphs[i], y_down);
    hewn_json_end_array(&json);
    hewn_json_array(&json, "kerning");
    for (size_t i = 0; i < atlas->kerning_count; i++) {
        hewn_json_object(&json, NULL);
        hewn_json_unsigned(&json, "unicode1", atlas->kerning[i].first);
        hewn_json_unsigned(&json, "unicode2", atlas->kerning[i].second);
        hewn_json_number(&json, "advance", atlas->kerning[i].advance);
        hewn_json_end_object(&json);
    }
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    hewn_text_append(text, "\n");
}
