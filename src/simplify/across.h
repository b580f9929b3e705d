/* What lies across the sides of triangles whose common edge changes. */
#ifndef HEWN_SRC_SIMPLIFY_ACROSS_H
#define HEWN_SRC_SIMPLIFY_ACROSS_H

#include "simplify/work.h"

/* What is across one side of the two triangles, and what is known of that side. */
typedef struct simplify_across {
    uint32_t twin, wedge;
    float key;
    uint8_t flags;
} simplify_across;

static inline simplify_across simplify_across_take(const simplify_work *work, uint32_t h)
{
    const uint32_t name = simplify_name(work, h);
    return (simplify_across){work->twin[h], work->wedge ? work->wedge[h] : 0, work->key[name], work->flags[name]};
}

/* Half-edge `h` leaves `tail` now and is that side. */
static inline void simplify_across_give(simplify_work *work, uint32_t h, uint32_t tail, const simplify_across *side)
{
    work->tail[h] = tail;
    work->twin[h] = side->twin;
    if (side->twin != HEWN_NONE)
        work->twin[side->twin] = h;
    if (work->wedge)
        work->wedge[h] = side->wedge;
    const uint32_t name = simplify_name(work, h);
    work->key[name] = side->key;
    work->flags[name] = side->flags;
}

#endif
