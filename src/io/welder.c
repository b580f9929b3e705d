#include "io/welder.h"

#include <string.h>

static const uint64_t FREE = UINT64_MAX;

/* Multiplication and shifts as in the finaliser of Steele, Lea and Flood 2014 ('Fast splittable pseudorandom number
 * generators'). */
static uint64_t hash_position(const double position[3])
{
    uint64_t bits[3];
    memcpy(bits, position, sizeof bits);
    uint64_t hash = bits[0] * 0x9e3779b97f4a7c15u;
    hash = (hash ^ hash >> 32 ^ bits[1]) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ hash >> 29 ^ bits[2]) * 0x94d049bb133111ebu;
    return hash ^ hash >> 31;
}

static uint64_t slot_of(uint64_t hash, uint32_t vertex)
{
    return (hash & 0xffffffff00000000u) | vertex;
}

/* Places come from all bits of the hash but the lowest, so that tables of any size have enough of them. */
static size_t place_of(const hewn_welder *welder, uint64_t hash)
{
    return (size_t)(hash >> 8) & (welder->slot_count - 1);
}

/* Makes the table large enough for so many vertices. */
static hewn_result grow_table(hewn_welder *welder, const hewn_model *model, uint64_t vertices, hewn_error *error)
{
    size_t count = welder->slot_count ? welder->slot_count : 1024;
    while (count / 2 < vertices)
        count *= 2;
    uint64_t *slots = hewn_alloc(count, sizeof *slots);
    if (!slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding %llu vertices",
                         (unsigned long long)model->vertex_count);
    memset(slots, 0xff, count * sizeof *slots);
    hewn_free(welder->slots);
    welder->slots = slots;
    welder->slot_count = count;
    for (uint64_t v = welder->first; v < model->vertex_count; v++) {
        uint64_t hash = hash_position(model->positions + 3 * v);
        size_t at = place_of(welder, hash);
        while (slots[at] != FREE)
            at = (at + 1) & (count - 1);
        slots[at] = slot_of(hash, (uint32_t)v);
    }
    return HEWN_OK;
}

hewn_result hewn_welder_reserve(hewn_welder *welder, const hewn_builder *builder, uint64_t vertices, hewn_error *error)
{
    if (!welder->slots)
        welder->first = builder->model.vertex_count;
    bool enough = welder->slots && vertices <= welder->slot_count / 2;
    return enough ? HEWN_OK : grow_table(welder, &builder->model, vertices, error);
}

hewn_result hewn_welder_add(hewn_welder *welder, hewn_builder *builder, const double position[3], uint32_t *vertex,
                            hewn_error *error)
{
    const hewn_model *model = &builder->model;
    uint64_t known = welder->slots ? model->vertex_count - welder->first : 0;
    if (!welder->slots || 2 * (known + 1) > welder->slot_count)
        HEWN_TRY(hewn_welder_reserve(welder, builder, known + 1, error));
    const double key[3] = {position[0] + 0.0, position[1] + 0.0, position[2] + 0.0}; /* -0 becomes 0 */
    uint64_t hash = hash_position(key), slot;
    size_t at = place_of(welder, hash);
    for (; (slot = welder->slots[at]) != FREE; at = (at + 1) & (welder->slot_count - 1))
        if (slot >> 32 == hash >> 32 && memcmp(model->positions + 3 * (slot & 0xffffffffu), key, sizeof key) == 0) {
            *vertex = (uint32_t)slot;
            return HEWN_OK;
        }
    if (model->vertex_count >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "more vertices than indices can name");
    HEWN_TRY(hewn_builder_add_vertex(builder, key, error));
    *vertex = (uint32_t)(model->vertex_count - 1);
    welder->slots[at] = slot_of(hash, *vertex);
    return HEWN_OK;
}

void hewn_welder_expect(const hewn_welder *welder, const double position[3])
{
    const double key[3] = {position[0] + 0.0, position[1] + 0.0, position[2] + 0.0};
    if (welder->slots)
        __builtin_prefetch(&welder->slots[place_of(welder, hash_position(key))]);
}

void hewn_welder_clear(hewn_welder *welder)
{
    hewn_free(welder->slots);
    *welder = (hewn_welder){0};
}
