/* The work of remote.comp on the host, for devices that share its memory: the same bytes. */
#ifndef HEWN_SRC_ISO_HOST_REMOTE_H
#define HEWN_SRC_ISO_HOST_REMOTE_H

#include "hewn/base.h"
#include "shared/iso.h"

/* Views of the buffers of hewn_remote_push. */
typedef struct hewn_host_remote {
    uint32_t top[3];
    uint32_t levels;
    uint32_t count; /* bricks */
    const uint32_t *bricks, *cuts;
    const uint32_t *states[HEWN_MAX_LEVELS];
} hewn_host_remote;

/* Writes the blocks beyond the neighbourhood of the surface to `remote`, two words a brick. Uses all threads of OpenMP.
 */
void hewn_host_remote_find(const hewn_host_remote *view, uint32_t *remote);

#endif
