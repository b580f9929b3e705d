/* Exclusive prefix sum of 32-bit counts: reduce, scan the sums of blocks, add. No workgroup ever waits for another. */
#ifndef HEWN_SRC_GPU_SCAN_H
#define HEWN_SRC_GPU_SCAN_H

#include "gpu/commands.h"

typedef struct hewn_scan hewn_scan;

/* The programs of a scan; one serves any number of recordings. */
hewn_result hewn_scan_create(hewn_device *device, bool soon, hewn_scan **out, hewn_error *error);
void hewn_scan_destroy(hewn_device *device, hewn_scan **scan);

/* Bytes of scratch that a scan of `count` needs (0 for none). */
uint64_t hewn_scan_scratch_bytes(uint64_t count);

/* Records: values[0..count) (uint32 at `values`, a device address) become their exclusive prefix sums, modulo 2^32; the
 * uint64 at `total` becomes the true sum (as two uint32, low first). A total of 2^32 or more means that the sums
 * overflowed: the caller must check it (hewn_scan_check). `scratch` must be hewn_scan_scratch_bytes() large and in use
 * by nothing else in the recording between. */
void hewn_scan_record(hewn_scan *scan, hewn_commands *commands, uint64_t values, uint64_t count, uint64_t total,
                      uint64_t scratch);

/* The same where only the device knows the count: the uint32 at `count_address`, at most `capacity`. */
void hewn_scan_record_indirect(hewn_scan *scan, hewn_commands *commands, uint64_t values, uint64_t count_address,
                               uint64_t capacity, uint64_t total, uint64_t scratch);

/* HEWN_LIMIT where a total does not fit 32 bits; `what` names the things counted. */
hewn_result hewn_scan_check(const uint32_t total[2], const char *what, hewn_error *error);

#endif
