/* Polygons between labels, before they are smoothed and cut into triangles. */
#ifndef HEWN_SRC_LABELS_NETS_H
#define HEWN_SRC_LABELS_NETS_H

#include "labels/ids.h"

/* How far a vertex may be moved. */
typedef enum hewn_net_room {
    HEWN_NET_CELL = 0, /* alone in its cell: all of it */
    HEWN_NET_NEAR,     /* one of several in a cell: not far from where it is made */
    HEWN_NET_FACE      /* on a split face: this and the next two, across i, j and k */
} hewn_net_room;

/* Positions are in the lattice: voxel centres are whole numbers. */
typedef struct hewn_label_nets {
    uint64_t vertex_count, polygon_count, corner_count, link_count;
    double *positions;
    uint8_t *room;     /* a hewn_net_room for each vertex */
    uint32_t *first;   /* of each polygon's corners; polygon_count + 1 */
    uint32_t *corners; /* counter-clockwise seen from the front */
    uint16_t *sides;   /* the ids behind and in front of each polygon */
    uint8_t *axis;     /* of the grid edge that the polygon is around, whose low end is the low corner of the cell of
                          the polygon's first corner; 3: it lies within a cell */
    uint32_t *links;   /* the two ends of each edge between polygons, */
    bool *junction;    /* and whether more than two polygons meet there */
} hewn_label_nets;

/* HEWN_LIMIT for 2^32 corners, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED; free it also then. */
hewn_result hewn_label_nets_make(const hewn_label_ids *ids, const hewn_progress *progress, hewn_label_nets *out,
                                 hewn_error *error);
void hewn_label_nets_free(hewn_label_nets *nets);

#endif
