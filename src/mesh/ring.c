#include "mesh/mesh_data.h"

hewn_ring hewn_vert_ring(const hewn_mesh *mesh, hewn_vert vert)
{
    hewn_half first = hewn_vert_half(mesh, vert);
    return (hewn_ring){first, first};
}

bool hewn_ring_next(const hewn_mesh *mesh, hewn_ring *ring, hewn_half *out)
{
    if (ring->at.id == HEWN_NONE)
        return false;
    *out = ring->at;
    ring->at.id = mesh_ccw(mesh, ring->at.id);
    if (ring->at.id == ring->first.id)
        ring->at = HEWN_HALF_NONE;
    return true;
}

uint32_t hewn_vert_valence(const hewn_mesh *mesh, hewn_vert vert)
{
    uint32_t count = 0;
    hewn_half half;
    for (hewn_ring ring = hewn_vert_ring(mesh, vert); hewn_ring_next(mesh, &ring, &half);)
        count++;
    return count;
}
