/* Models for tests: a ring of quadrilaterals, and channels of every kind. */
#ifndef HEWN_TEST_MODEL_SUPPORT_H
#define HEWN_TEST_MODEL_SUPPORT_H

#include "hewn/model.h"
#include "test_mesh_support.h"

static inline hewn_model make_model(uint64_t vertices, uint64_t faces, uint64_t corners, bool polygons)
{
    hewn_model model = {.vertex_count = vertices, .face_count = faces};
    model.positions = hewn_alloc_zero(vertices, 3 * sizeof(double));
    model.corners = hewn_alloc_zero(corners, sizeof(uint32_t));
    model.first = polygons ? hewn_alloc_zero(faces + 1, sizeof(uint64_t)) : NULL;
    assert_non_null(model.positions);
    assert_non_null(model.corners);
    return model;
}

/* A ring around z of n × m quadrilaterals, of which every `every`-th (0: none) is cut in two. */
static inline hewn_model make_ring_model(uint32_t n, uint32_t m, uint32_t every)
{
    uint32_t quads = n * m, cut = every ? (quads + every - 1) / every : 0;
    hewn_model model = make_model(quads, quads + cut, 4ull * (quads - cut) + 6ull * cut, true);
    uint64_t face = 0, corner = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m, radius = 1 + 0.3 * cos(v);
            uint32_t q = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
            double position[3] = {radius * cos(u), radius * sin(u), 0.3 * sin(v)};
            memcpy(model.positions + 3 * (size_t)q, position, sizeof position);
            uint32_t around[] = {q, b, c, q, c, d}, whole[] = {q, b, c, d};
            bool two = every && q % every == 0;
            memcpy(model.corners + corner, two ? around : whole, two ? sizeof around : sizeof whole);
            if (two)
                model.first[++face] = corner += 3;
            model.first[++face] = corner += two ? 3 : 4;
        }
    assert_int_equal(face, model.face_count);
    return model;
}

static inline hewn_channel *add_channel(hewn_model *model, const char *name, hewn_domain domain, hewn_scalar scalar,
                                        uint32_t components)
{
    hewn_attribute_info info = {.name = name, .domain = domain, .scalar = scalar, .components = components};
    hewn_channel *channel = NULL;
    hewn_error error = {0};
    if (hewn_model_add_channel(model, &info, &channel, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return channel;
}

/* The bytes of a channel's values. */
static inline size_t channel_bytes(const hewn_model *model, const hewn_channel *channel)
{
    return hewn_model_domain_count(model, channel->info.domain) * channel->info.components *
           hewn_scalar_size(channel->info.scalar);
}

/* A channel of each scalar in each domain, of random bits; whole numbers have names. */
static inline void add_every_channel(hewn_model *model, random_state *random)
{
    static const char *const names[] = {"a", "b", "c", "d"};
    for (int domain = 0; domain < 3; domain++)
        for (int scalar = 0; scalar < 4; scalar++) {
            uint32_t components = 1 + random_below(random, 4);
            hewn_channel *channel =
                add_channel(model, names[scalar], (hewn_domain)domain, (hewn_scalar)scalar, components);
            unsigned char *bytes = channel->values;
            for (size_t i = 0; i < channel_bytes(model, channel); i++)
                bytes[i] = (unsigned char)random_bits(random);
            int32_t value;
            for (int name = 0; name < domain + 2 && scalar == HEWN_SCALAR_INT32; name++)
                assert_int_equal(hewn_channel_value(channel, names[name], &value, NULL), HEWN_OK);
        }
}

/* Gives vertices and corners their position ("where"), faces their number ("which"): no edit may part these. */
static inline void add_tell_tales(hewn_model *model)
{
    hewn_channel *channel = add_channel(model, "where", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 3);
    memcpy(channel->values, model->positions, channel_bytes(model, channel));
    double *where = add_channel(model, "where", HEWN_DOMAIN_CORNER, HEWN_SCALAR_DOUBLE, 3)->values;
    for (uint64_t c = 0; c < hewn_model_corner_count(model); c++)
        memcpy(where + 3 * c, model->positions + 3 * (size_t)model->corners[c], 3 * sizeof(double));
    int32_t *which = add_channel(model, "which", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1)->values;
    for (uint64_t f = 0; f < model->face_count; f++)
        which[f] = (int32_t)f;
}

#endif
