/* Fonts and lines of text: distances against a brute-force look at the outlines, places, and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "font/font.h"

#include FT_OUTLINE_H

static hewn_font *shapes, *serif; /* CFF outlines that are known; a real font of TrueType outlines */

#define SERIF "assets/scenes/fonts/DejaVuSerif-Bold.ttf"

/* A file of the sources. */
static hewn_result open_one(const char *name, uint32_t face, hewn_font **out, hewn_error *error)
{
    char path[4096];
    const char *folder = getenv("HEWN_SOURCE");
    snprintf(path, sizeof path, "%s/%s", folder ? folder : ".", name);
    return hewn_font_open(path, face, out, error);
}

static hewn_field *new_field(void)
{
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    return field;
}

static double value_at(const hewn_field *field, hewn_node node, double x, double y)
{
    double value;
    assert_int_equal(hewn_field_eval(field, node, (const double[3]){x, y, 0}, 1, &value, NULL), HEWN_OK);
    return value;
}

static hewn_node set(hewn_field *field, hewn_font *font, const char *text, const hewn_text_desc *desc)
{
    hewn_error error = {0};
    hewn_node node = hewn_font_text(field, font, text, desc);
    if (hewn_field_status(field, &error) != HEWN_OK)
        fail_msg("'%s': %s", text, error.message);
    return node;
}

static hewn_box box_of(hewn_font *font, const char *text, const hewn_text_desc *desc)
{
    hewn_box box;
    hewn_field *field = new_field();
    hewn_node solid = hewn_extrude(field, set(field, font, text, desc), 1);
    assert_int_equal(hewn_field_find_box(field, solid, &box, NULL), HEWN_OK);
    hewn_field_destroy(&field);
    return box;
}

/* --- known outlines ------------------------------------------------------------------------------------------------
 */

/* The em is 1000 units: sizes of 1000 make units the scene's. Circles are four cubic curves, off by 3 parts in 10,000.
 */
static void known_shapes(void **state)
{
    (void)state;
    const hewn_text_desc desc = {.size = 1000};
    hewn_field *f = new_field();
    hewn_node ring = set(f, shapes, "O", &desc), cross = set(f, shapes, "X", &desc), star = set(f, shapes, "S", &desc);
    for (int i = 0; i < 2000; i++) {
        double x = (i % 50) * 20 + 7.3, y = floor(i / 50.0) * 20 + 3.1, away = hypot(x - 500, y - 400);
        double expected = fmax(away - 400, 200 - away);
        assert_true(fabs(value_at(f, ring, x, y) - expected) < 0.5);
        /* the union of two bars: exact outside, and inside the distance to the union's own border */
        double across[2] = {fabs(x - 500) - 100, fabs(y - 400) - 400},
               along[2] = {fabs(x - 500) - 400, fabs(y - 400) - 100};
        bool in = fmax(across[0], across[1]) < 0 || fmax(along[0], along[1]) < 0;
        double corner = hypot(fabs(x - 500) - 100, fabs(y - 400) - 100), value = value_at(f, cross, x, y);
        assert_true((value < 0) == in);
        if (fabs(x - 500) < 100 && fabs(y - 400) < 100)
            assert_true(fabs(value + corner) < 0.01);
        /* the middle of a star that is drawn in one stroke is wound around twice, and inside */
        if (away < 150)
            assert_true(value_at(f, star, x, y) < 0);
    }
    hewn_field_destroy(&f);
}

/* --- a real font ---------------------------------------------------------------------------------------------------
 */

enum { MOST = 20000 };

/* The outline as points that lie close, by FreeType alone, whatever the code makes of it. */
typedef struct track {
    double points[MOST][2];
    bool begins[MOST];
    size_t count;
} track;

static void note(track *own, double x, double y, bool begins)
{
    assert_true(own->count < MOST);
    own->points[own->count][0] = x;
    own->points[own->count][1] = y;
    own->begins[own->count++] = begins;
}

static int go_to(const FT_Vector *to, void *user)
{
    note(user, (double)to->x, (double)to->y, true);
    return 0;
}

enum { PARTS = 64 };

static int line_to(const FT_Vector *to, void *user)
{
    note(user, (double)to->x, (double)to->y, false);
    return 0;
}

static int conic_to(const FT_Vector *c, const FT_Vector *to, void *user)
{
    track *own = user;
    double ax = own->points[own->count - 1][0], ay = own->points[own->count - 1][1];
    for (int i = 1; i <= PARTS; i++) {
        double t = (double)i / PARTS, s = 1 - t;
        note(own, s * s * ax + 2 * s * t * (double)c->x + t * t * (double)to->x,
             s * s * ay + 2 * s * t * (double)c->y + t * t * (double)to->y, false);
    }
    return 0;
}

static int no_cubic(const FT_Vector *a, const FT_Vector *b, const FT_Vector *to, void *user)
{
    (void)a;
    (void)b;
    (void)to;
    (void)user;
    fail_msg("a TrueType outline has a cubic curve");
    return 1;
}

