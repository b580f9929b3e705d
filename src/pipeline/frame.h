/* Which unit and axes a format's files are in. */
#ifndef HEWN_SRC_PIPELINE_FRAME_H
#define HEWN_SRC_PIPELINE_FRAME_H

#include "hewn/io.h"
#include "hewn/volume.h"

/* A unit and an up axis; NULL: what the model is in. */
typedef struct hewn_frame {
    const hewn_unit *unit;
    const hewn_axis *up;
} hewn_frame;

/* The frame to write in, given the one that was asked for: GLB is in metres with +Y up, 3MF has +Z up and a unit from a
 * list that kilometres are not in. HEWN_INVALID_ARGUMENT where the format cannot have what was asked for. */
hewn_result hewn_frame_choose(hewn_mesh_format to, hewn_frame wanted, hewn_frame *out, hewn_error *error);

/* The unit of that frame for a model: a 3MF file without a unit is in millimetres, and has none for kilometres. */
const hewn_unit *hewn_frame_unit(hewn_mesh_format to, hewn_frame frame, const hewn_model *model);

/* Whether a file can have a volume's mesh in a space and a unit (NULL: any): GLB is in glTF's and in metres, voxels
 * have no unit. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_frame_check_space(hewn_mesh_format to, hewn_space space, const hewn_unit *unit, hewn_error *error);

/* The space that a volume's mesh is written in, where nobody says: glTF's in GLB, else RAS or the volume's world. */
hewn_space hewn_frame_choose_space(hewn_mesh_format to, hewn_space wanted, const hewn_volume *volume);

/* What files call a space (hewn_write_desc.space), of a patient's volume or another's; NULL: nothing. */
const char *hewn_frame_space_tag(hewn_space space, bool anatomical);

/* Sets what a model is in, whatever its file says; what is NULL stays. */
void hewn_frame_declare(hewn_frame frame, hewn_model *model);

#endif
