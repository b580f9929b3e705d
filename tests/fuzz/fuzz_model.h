/* What the fuzzers of model readers have in common: whatever the bytes are, reading them gives a model that is valid
 * and that everything else takes, or an error and nothing. */
#ifndef HEWN_FUZZ_MODEL_H
#define HEWN_FUZZ_MODEL_H

#include "io/formats.h"
#include "round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Every writer takes it, or says why not. */
static inline void demand_writable(const hewn_model *model)
{
    static const hewn_mesh_format formats[] = {HEWN_MESH_GLB, HEWN_MESH_OBJ, HEWN_MESH_PLY, HEWN_MESH_STL,
                                               HEWN_MESH_OFF};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        hewn_error error = {0};
        hewn_write_desc desc = {.format = formats[i], .name = "fuzz"};
        hewn_result result = hewn_model_write(model, "/dev/null", &desc, &error);
        demand(result == HEWN_OK || result == HEWN_BAD_INPUT || result == HEWN_LIMIT);
        demand(result == HEWN_OK || (error.code == result && error.message[0] != '\0'));
    }
}

/* So does repair, which makes a valid mesh of it and a valid model again. */
static inline void demand_repairable(const hewn_model *model)
{
    hewn_mesh *mesh = NULL;
    hewn_model again = {0};
    hewn_repair_desc desc = hewn_repair_desc_default();
    desc.weld = true;
    if (hewn_mesh_from_model(model, &desc, &mesh, NULL, NULL) != HEWN_OK)
        return;
    demand(hewn_mesh_validate(mesh, NULL) == HEWN_OK);
    if (hewn_model_from_mesh(mesh, &again, NULL) == HEWN_OK)
        demand(hewn_model_check(&again, NULL) == HEWN_OK);
    hewn_model_destroy(&again);
    hewn_mesh_destroy(&mesh);
}

/* Writing settles what a foreign file said in another way; from then on every bit stays. A number that is not finite
 * may be read but not written. */
static inline void demand_settled(const hewn_model *model, const char *extension)
{
    char path[64];
    hewn_model settled;
    snprintf(path, sizeof path, "/tmp/hewn-fuzz-%ld.%s", (long)getpid(), extension);
    if (hewn_model_write(model, path, NULL, NULL) != HEWN_OK)
        return;
    demand(hewn_model_read(path, NULL, &settled, NULL) == HEWN_OK);
    demand_round_trip(&settled, extension);
}

/* Reads the bytes; large models, and most others, are only checked. */
static inline void fuzz_model(hewn_format_read read, const void *data, size_t size, const char *extension)
{
    enum { LARGE = 2000 };
    const hewn_source source = {.bytes = data, .length = size, .name = "fuzz"};
    hewn_error error = {0};
    hewn_model model = {.vertex_count = 1};
    hewn_result result = read(&source, &model, &error);
    if (result != HEWN_OK) {
        demand_nothing(&model);
        demand(error.code == result && error.message[0] != '\0');
        demand(result == HEWN_BAD_INPUT || result == HEWN_LIMIT || result == HEWN_IO);
        return;
    }
    demand(hewn_model_check(&model, NULL) == HEWN_OK);
    if (model.vertex_count + hewn_model_corner_count(&model) < LARGE && is_chosen(data, size)) {
        demand_writable(&model);
        demand_repairable(&model);
        demand_settled(&model, extension);
    }
    hewn_model_destroy(&model);
}

#endif
