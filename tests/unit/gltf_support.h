/* Shared by the tests of glTF. */
#ifndef HEWN_TEST_GLTF_SUPPORT_H
#define HEWN_TEST_GLTF_SUPPORT_H

#include "io_support.h"

/* The numbers of a corner, of whichever domain the channel is. */
static inline void get_numbers(const hewn_model *model, const char *name, uint64_t corner, double out[16])
{
    const hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_CORNER, name);
    uint64_t at = corner;
    if (!channel) {
        channel = hewn_model_find_channel(model, HEWN_DOMAIN_VERT, name);
        at = model->corners[corner];
    }
    if (!channel)
        fail_msg("no channel \"%s\"", name);
    for (uint32_t k = 0; channel && k < channel->info.components; k++)
        out[k] = hewn_channel_number(channel, at, k);
}

#endif
