#include "pipeline/kept.h"

#include "base/alloc.h"
#include "base/error.h"

hewn_result hewn_mesh_kept_create(hewn_mesh_kept **out, hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    return *out ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for what jobs keep");
}

void hewn_mesh_kept_destroy(hewn_mesh_kept **kept)
{
    if (!*kept)
        return;
    hewn_mesh_kept_close(*kept);
    hewn_free(*kept);
    *kept = NULL;
}

void hewn_mesh_kept_open(hewn_mesh_kept *kept, const char *choice, bool validation)
{
    if (!kept->opening.device)
        hewn_opening_begin(&kept->opening, choice, validation);
}

hewn_result hewn_mesh_kept_compile(hewn_mesh_kept *kept, hewn_device *device, const hewn_field *field,
                                   hewn_error *error)
{
    const hewn_node root = hewn_field_root(field);
    bool taken = false;
    if (kept->extractor)
        HEWN_TRY(hewn_extractor_renumber(kept->extractor, field, root, &taken, error));
    if (taken)
        return HEWN_OK;
    hewn_extractor_destroy(&kept->extractor);
    return hewn_extractor_create(device, field, root, &kept->extractor, error);
}

void hewn_mesh_kept_close(hewn_mesh_kept *kept)
{
    hewn_extractor_destroy(&kept->extractor);
    hewn_opening_close(&kept->opening);
}
