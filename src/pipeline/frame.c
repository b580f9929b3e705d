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

hewn_result hewn_frame_check_space(hewn_mesh_format to, hewn_space space, const hewn_unit *unit, hewn_error *error)
{
    if (to == HEWN_MESH_GLB && space != HEWN_SPACE_DEFAULT && space != HEWN_SPACE_GLTF)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "GLB files are always in glTF's space, not in %s; .stl, .obj, .ply, .off and .3mf can be",
                         hewn_space_name(space) ? hewn_space_name(space) : "another");
    if (to == HEWN_MESH_GLB && unit && unit != hewn_unit_find("m"))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "GLB is always in metres, not in %s", unit->name);
    if (space == HEWN_SPACE_VOXEL && unit)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "in the space of voxels lengths are voxels, not %s", unit->name);
    if (to == HEWN_MESH_3MF && unit && strcmp(unit->name, "km") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "3MF cannot be in km");
    return HEWN_OK;
}

hewn_space hewn_frame_choose_space(hewn_mesh_format to, hewn_space wanted, const hewn_volume *volume)
{
    if (wanted != HEWN_SPACE_DEFAULT)
        return wanted;
    return to == HEWN_MESH_GLB ? HEWN_SPACE_GLTF : volume->anatomical ? HEWN_SPACE_RAS : HEWN_SPACE_WORLD;
}

const char *hewn_frame_space_tag(hewn_space space, bool anatomical)
{
    if (space == HEWN_SPACE_RAS)
        return "RAS";
    if (space == HEWN_SPACE_LPS)
        return "LPS";
    return space == HEWN_SPACE_GLTF && anatomical ? "x left, y head, z front" : NULL;
}
