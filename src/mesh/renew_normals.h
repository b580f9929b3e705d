/* Normals of a model whose vertices have moved. */
#ifndef HEWN_SRC_MESH_RENEW_NORMALS_H
#define HEWN_SRC_MESH_RENEW_NORMALS_H

#include "hewn/model.h"

/* Makes channels "normal" of vertices and corners (3 FLOAT or DOUBLE) anew from the faces. Corners of a vertex that had
 * the same normal get the same one. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_model_renew_normals(hewn_model *model, hewn_error *error);

#endif
