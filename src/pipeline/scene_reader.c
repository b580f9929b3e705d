/* Files that scenes sample. */
#include <string.h>

#include "base/error.h"
#include "hewn/heights.h"
#include "hewn/voxelize_job.h"
#include "pipeline/mesh_samples.h"

static hewn_result read_mesh(const char *path, const hewn_scene_mesh *how, hewn_sampling **out,
                             hewn_sampling_place *place, hewn_scene_sampled *told, hewn_error *error)
{
    hewn_model model = {0};
    const hewn_mesh_sampling_desc desc = {
        .cell = how->cell, .band = how->band, .dense = how->dense, .memory_limit = how->memory_limit};
    hewn_mesh_sampling_report report = {0};
    HEWN_TRY(hewn_model_read(path, &(hewn_read_desc){0}, &model, error));
    hewn_result result = hewn_mesh_samples(&model, &desc, out, place, &report, error);
    hewn_model_destroy(&model);
    told->cell = place->cell;
    told->confidence = report.confidence;
    told->doubtful = report.doubtful;
    return result;
}

static hewn_result read_heights(const char *path, const hewn_scene_heights *how, hewn_sampling **out, hewn_error *error)
{
    hewn_raw_desc raw = {.dims = {how->columns, how->rows, 1},
                         .type = HEWN_VOXEL_UINT16,
                         .big_endian = how->big_endian,
                         .offset = how->offset};
    if (how->type && !hewn_voxel_find(how->type, &raw.type))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "there is no type '%s' of values; there are int8 to uint64, "
                         "half, float, double",
                         how->type);
    hewn_heightmap map;
    HEWN_TRY(hewn_heightmap_read(path, &raw, &map, error));
    hewn_result result = HEWN_OK;
    bool differs = how->columns > 0 && (how->columns != map.columns || how->rows != map.rows);
    if (differs)
        result = hewn_fail(error, HEWN_BAD_INPUT, "it has %u x %u values, not %u x %u as dims says", map.columns,
                           map.rows, how->columns, how->rows);
    else
        result = hewn_sampling_from_heights(map.values, map.columns, map.rows, out, error);
    hewn_heightmap_destroy(&map);
    return result;
}

const hewn_scene_reader *hewn_scene_reader_standard(void)
{
    static const hewn_scene_reader standard = {.mesh = read_mesh, .heights = read_heights};
    return &standard;
}
