/* What a probe looks at besides samples. */
#ifndef HEWN_SRC_SIMPLIFY_PROBE_MARK_H
#define HEWN_SRC_SIMPLIFY_PROBE_MARK_H

#include "simplify/samples.h"

/* Points of the mesh as it would be: the new vertex, a triangle's middle, or that of its side towards the one before.
 */
typedef enum mark_kind { MARK_VERTEX, MARK_RIDGE, MARK_MIDDLE } mark_kind;

typedef struct probe_mark {
    uint32_t face; /* of the fan */
    mark_kind kind;
} probe_mark;

#endif
