#include "pipeline/opening.h"

#include <stdio.h>

#include "base/clock.h"

static void count_message(void *user, const char *text)
{
    hewn_opening *opening = user;
    atomic_fetch_add(&opening->messages, 1);
    fprintf(stderr, "hewn: validation: %s\n", text);
}

static void *open_device(void *user)
{
    hewn_opening *opening = user;
    opening->result = hewn_device_create(&opening->desc, &opening->device, &opening->error);
    opening->end = hewn_clock_now();
    return NULL;
}

void hewn_opening_begin(hewn_opening *opening, const char *choice, bool validation)
{
    *opening = (hewn_opening){.desc = {.choice = choice, .validation = validation}};
    opening->desc.message = count_message;
    opening->desc.user = opening;
    opening->threaded = pthread_create(&opening->thread, NULL, open_device, opening) == 0;
    if (!opening->threaded)
        open_device(opening);
}

static void join(hewn_opening *opening)
{
    if (opening->threaded)
        pthread_join(opening->thread, NULL);
    opening->threaded = false;
}

hewn_result hewn_opening_wait(hewn_opening *opening, hewn_device **device, hewn_error *error)
{
    join(opening);
    *device = opening->device;
    if (opening->result != HEWN_OK && error)
        *error = opening->error;
    return opening->result;
}

void hewn_opening_close(hewn_opening *opening)
{
    join(opening);
    hewn_device_destroy(&opening->device);
}
