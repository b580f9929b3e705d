/* The colours of a model, as triangles have them. */
#ifndef HEWN_SRC_MESH_CORNER_COLORS_H
#define HEWN_SRC_MESH_CORNER_COLORS_H

#include "hewn/model.h"

/* Colours of the corners of the triangles that hewn_triangles_from_model() makes, nine numbers a triangle, from the
 * channels "color" of corners or else of vertices, times that of faces where `linear` (as glTF has them), else from the
 * first of these that there is. Bytes are shares of 255; values are cut off at 0 and 1; with `linear` they are linear
 * light, else as on a screen (sRGB), and are made linear. `*out` is the caller's (hewn_free), NULL where the model has
 * no colours. HEWN_OUT_OF_MEMORY, the errors of hewn_model_check(). */
hewn_result hewn_corner_colors_of_model(const hewn_model *model, bool linear, float **out, hewn_error *error);

#endif
