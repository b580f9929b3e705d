/* Places the vertices of the dual methods on the host, for devices that share its memory and its processors: the work
 * of nets_vertices.glsl and dual_vertices.glsl. The device only tells how the surface looks from places, with a kernel
 * that takes a driver no longer to compile than any other one of the field: the search itself, in a kernel, took most
 * of a first run (docs/performance.md). */
#ifndef HEWN_SRC_ISO_HOST_PLACE_H
#define HEWN_SRC_ISO_HOST_PLACE_H

#include "iso/extractor.h"
#include "iso/host_dual.h"

typedef struct hewn_placing {
    const hewn_extractor *extractor;
    const hewn_bricks *bricks;
    const hewn_host_dual *dual; /* spread; its points are solved */
    const float *point_normals; /* of crossings */
    float *normals;             /* out, as dual->positions */
    hewn_method method;
    uint64_t summary; /* address of words where the device notes that it cut loops */
} hewn_placing;

/* Places vertices from own[0] up to before `end`, and adds those before own[1] to `sums`. They are the same for any
 * number of threads and however much memory there is. Device errors. */
hewn_result hewn_host_place(const hewn_placing *placing, const uint64_t own[2], uint64_t end, hewn_workspace *workspace,
                            hewn_emission *sums, hewn_error *error);

#endif
