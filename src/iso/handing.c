#include "iso/handing.h"

#include <omp.h>
#include <string.h>

static void take(hewn_handing *handing)
{
    handing->result = handing->sink->take(handing->sink->user, &handing->part, &handing->error);
}

/* Threads begin with OpenMP's own number of threads and not with that of whoever made them. */
static void *take_beside(void *user)
{
    hewn_handing *handing = user;
    omp_set_num_threads(handing->team);
    take(handing);
    return NULL;
}

void hewn_handing_begin(hewn_handing *handing, const hewn_mesh_sink *sink, const hewn_mesh_part *part,
                        hewn_buffer buffers[3], uint64_t host_bytes)
{
    handing->sink = sink;
    handing->part = *part;
    handing->open = part->open_count > 0 ? part->open[0] : (hewn_number_run){0};
    handing->part.open = &handing->open;
    memcpy(handing->buffers, buffers, sizeof handing->buffers);
    memset(buffers, 0, sizeof handing->buffers);
    handing->host_bytes = host_bytes;
    handing->team = omp_get_max_threads();
    handing->error = (hewn_error){0};
    handing->under_way = true;
    handing->threaded = pthread_create(&handing->thread, NULL, take_beside, handing) == 0;
    if (!handing->threaded)
        take(handing);
}

hewn_result hewn_handing_end(hewn_handing *handing, hewn_device *device, hewn_error *error)
{
    if (!handing->under_way)
        return HEWN_OK;
    if (handing->threaded)
        pthread_join(handing->thread, NULL);
    handing->under_way = false;
    for (int i = 0; i < 3; i++)
        hewn_buffer_destroy(device, &handing->buffers[i]);
    if (handing->result != HEWN_OK && error)
        *error = handing->error;
    return handing->result;
}
