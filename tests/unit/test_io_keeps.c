/* hewn_mesh_format_keeps() against the files themselves: a channel is kept where it can be read back. */
#include <unistd.h>

#include "hewn/io.h"
#include "test_model_support.h"

typedef struct candidate {
    const char *name;
    hewn_domain domain;
    hewn_scalar scalar;
    uint32_t components;
} candidate;

#define EVERYWHERE(name, scalar, components)                                                                           \
    {name, HEWN_DOMAIN_VERT, scalar, components}, {name, HEWN_DOMAIN_CORNER, scalar, components},                      \
    {                                                                                                                  \
        name, HEWN_DOMAIN_FACE, scalar, components                                                                     \
    }

static const candidate candidates[] = {
    EVERYWHERE("normal", HEWN_SCALAR_FLOAT, 3),    EVERYWHERE("normal", HEWN_SCALAR_DOUBLE, 3),
    EVERYWHERE("uv", HEWN_SCALAR_FLOAT, 2),        EVERYWHERE("uv", HEWN_SCALAR_DOUBLE, 2),
    EVERYWHERE("uv", HEWN_SCALAR_FLOAT, 3),        EVERYWHERE("color", HEWN_SCALAR_UINT8, 3),
    EVERYWHERE("color", HEWN_SCALAR_UINT8, 4),     EVERYWHERE("color", HEWN_SCALAR_FLOAT, 3),
    EVERYWHERE("color", HEWN_SCALAR_FLOAT, 4),     EVERYWHERE("mass", HEWN_SCALAR_FLOAT, 1),
    EVERYWHERE("mass", HEWN_SCALAR_DOUBLE, 5),     EVERYWHERE("label", HEWN_SCALAR_INT32, 1),
    EVERYWHERE("object", HEWN_SCALAR_INT32, 1),    EVERYWHERE("group", HEWN_SCALAR_INT32, 1),
    EVERYWHERE("material", HEWN_SCALAR_INT32, 1),  EVERYWHERE("smooth", HEWN_SCALAR_INT32, 1),
    EVERYWHERE("attribute", HEWN_SCALAR_INT32, 1),
};

/* A box of twelve triangles. */
static hewn_model make_box(void)
{
    hewn_triangles cube = make_cube();
    hewn_model model = make_model(8, 12, 36, false);
    for (int i = 0; i < 24; i++)
        model.positions[i] = (double)cube.positions[i];
    memcpy(model.corners, cube.indices, 36 * sizeof(uint32_t));
    hewn_triangles_destroy(&cube);
    return model;
}

/* Values that every format could have: unit normals, parts of 1, eighths; labels 1 to 3 with names. */
static void add_candidate(hewn_model *model, const candidate *what, random_state *random)
{
    static const char *const names[] = {"none", "a", "b", "c"};
    hewn_channel *channel = add_channel(model, what->name, what->domain, what->scalar, what->components);
    uint64_t count = hewn_model_domain_count(model, what->domain) * what->components;
    int32_t value;
    bool named = what->scalar == HEWN_SCALAR_INT32 && what->domain == HEWN_DOMAIN_FACE &&
                 strcmp(what->name, "attribute") != 0 && strcmp(what->name, "smooth") != 0;
    for (int i = 0; named && i < 4; i++)
        assert_int_equal(hewn_channel_value(channel, names[i], &value, NULL), HEWN_OK);
    for (uint64_t i = 0; i < count; i++) {
        uint32_t bits = random_below(random, 3);
        double number = strcmp(what->name, "normal") == 0 ? (i / 3 % 3 == i % 3 ? 1 : 0) : (bits + 1) / 4.0;
        switch (what->scalar) {
        case HEWN_SCALAR_FLOAT: ((float *)channel->values)[i] = (float)number; break;
        case HEWN_SCALAR_DOUBLE: ((double *)channel->values)[i] = number; break;
        case HEWN_SCALAR_UINT8: ((uint8_t *)channel->values)[i] = (uint8_t)(51 * (bits + 1)); break;
        case HEWN_SCALAR_INT32: ((int32_t *)channel->values)[i] = (int32_t)bits + 1; break;
        }
    }
}

static double number_at(const hewn_channel *channel, uint64_t index, uint32_t component)
{
    uint64_t at = index * channel->info.components + component;
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)channel->values)[at];
    case HEWN_SCALAR_DOUBLE: return ((const double *)channel->values)[at];
    case HEWN_SCALAR_UINT8: return ((const uint8_t *)channel->values)[at] / 255.0;
    case HEWN_SCALAR_INT32: return ((const int32_t *)channel->values)[at];
    }
    return NAN;
}

/* The element of a channel at a corner. */
static uint64_t element_at(const hewn_model *model, const hewn_channel *channel, uint64_t corner)
{
    return channel->info.domain == HEWN_DOMAIN_VERT     ? model->corners[corner]
           : channel->info.domain == HEWN_DOMAIN_CORNER ? corner
                                                        : corner / 3;
}