static size_t ends_at(const track *own, size_t first)
{
    while (first + 1 < own->count && !own->begins[first + 1])
        first++;
    return first;
}

/* Distance and winding number by looking at each piece. */
static double look(const track *own, double x, double y)
{
    double least = INFINITY, turns = 0;
    for (size_t first = 0; first < own->count;) {
        size_t last = ends_at(own, first);
        for (size_t i = first; i <= last; i++) {
            const double *a = own->points[i], *b = own->points[i == last ? first : i + 1];
            double ax = a[0] - x, ay = a[1] - y, bx = b[0] - x, by = b[1] - y, ex = bx - ax, ey = by - ay;
            double length = ex * ex + ey * ey, t = length > 0 ? fmin(fmax(-(ax * ex + ay * ey) / length, 0), 1) : 0;
            least = fmin(least, hypot(ax + t * ex, ay + t * ey));
            turns += atan2(ax * by - ay * bx, ax * bx + ay * by);
        }
        first = last + 1;
    }
    return fabs(turns) > 3 ? -least : least;
}

/* Letters of the font that do not overlap themselves: their distances are those to the whole outline. */
static void distances_of_letters(void **state)
{
    (void)state;
    static track own;
    static const FT_Outline_Funcs calls = {
        .move_to = go_to, .line_to = line_to, .conic_to = conic_to, .cubic_to = no_cubic};
    const char letters[] = "ABGOQSaegims&%8@?";
    const double size = 3, unit = size / serif->units;
    for (const char *at = letters; *at; at++) {
        const char text[2] = {*at, '\0'};
        hewn_field *f = new_field();
        hewn_node node = set(f, serif, text, &(hewn_text_desc){.size = size});
        own.count = 0;
        assert_int_equal(FT_Load_Char(serif->face, (FT_ULong)*at, FT_LOAD_NO_SCALE), 0);
        assert_int_equal(FT_Outline_Decompose(&serif->face->glyph->outline, &calls, &own), 0);
        for (int i = 0; i < 400; i++) {
            double x = -200 + 130 * (i % 20) + 1.37, y = -600 + 130 * floor(i / 20.0) + 2.71; /* font units */
            double expected = look(&own, x, y) * unit, value = value_at(f, node, x * unit, y * unit);
            if (fabs(value - expected) > size / 4000)
                fail_msg("'%c' at %g, %g: %g, not %g", *at, x, y, value, expected);
        }
        hewn_field_destroy(&f);
    }
}

/* --- lines ---------------------------------------------------------------------------------------------------------
 */

static void assert_near(double a, double b, double off)
{
    if (!(fabs(a - b) <= off))
        fail_msg("%g is not %g", a, b);
}

static void kerning_and_spacing(void **state)
{
    (void)state;
    /* "DX" is kerned by -300 in this font: D from 100 to 900, X from 1100 to 1900 without it */
    const double slack = 3;
    hewn_box kerned = box_of(shapes, "DX", &(hewn_text_desc){.size = 1000});
    hewn_box plain = box_of(shapes, "DX", &(hewn_text_desc){.size = 1000, .no_kerning = true});
    hewn_box wide = box_of(shapes, "DX", &(hewn_text_desc){.size = 1000, .spacing = 50});
    assert_near(kerned.hi[0], 1600, slack);
    assert_near(plain.hi[0], 1900, slack);
    assert_near(wide.hi[0], 1650, slack);
    assert_near(kerned.lo[0], 100, slack);
    hewn_box real = box_of(serif, "AV", &(hewn_text_desc){.size = 10});
    hewn_box loose = box_of(serif, "AV", &(hewn_text_desc){.size = 10, .no_kerning = true});
    assert_true(real.hi[0] < loose.hi[0] - 0.3);
}

static void letters_that_overlap(void **state)
{
    (void)state;
    /* two disks of radius 400, 500 apart: inside, the distance is that to the border of both together */
    hewn_field *f = new_field();
    hewn_node both = set(f, shapes, "DD", &(hewn_text_desc){.size = 1000, .spacing = -500});
    double waist = sqrt(400.0 * 400 - 250.0 * 250);
    assert_near(value_at(f, both, 750, 400), -waist, 0.5);
    assert_near(value_at(f, both, 750, 1000), hypot(250, 600) - 400, 0.5);
    hewn_field_destroy(&f);
}

static void lines_and_anchors(void **state)
{
    (void)state;
    const double slack = 3;
    hewn_text_desc desc = {.size = 1000};
    hewn_box box = box_of(shapes, "D\nDD", &desc); /* ascent and descent are 1000 together */
    assert_near(box.lo[1], -1000, slack);
    assert_near(box.hi[1], 800, slack);
    desc.anchor = HEWN_TEXT_TOP;
    assert_near(box_of(shapes, "D\nDD", &desc).hi[1], 0, slack);
    desc.anchor = HEWN_TEXT_BOTTOM;
    assert_near(box_of(shapes, "D\nDD", &desc).lo[1], 0, slack);
    desc.anchor = HEWN_TEXT_MIDDLE;
    desc.line_spacing = 2;
    box = box_of(shapes, "D\nDD", &desc);
    assert_near(box.lo[1], -1400, slack);
    assert_near(box.hi[1], 1400, slack);
    desc.align = HEWN_ALIGN_CENTER;
    box = box_of(shapes, "D\nDD", &desc);
    assert_near(box.lo[0], -900, slack);
    assert_near(box.hi[0], 900, slack);
    desc.align = HEWN_ALIGN_RIGHT;
    box = box_of(shapes, "D\nDD", &desc);
    assert_near(box.lo[0], -1900, slack);
    assert_near(box.hi[0], -100, slack);
}

