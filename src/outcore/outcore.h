/* Simplification of meshes that do not fit in memory: in passes over parts of them, until the rest fits. */
#ifndef HEWN_SRC_OUTCORE_OUTCORE_H
#define HEWN_SRC_OUTCORE_OUTCORE_H

#include "hewn/simplify.h"
#include "outcore/store.h"

/* Bytes that simplification of so many triangles with the channels of a model takes at most, the model included; of a
 * store's those that it carries along. */
uint64_t hewn_outcore_bytes(const hewn_model *channels, uint64_t triangles);

/* Bytes that a model and writing it take at most. */
uint64_t hewn_outcore_model_bytes(const hewn_model *channels, uint64_t triangles);

/* What was done besides. Where the mesh fitted at once there was no pass. */
typedef struct hewn_outcore_report {
    uint32_t passes;
    uint32_t regions;    /* most in a pass */
    uint64_t disk_bytes; /* of temporary files, about */
} hewn_outcore_report;

/* Simplifies a finished store into a model, within about `memory` bytes besides the store's own pages. `desc` as for
 * hewn_model_simplify(), without labels and frozen.
 *
 * What is left of what was asked for after the passes is done in memory where the mesh then fits; else passes go on
 * until there are few enough triangles, or no pass makes them fewer. The report's distance is the sum of those of all
 * passes: an upper bound, since distances add up at most; and none of them goes further than what is left of the error.
 * The vertices at borders between parts are the same on both sides.
 *
 * HEWN_INVALID_ARGUMENT for a bad `desc`, and for no_self_intersections where the mesh does not fit; HEWN_OUT_OF_MEMORY
 * where the result does not fit, or parts that do cannot be made; HEWN_IO; HEWN_CANCELLED; and what
 * hewn_model_simplify() returns. */
hewn_result hewn_outcore_simplify(hewn_store *store, const hewn_simplify_desc *desc, uint64_t memory, hewn_model *out,
                                  hewn_simplify_report *report, hewn_outcore_report *more, hewn_error *error);

#endif
