/* One device for all tests of a program: opened before the first, closed after the last. */
#ifndef HEWN_TESTS_GPU_TEST_DEVICE_H
#define HEWN_TESTS_GPU_TEST_DEVICE_H

#include "gpu_test.h"

static hewn_device *device;
static unsigned messages;

static int open_device(void **state)
{
    (void)state;
    device = gpu_test_open(&messages);
    return 0;
}

static int close_device(void **state)
{
    (void)state;
    gpu_test_close(&device, &messages);
    return 0;
}

#endif