static void the_same_every_time(void **state)
{
    (void)state;
    hewn_field *f = new_field();
    const hewn_text_desc desc = {.size = 2};
    hewn_node one = set(f, serif, "Same \xC3\x85\n&", &desc), other = set(f, serif, "Same \xC3\x85\n&", &desc);
    assert_int_equal(one.id, other.id);
    hewn_field_destroy(&f);
}

/* --- what is refused -----------------------------------------------------------------------------------------------
 */

static void refused(hewn_font *font, const char *text, hewn_text_desc desc, hewn_result code, const char *part)
{
    hewn_error error = {0};
    hewn_field *f = new_field();
    assert_true(hewn_node_is_none(hewn_font_text(f, font, text, &desc)));
    hewn_result result = hewn_field_status(f, &error);
    if (result != code || !strstr(error.message, part))
        fail_msg("'%.40s' gave %s: %s", text, hewn_result_name(result), error.message);
    hewn_field_destroy(&f);
}

static void bad_texts(void **state)
{
    (void)state;
    const hewn_text_desc good = {.size = 1};
    refused(serif, "", good, HEWN_BAD_INPUT, "nothing to see");
    refused(serif, " \n ", good, HEWN_BAD_INPUT, "nothing to see");
    refused(serif, "ab\xFFz", good, HEWN_BAD_INPUT, "byte 3");
    refused(serif, "a\xC0\xAF", good, HEWN_BAD_INPUT, "byte 2");
    refused(serif, "a\xED\xA0\x80", good, HEWN_BAD_INPUT, "byte 2");
    refused(serif, "a\xF4\x90\x80\x80", good, HEWN_BAD_INPUT, "byte 2");
    refused(serif, "a\xE2\x82", good, HEWN_BAD_INPUT, "byte 2");
    refused(serif, "a\x07z", good, HEWN_BAD_INPUT, "U+0007");
    refused(serif, "a\xE6\xBC\xA2", good, HEWN_BAD_INPUT, "U+6F22");
    refused(serif, "a", (hewn_text_desc){0}, HEWN_INVALID_ARGUMENT, "size");
    refused(serif, "a", (hewn_text_desc){.size = 1, .spacing = NAN}, HEWN_INVALID_ARGUMENT, "spacing");
    refused(NULL, "a", good, HEWN_INVALID_ARGUMENT, "needs");
    static char much[20002];
    memset(much, 'x', sizeof much - 1);
    refused(serif, much, good, HEWN_LIMIT, "characters");
}

static void bad_fonts(void **state)
{
    (void)state;
    hewn_error error = {0};
    hewn_font *font = shapes;
    assert_int_equal(open_one("no_such_font.ttf", 0, &font, &error), HEWN_IO);
    assert_null(font);
    assert_int_equal(open_one("assets/scenes/gear.lua", 0, &font, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.file, "gear.lua"));
    assert_non_null(strstr(error.message, "no font"));
    assert_int_equal(open_one(SERIF, 7, &font, &error), HEWN_BAD_INPUT);
    assert_int_equal(open_one(SERIF, 0x80000000u, &font, &error), HEWN_BAD_INPUT);
    assert_null(font);
    for (size_t length = 0; length < 900; length += 37) /* cut short: an error, or at least no crash */
        if (hewn_font_from_memory(shapes->bytes, length, 0, &font, &error) == HEWN_OK)
            hewn_font_destroy(&font);
    assert_non_null(strstr(hewn_font_name(shapes), "Hewn Shapes"));
}

static int open_fonts(void **state)
{
    (void)state;
    return open_one("tests/fuzz/seeds_font/shapes.otf", 0, &shapes, NULL) == HEWN_OK &&
                   open_one(SERIF, 0, &serif, NULL) == HEWN_OK
               ? 0
               : 1;
}

static int close_fonts(void **state)
{
    (void)state;
    hewn_font_destroy(&shapes);
    hewn_font_destroy(&serif);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_shapes),        cmocka_unit_test(distances_of_letters),
        cmocka_unit_test(kerning_and_spacing), cmocka_unit_test(letters_that_overlap),
        cmocka_unit_test(lines_and_anchors),   cmocka_unit_test(the_same_every_time),
        cmocka_unit_test(bad_texts),           cmocka_unit_test(bad_fonts),
    };
    return cmocka_run_group_tests(tests, open_fonts, close_fonts);
}
