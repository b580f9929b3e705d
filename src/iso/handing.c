#include "iso/handing.h"

#include <string.h>

#include "base/clock.h"

static void *take(void *user)
{
    hewn_handing *handing = user;
    handing->result = handing->sink->take(handing->sink->user, &handing->part, &handing->error);
    handing->end = hewn_clock_now();
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
    handing->error = (hewn_error){0};
    handing->begin = handing->begin > 0 ? handing->begin : hewn_clock_now();
    handing->under_way = true;
    handing->threaded = pthread_create(&handing->thread, NULL, take, handing) == 0;
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
    handing->host_bytes = 0;
    for (int i = 0; i < 3; i++)
        hewn_buffer_destroy(device, &handing->buffers[i]);
    if (handing->result != HEWN_OK && error)
        *error = handing->error;
    return handing->result;
}
