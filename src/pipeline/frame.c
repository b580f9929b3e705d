#include "pipeline/frame.h"

#include <string.h>

#include "base/error.h"

static const hewn_axis plus_y = HEWN_AXIS_PLUS_Y, plus_z = HEWN_AXIS_PLUS_Z;

hewn_result hewn_frame_choose(hewn_mesh_format to, hewn_frame wanted, hewn_frame *out, hewn_error *error)
{
    const hewn_unit *metre = hewn_unit_find("m");
    *out = wanted;
    if (to == HEWN_MESH_GLB && wanted.unit && wanted.unit != metre)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "GLB is always in metres, not in %s", wanted.unit->name);
    if (to == HEWN_MESH_GLB && wanted.up && *wanted.up != plus_y)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "GLB always has +Y up, not %s", hewn_axis_name(*wanted.up));
    if (to == HEWN_MESH_3MF && wanted.up && *wanted.up != plus_z)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "3MF always has +Z up, not %s", hewn_axis_name(*wanted.up));
    if (to == HEWN_MESH_3MF && wanted.unit && strcmp(wanted.unit->name, "km") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "3MF cannot be in km");
    if (to == HEWN_MESH_GLB)
        *out = (hewn_frame){metre, &plus_y};
    if (to == HEWN_MESH_3MF)
        out->up = &plus_z;
    return HEWN_OK;
}

const hewn_unit *hewn_frame_unit(hewn_mesh_format to, hewn_frame frame, const hewn_model *model)
{
    if (frame.unit || to != HEWN_MESH_3MF)
        return frame.unit;
    if (!model->unit)
        return hewn_unit_find("mm");
    return strcmp(model->unit->name, "km") == 0 ? hewn_unit_find("m") : NULL;
}

void hewn_frame_declare(hewn_frame frame, hewn_model *model)
{
    if (frame.unit)
        model->unit = frame.unit;
    if (frame.up) {
        model->up = *frame.up;
        model->up_known = true;
    }
}
