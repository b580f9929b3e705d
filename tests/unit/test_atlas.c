/* Glyph atlases: what a shader makes of them against outlines that FreeType alone tells. */
#include <omp.h>

#include "test_atlas_support.h"
#include "test_data.h"

#define SERIF "assets/scenes/fonts/DejaVuSerif-Bold.ttf"

static track outline;

static hewn_font *open_font(const char *path)
{
    hewn_font *font = NULL;
    assert_int_equal(hewn_font_open(path, 0, &font, NULL), HEWN_OK);
    return font;
}

/* A font of the project. */
static hewn_font *own_font(const char *name)
{
    char path[4096];
    const char *source = getenv("HEWN_SOURCE");
    snprintf(path, sizeof path, "%s/%s", source ? source : ".", name);
    return open_font(path);
}

/* A font of the test data; NULL where that is absent. */
static hewn_font *data_font(const char *name)
{
    char path[8192];
    return data_file(path, name) ? open_font(path) : NULL;
}

static hewn_atlas make(hewn_font *font, const char *letters, hewn_atlas_desc desc)
{
    uint32_t characters[256];
    hewn_atlas atlas;
    hewn_error error = {0};
    for (size_t i = 0; i <= strlen(letters); i++)
        characters[i] = (unsigned char)letters[i];
    desc.characters = characters;
    desc.character_count = strlen(letters);
    if (hewn_atlas_create(font, &desc, &atlas, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return atlas;
}

/* --- the outline comes back ----------------------------------------------------------------------------------------
 */

typedef struct score {
    double worst; /* how deep, in texels, the worst point on the wrong side lies */
    double wrong; /* share of points on the wrong side */
    double off;   /* greatest error of distances away from corners, where the range holds them */
    char letter;
} score;

static score look_at(hewn_font *font, const char *letters, const hewn_atlas *atlas, int points)
{
    score all = {0};
    uint64_t random = 7;
    for (const char *at = letters; *at; at++) {
        const hewn_atlas_glyph *glyph = atlas_glyph(atlas, (unsigned char)*at);
        assert_non_null(glyph);
        assert_true(glyph->seen);
        track_read(&outline, font, (unsigned char)*at);
        for (int i = 0; i < points; i++) {
            double p[2], to_corner;
            for (int axis = 0; axis < 2; axis++)
                p[axis] = glyph->plane[axis] + atlas_share(&random) * (glyph->plane[axis + 2] - glyph->plane[axis]);
            double true_distance = atlas->size * track_distance(&outline, p, &to_corner);
            double shown = atlas_distance(atlas, glyph, p);
            if ((shown >= 0) != (true_distance >= 0) && fabs(true_distance) > 0.03) { /* a texel has 8 bits */
                all.wrong += 1.0 / points;
                all.letter = fabs(true_distance) > all.worst ? *at : all.letter;
                all.worst = fmax(all.worst, fabs(true_distance));
            }
            if (to_corner * atlas->size > 3 && fabs(true_distance) < 0.5 * atlas->range - 1)
                all.off = fmax(all.off, fabs(shown - true_distance));
        }
    }
    all.wrong /= (double)strlen(letters);
    return all;
}

#define LETTERS "AGKMQRSWXaegkmtwz&%8@?"

/* Of a real font: the middle one of three keeps to the outline where the plain distance rounds corners off. */
static void check_font(hewn_font *font, double size, double worst)
{
    score scores[4];
    for (int type = 0; type < 4; type++) {
        hewn_atlas atlas = make(font, LETTERS, (hewn_atlas_desc){.type = (hewn_atlas_type)type, .size = size});
        scores[type] = look_at(font, LETTERS, &atlas, 500);
        hewn_atlas_destroy(&atlas);
    }
    const score *msdf = &scores[HEWN_ATLAS_MSDF], *sdf = &scores[HEWN_ATLAS_SDF];
    if (msdf->worst > worst || msdf->wrong > 0.5 * sdf->wrong)
        fail_msg("%s at %g: '%c' is off by %.3f texels, %.5f of all points are wrong (sdf: %.3f, %.5f)",
                 hewn_font_name(font), size, msdf->letter, msdf->worst, msdf->wrong, sdf->worst, sdf->wrong);
    assert_true(sdf->worst > 0.2 && sdf->worst < 0.6);
    assert_true(msdf->off < 0.5 && sdf->off < 0.5 && scores[HEWN_ATLAS_PSDF].off < 0.5);
    const score *both = &scores[HEWN_ATLAS_MTSDF];
    assert_true(both->worst == msdf->worst && both->wrong == msdf->wrong && both->off == msdf->off);
}

static void the_outline_comes_back(void **state)
{
    (void)state;
    hewn_font *serif = own_font(SERIF);
    check_font(serif, 32, 0.25);
    hewn_font_destroy(&serif);
}

static void other_fonts(void **state)
{
    (void)state;
    hewn_font *sans = data_font("font/DejaVuSans.ttf");
    hewn_font *thin = data_font("font/cmr10.ttf");
    if (sans)
        check_font(sans, 40, 0.12);
    if (thin) /* its hair lines are a 30th of the em */
        check_font(thin, 72, 0.12);
    bool any = sans && thin;
    hewn_font_destroy(&sans);
    hewn_font_destroy(&thin);
    if (!any)
        skip();
}

/* --- thin strokes ---------------------------------------------------------------------------------------------------
 */

/* What is drawn at four times the atlas' resolution and what should be, in texels of the atlas. */
typedef struct drawn_area {
    double wrong, all;
} drawn_area;

static double coverage(double distance) /* of a pixel, a quarter of a texel wide */
{
    return fmin(fmax(4 * distance + 0.5, 0), 1);
}

static drawn_area compare_areas(hewn_font *font, const hewn_atlas *atlas, const hewn_atlas_glyph *glyph)
{
    drawn_area own = {0, 0};
    uint32_t width = 4 * (glyph->width - 1), height = 4 * (glyph->height - 1);
    track_read(&outline, font, glyph->character);
    for (uint32_t i = 0; i < width * height; i++) {
        double to_corner, p[2] = {glyph->plane[0] + (i % width + 0.5) / 4 / atlas->size,
                                  glyph->plane[1] + ((double)(i / width) + 0.5) / 4 / atlas->size};
        double right = coverage(atlas->size * track_distance(&outline, p, &to_corner));
        own.wrong += fabs(coverage(atlas_distance(atlas, glyph, p)) - right) / 16;
        own.all += right / 16;
    }
    return own;
}

/* Of all letters together, and of each. */
static void check_areas(hewn_font *font, double size, double most, double most_of_one)
{
    drawn_area sum = {0, 0};
    hewn_atlas atlas = make(font, LETTERS, (hewn_atlas_desc){.size = size});
    for (size_t i = 0; i < atlas.glyph_count; i++) {
        drawn_area own = compare_areas(font, &atlas, &atlas.glyphs[i]);
        sum.wrong += own.wrong;
        sum.all += own.all;
        if (own.wrong > most_of_one * own.all)
            fail_msg("%s at %g: of '%c' %.4f is wrong", hewn_font_name(font), size, (char)atlas.glyphs[i].character,
                     own.wrong / own.all);
    }
    print_message("# %s at %g: %.4f of the area is wrong\n", hewn_font_name(font), size, sum.wrong / sum.all);
    assert_true(sum.wrong < most * sum.all);
    hewn_atlas_destroy(&atlas);
}

/* With the colours of the first try alone these are 0.154 and 0.055, and of one letter 0.30 and 0.19. */
static void thin_strokes_keep_their_corners(void **state)
{
    (void)state;
    hewn_font *serif = own_font(SERIF);
    hewn_font *thin = data_font("font/cmr10.ttf");
    bool both = thin != NULL;
    check_areas(serif, 12, 0.14, 0.28);
    if (both)
        check_areas(thin, 32, 0.04, 0.08);
    hewn_font_destroy(&serif);
    hewn_font_destroy(&thin);
    if (!both)
        skip();
}

/* A cross of two bars that overlap, a disk, a ring, and a star drawn in one stroke, of cubic curves: what lies within
 * others is no outline. Of the ring, whose only sides are circles, distances are known. */
static void overlaps_are_filled(void **state)
{
    (void)state;
    hewn_font *shapes = own_font("tests/fuzz/seeds_font/shapes.otf");
    hewn_atlas atlas = make(shapes, "XOSD", (hewn_atlas_desc){.type = HEWN_ATLAS_MTSDF, .size = 48, .range = 8});
    score own = look_at(shapes, "XOSD", &atlas, 3000);
    assert_true(own.worst < 0.05);
    const hewn_atlas_glyph *ring = atlas_glyph(&atlas, 'O'), *cross = atlas_glyph(&atlas, 'X');
    uint64_t random = 3;
    for (int i = 0; i < 3000; i++) {
        double p[2], q[2];
        for (int axis = 0; axis < 2; axis++) {
            p[axis] = ring->plane[axis] + atlas_share(&random) * (ring->plane[axis + 2] - ring->plane[axis]);
            q[axis] = cross->plane[axis] + atlas_share(&random) * (cross->plane[axis + 2] - cross->plane[axis]);
        }
        double away = hypot(p[0] - 0.5, p[1] - 0.4), expected = 48 * fmin(0.4 - away, away - 0.2);
        if (fabs(expected) < 3)
            assert_true(fabs(atlas_distance(&atlas, ring, p) - expected) < 0.06);
        /* in the middle of the cross only the four notches are near: the plain distance is that to the nearest */
        double notch = 48 * hypot(fabs(q[0] - 0.5) - 0.1, fabs(q[1] - 0.4) - 0.1);
        if (fabs(q[0] - 0.5) < 0.1 && fabs(q[1] - 0.4) < 0.1 && notch < 3)
            assert_true(fabs((atlas_channel(&atlas, cross, 3, q) - 0.5) * 8 - notch) < 0.3);
    }
    hewn_atlas_destroy(&atlas);
    hewn_font_destroy(&shapes);
}

/* --- places --------------------------------------------------------------------------------------------------------
 */

static void check_places(const hewn_atlas *atlas)
{
    for (size_t i = 0; i < atlas->glyph_count; i++) {
        const hewn_atlas_glyph *one = &atlas->glyphs[i];
        assert_true(i == 0 || one->character > one[-1].character);
        if (!one->seen)
            continue;
        assert_true(one->x + one->width <= atlas->width && one->y + one->height <= atlas->height);
        for (int axis = 0; axis < 2; axis++) {
            double texels = (one->plane[axis + 2] - one->plane[axis]) * atlas->size;
            assert_true(fabs(texels - ((axis ? one->height : one->width) - 1)) < 1e-9);
        }
        for (size_t k = 0; k < i; k++) {
            const hewn_atlas_glyph *other = &atlas->glyphs[k];
            bool shared = other->x == one->x && other->y == one->y && other->width == one->width;
            bool apart = other->x + other->width < one->x || one->x + one->width < other->x ||
                         other->y + other->height < one->y || one->y + one->height < other->y;
            assert_true(!other->seen || shared || apart);
        }
    }
}

/* Repeats, any number of them, change nothing. */
static void repeats(void **state)
{
    (void)state;
    enum { MANY = 100000 };
    static uint32_t characters[MANY];
    hewn_font *serif = own_font(SERIF);
    for (uint32_t i = 0; i < MANY; i++)
        characters[i] = i % 7 == 3 ? 0x4E00 : 'g' - i % 7;
    hewn_atlas_desc desc = {.characters = characters, .character_count = 7, .size = 12};
    hewn_atlas atlases[2];
    for (int k = 0; k < 2; k++) {
        assert_int_equal(hewn_atlas_create(serif, &desc, &atlases[k], NULL), HEWN_OK);
        assert_true(atlases[k].glyph_count == 6 && atlases[k].missing_count == 1);
        assert_true(atlases[k].glyphs[0].character == 'a' && atlases[k].glyphs[5].character == 'g');
        desc.character_count = MANY;
    }
    assert_int_equal(atlases[0].width, atlases[1].width);
    assert_memory_equal(atlases[0].texels, atlases[1].texels,
                        (size_t)atlases[0].width * atlases[0].height * atlases[0].channels);
    hewn_atlas_destroy(&atlases[0]);
    hewn_atlas_destroy(&atlases[1]);
    hewn_font_destroy(&serif);
}

static void places(void **state)
{
    (void)state;
    hewn_font *serif = own_font(SERIF);
    uint32_t characters[700];
    for (uint32_t i = 0; i < 700; i++)
        characters[i] = 0x20 + (i * 387) % 700; /* in no order; some are not in the font, some have the same glyph */
    hewn_atlas_desc desc = {.characters = characters, .character_count = 700, .size = 12, .no_kerning = true};
    hewn_atlas atlas;
    assert_int_equal(hewn_atlas_create(serif, &desc, &atlas, NULL), HEWN_OK);
    check_places(&atlas);
    assert_int_equal(atlas.glyph_count + atlas.missing_count, 700);
    assert_true(atlas.missing_count > 0 && atlas.glyph_count > 150 && atlas.width == atlas.height);
    for (size_t i = 0; i < atlas.missing_count; i++) {
        assert_int_equal(hewn_font_glyph(serif, atlas.missing[i]), 0);
        assert_null(atlas_glyph(&atlas, atlas.missing[i]));
    }
    assert_false(atlas_glyph(&atlas, ' ')->seen);
    assert_int_equal(atlas.width % 4, 0);
    uint32_t side = atlas.width;
    hewn_atlas_destroy(&atlas);
    desc.power_of_two = true;
    assert_int_equal(hewn_atlas_create(serif, &desc, &atlas, NULL), HEWN_OK);
    assert_int_equal(atlas.width & (atlas.width - 1), 0);
    assert_true(atlas.width >= side && atlas.width < 2 * side);
    check_places(&atlas);
    hewn_atlas_destroy(&atlas);
    desc.width = side / 2;
    desc.height = 3 * side;
    assert_int_equal(hewn_atlas_create(serif, &desc, &atlas, NULL), HEWN_OK);
    check_places(&atlas);
    assert_true(atlas.width == side / 2 && atlas.height == 3 * side);
    hewn_atlas_destroy(&atlas);
    hewn_font_destroy(&serif);
}

static void the_same_for_any_threads(void **state)
{
    (void)state;
    hewn_font *serif = own_font(SERIF);
    hewn_atlas atlases[2];
    int before = omp_get_max_threads();
    for (int i = 0; i < 2; i++) {
        omp_set_num_threads(i == 0 ? 1 : 5);
        atlases[i] = make(serif, LETTERS, (hewn_atlas_desc){.size = 20});
    }
    omp_set_num_threads(before);
    assert_int_equal(atlases[0].width, atlases[1].width);
    assert_int_equal(atlases[0].softened, atlases[1].softened);
    assert_memory_equal(atlases[0].texels, atlases[1].texels, (size_t)3 * atlases[0].width * atlases[0].height);
    for (int i = 0; i < 2; i++)
        hewn_atlas_destroy(&atlases[i]);
    hewn_font_destroy(&serif);
}

/* --- what the font says --------------------------------------------------------------------------------------------
 */

static double kerning_of(const hewn_atlas *atlas, uint32_t first, uint32_t second)
{
    for (size_t i = 0; i < atlas->kerning_count; i++)
        if (atlas->kerning[i].first == first && atlas->kerning[i].second == second)
            return atlas->kerning[i].advance;
    return 0;
}

static void metrics_and_kerning(void **state)
{
    (void)state;
    hewn_font *shapes = own_font("tests/fuzz/seeds_font/shapes.otf");
    hewn_font *serif = own_font(SERIF);
    hewn_atlas atlas = make(shapes, "DXOS", (hewn_atlas_desc){.size = 16});
    assert_int_equal(atlas.kerning_count, 1);
    assert_true(fabs(kerning_of(&atlas, 'D', 'X') + 0.3) < 1e-12);
    assert_true(fabs(atlas.metrics.line_height - 1) < 1e-12);
    assert_true(fabs(atlas_glyph(&atlas, 'D')->advance - 1) < 1e-12);
    hewn_atlas_destroy(&atlas);
    atlas = make(serif, "AVTo.fi\"", (hewn_atlas_desc){.size = 16});
    assert_true(kerning_of(&atlas, 'A', 'V') < -0.03 && kerning_of(&atlas, 'T', 'o') < -0.03);
    assert_true(kerning_of(&atlas, 'f', 'i') == 0); /* a ligature is not a pair */
    assert_true(atlas.metrics.ascender > 0.7 && atlas.metrics.descender < -0.1 && atlas.metrics.underline_y < 0);
    for (size_t i = 1; i < atlas.kerning_count; i++) {
        const hewn_kerning *p = &atlas.kerning[i - 1], *q = &atlas.kerning[i];
        assert_true(p->first < q->first || (p->first == q->first && p->second < q->second));
    }
    hewn_atlas_destroy(&atlas);
    atlas = make(serif, "AV", (hewn_atlas_desc){.size = 16, .no_kerning = true});
    assert_int_equal(atlas.kerning_count, 0);
    hewn_atlas_destroy(&atlas);
    hewn_font_destroy(&serif);
    hewn_font_destroy(&shapes);
}

/* --- what is refused -----------------------------------------------------------------------------------------------
 */

static void refused(hewn_font *font, hewn_atlas_desc desc, hewn_result code, const char *part)
{
    static const uint32_t letters[] = {'A', 'B', 'C'};
    hewn_atlas atlas;
    hewn_error error = {0};
    if (!desc.characters) {
        desc.characters = letters;
        desc.character_count = 3;
    }
    hewn_result result = hewn_atlas_create(font, &desc, &atlas, &error);
    if (result != code || !strstr(error.message, part))
        fail_msg("%s: %s", hewn_result_name(result), error.message);
    assert_null(atlas.texels);
    assert_null(atlas.glyphs);
}

static bool stop_at_atlas(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)fraction;
    return strcmp(stage, "atlas") != 0;
}

static void refusals(void **state)
{
    (void)state;
    hewn_font *serif = own_font(SERIF);
    const uint32_t foreign[] = {0x4E00, 0x6F22}, beyond[] = {'a', 0x110000};
    const hewn_progress stop = {stop_at_atlas, NULL};
    refused(serif, (hewn_atlas_desc){.size = -1}, HEWN_INVALID_ARGUMENT, "em");
    refused(serif, (hewn_atlas_desc){.size = NAN}, HEWN_INVALID_ARGUMENT, "em");
    refused(serif, (hewn_atlas_desc){.range = INFINITY}, HEWN_INVALID_ARGUMENT, "range");
    refused(serif, (hewn_atlas_desc){.corner = 180}, HEWN_INVALID_ARGUMENT, "corner");
    refused(serif, (hewn_atlas_desc){.width = 10}, HEWN_INVALID_ARGUMENT, "image");
    refused(serif, (hewn_atlas_desc){.width = 20, .height = 20}, HEWN_LIMIT, "do not fit");
    refused(serif, (hewn_atlas_desc){.characters = foreign, .character_count = 2}, HEWN_BAD_INPUT, "none of the 2");
    refused(serif, (hewn_atlas_desc){.characters = beyond, .character_count = 2}, HEWN_INVALID_ARGUMENT, "character 1");
    refused(serif, (hewn_atlas_desc){.type = (hewn_atlas_type)4}, HEWN_INVALID_ARGUMENT, "type");
    refused(serif, (hewn_atlas_desc){.type = (hewn_atlas_type)-1}, HEWN_INVALID_ARGUMENT, "type");
    assert_string_equal(hewn_atlas_type_name((hewn_atlas_type)4), "unknown");
    assert_string_equal(hewn_atlas_type_name(HEWN_ATLAS_MTSDF), "mtsdf");
    refused(serif, (hewn_atlas_desc){.progress = &stop}, HEWN_CANCELLED, "cancelled");
    refused(NULL, (hewn_atlas_desc){.size = 8}, HEWN_INVALID_ARGUMENT, "needs");
    hewn_font_destroy(&serif);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_outline_comes_back),
        cmocka_unit_test(other_fonts),
        cmocka_unit_test(thin_strokes_keep_their_corners),
        cmocka_unit_test(overlaps_are_filled),
        cmocka_unit_test(places),
        cmocka_unit_test(repeats),
        cmocka_unit_test(the_same_for_any_threads),
        cmocka_unit_test(metrics_and_kerning),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
