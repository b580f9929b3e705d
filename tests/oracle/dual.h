/* A serial twin of the dual surfaces' topology, written on its own: no table, no bricks. Loops are followed cell by
 * cell; a face is joined the other way where the patterns of both its cells ask for it. And a maker of dual surfaces
 * with crossings from a field on the CPU. */
#ifndef HEWN_TESTS_ORACLE_DUAL_H
#define HEWN_TESTS_ORACLE_DUAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hewn/extract.h"
#include "iso/dual.h"

typedef struct oracle_dual {
    uint32_t vertex_count, quad_count;
    uint32_t flips;  /* faces that are joined the other way */
    uint32_t *cells; /* 3 a vertex */
    uint32_t *loops; /* a vertex: mask of the cube edges that its loop passes; those of a cell by their lowest edge */
    uint32_t *quads; /* 4 a quad, counter-clockwise seen from outside */
    uint32_t *edges; /* 4 a quad: the sample where its grid edge starts, and its axis */
} oracle_dual;

/* `inside` has (cells + 1)^3 entries, x fastest. Edges on the bounds have no quad. `flip` false leaves every ambiguous
 * face with its outside joined: what the flips are there for. */
oracle_dual oracle_dual_trace(const uint32_t cells[3], const bool *inside, bool flip);
void oracle_dual_free(oracle_dual *dual);

/* A uniform dual surface of a field: crossings by bisection in double, normals by the field's gradient, vertices at the
 * minimum of their loop's quadric, or where `mean` is set in the middle of its crossings. An open one has a layer of
 * cells without thickness around it. Owned by the caller: oracle_dual_surface_free(). Failures are asserted away. */
hewn_dual_surface oracle_dual_surface(const hewn_field *field, hewn_node root, const hewn_extract_desc *desc,
                                      bool mean);
void oracle_dual_surface_free(hewn_dual_surface *surface);

/* Its quads as triangles, cut along their first and third corner. */
hewn_triangles oracle_dual_triangles(const hewn_dual_surface *surface);

#endif
