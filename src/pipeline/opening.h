/* Opening a device in the background, while the scene is read. */
#ifndef HEWN_SRC_PIPELINE_OPENING_H
#define HEWN_SRC_PIPELINE_OPENING_H

#include <pthread.h>
#include <stdatomic.h>

#include "hewn/device.h"

typedef struct hewn_opening {
    hewn_device_desc desc;
    pthread_t thread;
    bool threaded; /* the thread runs and was not joined yet */
    hewn_result result;
    hewn_error error;
    hewn_device *device;
    double end; /* hewn_clock_now() when it was open */
    atomic_uint_least64_t messages;
} hewn_opening;

/* Starts opening. The struct must stay where it is until hewn_opening_close(); `choice` must live as long. */
void hewn_opening_begin(hewn_opening *opening, const char *choice, bool validation);

/* Waits until the device is open; it belongs to the opening. The errors are those of hewn_device_create(). */
hewn_result hewn_opening_wait(hewn_opening *opening, hewn_device **device, hewn_error *error);

/* Waits for the thread and closes the device, if there is one. */
void hewn_opening_close(hewn_opening *opening);

#endif
