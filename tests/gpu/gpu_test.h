/* What the GPU tests share: cmocka, a device with the validation layer on, and the rule that the layer stays silent. */
#ifndef HEWN_TESTS_GPU_TEST_H
#define HEWN_TESTS_GPU_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu/gpu.h"

/* Counts what the layer says, also while the device is being destroyed. */
static inline void gpu_test_message(void *user, const char *text)
{
    unsigned *count = user;
    ++*count;
    print_error("# validation: %s\n", text);
}

static inline hewn_device *gpu_test_open(unsigned *messages)
{
    *messages = 0;
    hewn_error error = {0};
    hewn_device *device;
    const hewn_device_desc desc = {.validation = true, .message = gpu_test_message, .user = messages};
    if (hewn_device_create(&desc, &device, &error) != HEWN_OK)
        fail_msg("no device: %s", error.message);
    return device;
}

/* Objects that a test forgot to destroy are messages too. Nothing is left to close where no device was opened. */
static inline void gpu_test_close(hewn_device **device, const unsigned *messages)
{
    if (!*device)
        return;
    assert_int_equal(*messages, hewn_device_message_count(*device));
    hewn_device_destroy(device);
    assert_null(*device);
    assert_int_equal(*messages, 0);
}

/* Fails the test with the reason where `call`, which passes &error, fails. */
#define GPU_TEST_TRY(call)                                                                                             \
    do {                                                                                                               \
        hewn_error error = {0};                                                                                        \
        if ((call) != HEWN_OK)                                                                                         \
            fail_msg("%s: %s", hewn_result_name(error.code), error.message);                                           \
    } while (0)

/* Repeatable pseudo-random numbers (xorshift64*, Vigna 2016). */
static inline uint32_t gpu_test_random(uint64_t *state)
{
    uint64_t x = *state;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return (uint32_t)((x * 0x2545f4914f6cdd1du) >> 32);
}

static inline bool gpu_test_long(void)
{
    const char *value = getenv("HEWN_LONG");
    return value && *value && strcmp(value, "0") != 0;
}

#endif
