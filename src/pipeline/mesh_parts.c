#include "pipeline/mesh_parts.h"

#include "base/error.h"

/* Pages are let go every so many looks at the callback. */
enum { CALLS = 16 };

static hewn_result take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    hewn_mesh_parts *parts = user;
    HEWN_TRY(hewn_certifier_take(parts->certifier, part, error));
    return hewn_spool_take(parts->spool, part, error);
}

static uint64_t bytes(void *user, const hewn_mesh_part *part)
{
    const hewn_mesh_parts *parts = user;
    return hewn_certifier_bytes(parts->certifier, part);
}

hewn_result hewn_mesh_parts_make(hewn_mesh_parts *parts, hewn_extractor *extractor, const hewn_extract_desc *desc,
                                 const char *output, hewn_extract_stats *stats, hewn_certificate *certificate,
                                 hewn_error *error)
{
    const hewn_mesh_sink sink = {.user = parts, .take = take, .bytes = bytes};
    HEWN_TRY(hewn_spool_create(output, &parts->spool, error));
    HEWN_TRY(hewn_certifier_create(&parts->certifier, error));
    HEWN_TRY(hewn_extract_parts(extractor, desc, &sink, stats, error));
    HEWN_TRY(hewn_certifier_finish(parts->certifier, certificate, error));
    hewn_certifier_destroy(&parts->certifier);
    HEWN_TRY(hewn_spool_view(parts->spool, stats->vertices, stats->triangles, &parts->triangles, error));
    parts->triangles.paired = hewn_method_is_dual(stats->method) && stats->fans == 0;
    return HEWN_OK;
}

void hewn_mesh_parts_clear(hewn_mesh_parts *parts)
{
    hewn_certifier_destroy(&parts->certifier);
    hewn_spool_destroy(&parts->spool);
    *parts = (hewn_mesh_parts){0};
}

static bool report(void *user, const char *stage, double fraction)
{
    hewn_mesh_parts *parts = user;
    if (++parts->calls % CALLS == 0)
        hewn_spool_relax(parts->spool);
    return !parts->caller || !parts->caller->report || parts->caller->report(parts->caller->user, stage, fraction);
}

const hewn_progress *hewn_mesh_parts_progress(hewn_mesh_parts *parts, const hewn_progress *caller)
{
    parts->caller = caller;
    parts->progress = (hewn_progress){.report = report, .user = parts};
    return &parts->progress;
}
