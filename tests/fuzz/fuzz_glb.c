/* GLB and glTF from memory: whatever the bytes are, reading them gives a valid model, or an error and nothing. Written
 * as GLB it may lose what glTF cannot hold, but from then on it stays the same, bit for bit. */
#include "io/formats.h"
#include "round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Positions that GLB's floats cannot hold are the one reason not to write a model. */
static bool write_and_read(const hewn_model *model, hewn_model *again)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/hewn-fuzz-%ld-first.glb", (long)getpid());
    hewn_result result = hewn_model_write(model, path, NULL, NULL);
    demand(result == HEWN_OK || result == HEWN_LIMIT);
    if (result != HEWN_OK)
        return false;
    demand(hewn_model_read(path, NULL, again, NULL) == HEWN_OK);
    demand(unlink(path) == 0);
    demand(model->face_count == again->face_count);
    demand(model->face_count == 0 || model->vertex_count == again->vertex_count);
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const hewn_source source = {
        .bytes = (const char *)data, .length = size, .name = "fuzz", .base_colors = size % 2 == 1};
    hewn_model model, again;
    if (hewn_gltf_read(&source, &model, NULL) == HEWN_OK) {
        demand(hewn_model_check(&model, NULL) == HEWN_OK);
        if (is_chosen(data, size) && write_and_read(&model, &again))
            demand_round_trip(&again, "glb");
        hewn_model_destroy(&model);
    }
    demand_nothing(&model);
    return 0;
}
