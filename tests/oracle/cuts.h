/* A serial twin of the extraction, from signs to the directed cuts on cell faces, written on its own: no table, no
 * bricks. */
#ifndef HEWN_TESTS_ORACLE_CUTS_H
#define HEWN_TESTS_ORACLE_CUTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Grid edges are named 3 * (i + (nx + 1) * (j + (ny + 1) * k)) + axis by the sample where they start. */
typedef struct oracle_cut {
    uint64_t from, to; /* names of the two edges */
} oracle_cut;

typedef struct oracle_surface {
    uint64_t vertex_count;   /* edges whose ends differ */
    uint64_t triangle_count; /* of all loops, each of n cuts giving n - 2 */
    oracle_cut
        *cuts; /* a cut for each cell that has it, sorted; shape's outside to the left of the mesh's outer side */
    size_t cut_count;
} oracle_surface;

/* `inside` has (cells + 1)^3 entries, x fastest. Free the cuts with free(). */
oracle_surface oracle_trace(const uint32_t cells[3], const bool *inside);

/* Sorts cuts by name. */
void oracle_sort(oracle_cut *cuts, size_t count);

#endif
