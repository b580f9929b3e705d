/* Which triangles each label has. */
#ifndef HEWN_SRC_LABELS_FACES_H
#define HEWN_SRC_LABELS_FACES_H

#include "hewn/labels.h"

/* Makes `first` and `faces` anew, of `sides`. What was there stays after HEWN_OUT_OF_MEMORY. */
hewn_result hewn_label_mesh_list_faces(hewn_label_mesh *mesh, hewn_error *error);

#endif