static bool same_value(const hewn_channel *a, uint64_t i, const hewn_channel *b, uint64_t j)
{
    if (a->name_count > 0) {
        int32_t x = ((const int32_t *)a->values)[i], y = ((const int32_t *)b->values)[j];
        return b->info.scalar == HEWN_SCALAR_INT32 && b->name_count > 0 && y >= 0 && (uint32_t)y < b->name_count &&
               strcmp(a->names[x], b->names[y]) == 0;
    }
    for (uint32_t k = 0; k < a->info.components; k++)
        if (fabs(number_at(a, i, k) - number_at(b, j, k)) > 1e-6)
            return false;
    return true;
}

/* The corner of `b` at the same place of the same triangle. */
static uint64_t find_corner(const hewn_model *a, uint64_t corner, const hewn_model *b)
{
    for (uint64_t t = 0; t < b->face_count; t++) {
        int found = 0;
        uint64_t match = 0;
        for (uint64_t i = corner / 3 * 3; i < corner / 3 * 3 + 3; i++)
            for (uint64_t j = 3 * t; j < 3 * t + 3; j++)
                if (memcmp(a->positions + 3 * (size_t)a->corners[i], b->positions + 3 * (size_t)b->corners[j], 24) ==
                    0) {
                    found++;
                    match = i == corner ? j : match;
                }
        if (found == 3)
            return match;
    }
    fail_msg("a triangle is missing");
    return 0;
}

/* Labels without names may come back as any numbers: whole numbers are compared as such. */
static bool came_back(const hewn_model *model, const hewn_model *again)
{
    const hewn_channel *channel = &model->channels[0];
    for (int domain = 0; domain < 3; domain++) {
        const hewn_channel *other = hewn_model_find_channel(again, (hewn_domain)domain, channel->info.name);
        bool face = channel->info.domain == HEWN_DOMAIN_FACE;
        if (!other || other->info.components != channel->info.components ||
            face != (other->info.domain == HEWN_DOMAIN_FACE))
            continue;
        bool same = true;
        for (uint64_t c = 0; same && c < 36; c++)
            same = same_value(channel, element_at(model, channel, c), other,
                              element_at(again, other, find_corner(model, c, again)));
        if (same)
            return true;
    }
    return false;
}

static void try_one(const char *path, const candidate *what, random_state *random)
{
    hewn_model model = make_box(), again;
    hewn_error error = {0};
    add_candidate(&model, what, random);
    bool keeps = hewn_mesh_format_keeps(hewn_mesh_format_of(path), &model, &model.channels[0]);
    if (hewn_model_write(&model, path, NULL, &error) != HEWN_OK ||
        hewn_model_read(path, NULL, &again, &error) != HEWN_OK)
        fail_msg("%s with %s: %s", path, what->name, error.message);
    if (keeps != came_back(&model, &again))
        fail_msg("%s and %s of domain %d, scalar %d, %u components: said to be %s", path, what->name, what->domain,
                 what->scalar, what->components, keeps ? "kept, but lost" : "lost, but kept");
    hewn_model_destroy(&again);
    hewn_model_destroy(&model);
}

static void test_formats(void **state)
{
    (void)state;
    static const char *const names[] = {"a.obj", "a.ply", "a.off", "a.stl", "a.glb"};
    char folder[64], path[128];
    make_folder(folder);
    random_state random = {5};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        for (size_t k = 0; k < sizeof candidates / sizeof *candidates; k++)
            try_one(path, &candidates[k], &random);
        assert_int_equal(unlink(path), 0);
    }
    assert_int_equal(rmdir(folder), 0);
}

/* Corners say more than vertices, so OBJ and GLB leave those out; PLY has both. */
static void test_hidden(void **state)
{
    (void)state;
    hewn_model model = make_box();
    add_channel(&model, "uv", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 2);
    add_channel(&model, "uv", HEWN_DOMAIN_CORNER, HEWN_SCALAR_FLOAT, 2);
    static const struct {
        hewn_mesh_format format;
        bool vertex, corner;
    } cases[] = {{HEWN_MESH_OBJ, false, true},
                 {HEWN_MESH_GLB, false, true},
                 {HEWN_MESH_PLY, true, true},
                 {HEWN_MESH_OFF, true, false},
                 {HEWN_MESH_3MF, false, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(hewn_mesh_format_keeps(cases[i].format, &model, &model.channels[0]), cases[i].vertex);
        assert_int_equal(hewn_mesh_format_keeps(cases[i].format, &model, &model.channels[1]), cases[i].corner);
    }
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_formats), cmocka_unit_test(test_hidden)};
    return cmocka_run_group_tests_name("io_keeps", tests, NULL, NULL);
}
