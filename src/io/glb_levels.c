/* GLB with levels of detail: one mesh a level, each as it would be in a file of its own. */
#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/glb_body.h"
#include "io/shim/gltf_levels.h"
#include "mesh/cut.h"

typedef struct level {
    hewn_writing job;
    uint32_t *cut;
} level;

typedef struct file {
    level *levels;
    hewn_text *documents;
    uint64_t *binaries;
    uint32_t count;
    char *name;
} file;

static hewn_result prepare_level(const hewn_model *model, const hewn_write_desc *desc, file *of, uint32_t i,
                                 hewn_error *error)
{
    level *own = &of->levels[i];
    HEWN_TRY(hewn_model_check(model, error));
    own->job = hewn_writing_of(model, desc);
    own->job.name = of->name;
    if (model->first) {
        const hewn_polygons polygons = hewn_model_polygons(model);
        HEWN_TRY(hewn_cut_polygons(&polygons, &own->cut, &own->job.triangle_count, desc->progress, error));
        own->job.cut = own->cut;
    }
    HEWN_TRY(hewn_glb_writer.fits(&own->job, error));
    HEWN_TRY(hewn_writing_check(&own->job, error));
    return hewn_glb_compose(&own->job, &of->documents[i], &of->binaries[i], error);
}

static hewn_result write_all(const file *of, const hewn_text *json, const char *path, hewn_error *error)
{
    char *head = NULL;
    size_t length = 0;
    uint64_t bytes = 0;
    hewn_output *output = NULL;
    for (uint32_t i = 0; i < of->count; i++)
        bytes += of->binaries[i];
    hewn_result result = hewn_glb_head(json, bytes, &head, &length, error);
    if (result == HEWN_OK)
        result = hewn_output_create(path, &output, error);
    if (result == HEWN_OK)
        result = hewn_output_write(output, head, length, error);
    for (uint32_t i = 0; result == HEWN_OK && i < of->count; i++)
        result = hewn_glb_write_body(&of->levels[i].job, output, error);
    if (result == HEWN_OK)
        result = hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    hewn_free(head);
    return result;
}

static hewn_result run(const hewn_model *const *models, const double *coverages, const char *path,
                       const hewn_write_desc *desc, file *of, hewn_error *error)
{
    hewn_text json = {0};
    of->levels = hewn_alloc_zero(of->count, sizeof *of->levels);
    of->documents = hewn_alloc_zero(of->count, sizeof *of->documents);
    of->binaries = hewn_alloc_zero(of->count, sizeof *of->binaries);
    of->name = hewn_object_name(desc->name, path);
    if (!of->levels || !of->documents || !of->binaries || !of->name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    for (uint32_t i = 0; i < of->count; i++)
        HEWN_TRY(prepare_level(models[i], desc, of, i, error));
    hewn_result result = hewn_gltf_join_levels(of->documents, of->binaries, coverages, of->count, &json, error);
    if (result == HEWN_OK)
        result = write_all(of, &json, path, error);
    hewn_text_clear(&json);
    return result;
}

hewn_result hewn_levels_write_glb(const hewn_model *const *levels, const double *coverages, uint32_t count,
                                  const char *path, const hewn_write_desc *desc, hewn_error *error)
{
    static const hewn_write_desc defaults;
    file of = {.count = count};
    if (count == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file of levels needs one");
    hewn_result result = run(levels, coverages, path, desc ? desc : &defaults, &of, error);
    for (uint32_t i = 0; i < count; i++) {
        if (of.levels) {
            hewn_glb_writer.release(&of.levels[i].job);
            hewn_free(of.levels[i].cut);
        }
        if (of.documents)
            hewn_text_clear(&of.documents[i]);
    }
    hewn_free(of.levels);
    hewn_free(of.documents);
    hewn_free(of.binaries);
    hewn_free(of.name);
    return result;
}
