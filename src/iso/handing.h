/* A part of a mesh on its way to a sink, which takes it on a thread of its own while the next part is made.
 *
 * From hewn_handing_begin() to hewn_handing_end() the part's buffers are the handing's, and the sink may hold
 * `host_bytes`. Both count until then, even where the sink is done earlier: so what counts does not depend on time. The
 * sink's thread reads the buffers and nothing else of the device, whose accounts are the caller's thread's alone. */
#ifndef HEWN_SRC_ISO_HANDING_H
#define HEWN_SRC_ISO_HANDING_H

#include <pthread.h>

#include "gpu/gpu.h"
#include "hewn/triangles.h"

/* Zero is "nothing is on its way". */
typedef struct hewn_handing {
    const hewn_mesh_sink *sink;
    hewn_mesh_part part;
    hewn_number_run open;   /* what `part` names as open */
    hewn_buffer buffers[3]; /* what it lies in, where the host reads it */
    uint64_t host_bytes;
    int team; /* threads that work together in the sink: as many as in the caller */
    bool under_way, threaded;
    pthread_t thread;
    hewn_result result;
    hewn_error error;
} hewn_handing;

/* Hands a part over, which has one run of open vertices at the most, and the buffers too, which become zero. None may
 * be under way. Where there is no thread to be had the sink is done when this returns. */
void hewn_handing_begin(hewn_handing *handing, const hewn_mesh_sink *sink, const hewn_mesh_part *part,
                        hewn_buffer buffers[3], uint64_t host_bytes);

/* Waits for the sink and frees the buffers; returns what the sink did, with its error. Where none is under way it does
 * nothing. */
hewn_result hewn_handing_end(hewn_handing *handing, hewn_device *device, hewn_error *error);

#endif
