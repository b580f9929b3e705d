/* Files of creases and corners: the `t` lines of OBJ files for subdivision. */
#ifndef HEWN_SRC_PIPELINE_TAG_FILE_H
#define HEWN_SRC_PIPELINE_TAG_FILE_H

#include "hewn/subdivide.h"

typedef struct hewn_tags {
    hewn_crease *creases;
    hewn_corner_tag *corners;
    size_t crease_count, crease_room, corner_count, corner_room;
} hewn_tags;

/* Reads lines `t crease 2/1/0 A B SHARPNESS` and `t corner 1/1/0 V SHARPNESS`, vertices from 0; a crease may name a
 * chain of vertices (N/1/0 and N vertices). All other lines are passed over. HEWN_BAD_INPUT names the line. */
hewn_result hewn_tags_read(const char *path, hewn_tags *out, hewn_error *error);
void hewn_tags_free(hewn_tags *tags);

#endif
