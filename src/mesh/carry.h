/* Attribute values on their way from a model to the mesh that was made of it. */
#ifndef HEWN_SRC_MESH_CARRY_H
#define HEWN_SRC_MESH_CARRY_H

#include "hewn/model.h"
#include "mesh/mesh_data.h"

/* Makes every channel of `model` an attribute of `mesh`, which has none yet and no holes. `origins` says where its
 * elements come from; NULL: they are those of the model. Elements without origin stay zero. A normal that ran with the
 * side of its face (for vertices: of all their faces) is turned where the face was. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_mesh_carry(hewn_mesh *mesh, const hewn_model *model, const hewn_repair_origins *origins,
                            hewn_error *error);

/* Gives elements without origin the values of their neighbours: vertices and corners a blend, layer by layer inwards,
 * faces those of the next face. Normals come from the faces without origin. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_mesh_spread(hewn_mesh *mesh, const hewn_repair_origins *origins, hewn_error *error);

/* Twice the area of a face, along its normal (Newell's sum about the first corner). */
void hewn_mesh_face_vector(const hewn_mesh *mesh, uint32_t face, double out[3]);

#endif
