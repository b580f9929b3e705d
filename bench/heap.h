/* The shapes of a heap, as assets/scenes/random.lua makes it, read off its field. */
#ifndef HEWN_BENCH_HEAP_H
#define HEWN_BENCH_HEAP_H

#include "dense.h"
#include "hewn/field.h"

/* In the order in which they were melted; owned by the caller (free). NULL where the field is something else. */
dense_shape *heap_read(const hewn_field *field, size_t *count);

#endif
