/* Simplification of a complex: triangles of which any number may meet at an edge. */
#ifndef HEWN_SRC_SIMPLIFY_COMPLEX_H
#define HEWN_SRC_SIMPLIFY_COMPLEX_H

#include "hewn/simplify.h"

/* Simplifies triangles of which any number may meet along edges and at vertices, as between the labels of a volume.
 * Two triangles at an edge that agree in direction go on into each other; all other edges are curves, which stay where
 * they are as well as may be, and become coarser as curves. So the complex keeps its topology, and so does every part
 * of it that goes on wherever two triangles do: where that is a manifold it stays one, and parts that share triangles,
 * edges or vertices share what becomes of them. Lengths, targets and the rest as with hewn_polygons_simplify(), of
 * which `labels`, `lock_labels`, `frozen` and `preserve` are not looked at, lock_boundary keeps all curves, and
 * no_self_intersections is HEWN_INVALID_ARGUMENT. */
hewn_result hewn_complex_simplify(const hewn_polygons *triangles, const hewn_simplify_desc *desc, hewn_simplified *out,
                                  hewn_simplify_report *report, hewn_error *error);

#endif
