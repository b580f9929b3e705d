/* How steep a field is in each part of its box, for fields that are too steep somewhere. */
#ifndef HEWN_SRC_RENDER_SLOPES_H
#define HEWN_SRC_RENDER_SLOPES_H

#include "hewn/field.h"

enum { HEWN_SLOPES_ACROSS = 16 };

typedef struct hewn_slopes {
    float lo[3], size[3], scale[3]; /* of the box, of a part; from coordinates to parts */
    float margin;
    float greatest; /* of those that count */
    float *bounds;  /* of each part and what is `margin` beyond it, x fastest; 0: more than `most` */
} hewn_slopes;

/* `bounds` stays NULL where the field is so large, or so steep all over, that it is not worth the time.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_slopes_create(const hewn_field *field, hewn_node root, const hewn_box *box, double margin, double most,
                               hewn_slopes *out, hewn_error *error);
void hewn_slopes_destroy(hewn_slopes *slopes);

/* Of the part that a point is in, and where a way from there with direction `along` leaves that, counted from it. */
float hewn_slopes_at(const hewn_slopes *slopes, const float p[3], const float along[3], float *way);

#endif
