/* Smoothing of polygons between labels, each vertex within its room. */
#ifndef HEWN_SRC_LABELS_RELAX_H
#define HEWN_SRC_LABELS_RELAX_H

#include "labels/nets.h"

/* So many passes in which each vertex goes half way to the mean of its neighbours, all at once, and no further than its
 * room allows. Where more than two polygons meet, neighbours are those along such edges: curves between labels are
 * smoothed along themselves. HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_label_nets_relax(hewn_label_nets *nets, uint32_t passes, const hewn_progress *progress,
                                  hewn_error *error);

#endif
