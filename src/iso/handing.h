/* A part of a mesh on its way to a sink, which takes it on a thread of its own while the next part is made. */
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
    hewn_buffer buffers[3]; /* what it lies in */
    uint64_t host_bytes;    /* that the sink takes meanwhile, at the most */
    bool under_way, threaded;
    pthread_t thread;
    hewn_result result;
    hewn_error error;
    double begin, end; /* of all parts so far; 0: there was none */
} hewn_handing;

/* Hands a part over, and the buffers too, which become zero. None may be under way. Where there is no thread to be had
 * the sink is done when this returns. */
void hewn_handing_begin(hewn_handing *handing, const hewn_mesh_sink *sink, const hewn_mesh_part *part,
                        hewn_buffer buffers[3], uint64_t host_bytes);

/* Waits for the sink and frees the buffers; returns what the sink did. Where none is under way it does nothing. */
hewn_result hewn_handing_end(hewn_handing *handing, hewn_device *device, hewn_error *error);

#endif
