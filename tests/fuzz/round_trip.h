/* For fuzzers of formats that hold what their reader makes: a model that was read is valid, and written and read again
 * it is the same, bit for bit. */
#ifndef HEWN_FUZZ_ROUND_TRIP_H
#define HEWN_FUZZ_ROUND_TRIP_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hewn/io.h"

static inline void demand(bool holds)
{
    if (!holds)
        abort();
}

static inline void demand_same_bytes(const void *a, const void *b, size_t length)
{
    demand(length == 0 || memcmp(a, b, length) == 0);
}

static inline void demand_same_models(const hewn_model *a, const hewn_model *b)
{
    demand(a->vertex_count == b->vertex_count && a->face_count == b->face_count);
    demand(a->channel_count == b->channel_count && !a->first == !b->first);
    demand(a->unit == b->unit && a->up_known == b->up_known && a->up == b->up);
    if (a->first)
        demand_same_bytes(a->first, b->first, (a->face_count + 1) * sizeof *a->first);
    demand_same_bytes(a->positions, b->positions, a->vertex_count * 3 * sizeof *a->positions);
    demand_same_bytes(a->corners, b->corners, hewn_model_corner_count(a) * sizeof *a->corners);
    for (uint32_t i = 0; i < a->channel_count; i++) {
        const hewn_channel *mine = &a->channels[i];
        const hewn_channel *other = hewn_model_find_channel(b, mine->info.domain, mine->info.name);
        demand(other && mine->info.scalar == other->info.scalar && mine->info.components == other->info.components);
        demand_same_bytes(mine->values, other->values,
                          hewn_model_domain_count(a, mine->info.domain) * mine->info.components *
                              hewn_scalar_size(mine->info.scalar));
        demand(mine->name_count == other->name_count);
        for (uint32_t n = 0; n < mine->name_count; n++)
            demand(strcmp(mine->names[n], other->names[n]) == 0);
    }
}

/* Destroys the model. */
static inline void demand_round_trip(hewn_model *model, const char *extension)
{
    char path[64];
    hewn_model again;
    snprintf(path, sizeof path, "/tmp/hewn-fuzz-%ld.%s", (long)getpid(), extension);
    demand(hewn_model_check(model, NULL) == HEWN_OK);
    demand(hewn_model_write(model, path, NULL, NULL) == HEWN_OK);
    demand(hewn_model_read(path, NULL, &again, NULL) == HEWN_OK);
    demand(unlink(path) == 0);
    demand_same_models(model, &again);
    hewn_model_destroy(&again);
    hewn_model_destroy(model);
}

static inline void demand_nothing(const hewn_model *model)
{
    const hewn_model nothing = {0};
    demand_same_bytes(model, &nothing, sizeof nothing);
}

/* Files take a hundred times as long as reading does: one in eight inputs goes through them, whichever way it runs. */
static inline bool is_chosen(const uint8_t *data, size_t size)
{
    uint32_t sum = 0;
    for (size_t i = 0; i < size; i++)
        sum = 31 * sum + data[i];
    return sum % 8 == 0;
}

#endif
