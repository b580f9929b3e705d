#include "pipeline/mesh_parts.h"

#include <pthread.h>

#include "base/clock.h"
#include "base/error.h"

/* Pages are let go every so many looks at the callback. */
enum { CALLS = 16 };

/* A part on its way to disk. */
typedef struct storing {
    hewn_mesh_parts *parts;
    const hewn_mesh_part *part;
    hewn_result result;
    hewn_error error;
} storing;

static void begin_span(hewn_parts_span *span)
{
    span->begin = span->begin > 0 ? span->begin : hewn_clock_now();
}

static void *store(void *user)
{
    storing *job = user;
    hewn_mesh_parts *parts = job->parts;
    begin_span(&parts->stored);
    job->result = hewn_spool_take(parts->spool, job->part, &job->error);
    parts->stored.end = hewn_clock_now();
    return NULL;
}

static hewn_result certify(hewn_mesh_parts *parts, const hewn_mesh_part *part, hewn_error *error)
{
    begin_span(&parts->certified);
    hewn_result result = hewn_certifier_take(parts->certifier, part, error);
    parts->certified.end = hewn_clock_now();
    return result;
}

/* Storing waits for the disk and certifying for memory: neither takes memory of the other's. */
static hewn_result take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    storing job = {.parts = user, .part = part};
    pthread_t thread;
    bool threaded = pthread_create(&thread, NULL, store, &job) == 0;
    hewn_result result = certify(job.parts, part, error);
    if (threaded)
        pthread_join(thread, NULL);
    else
        store(&job);
    if (result == HEWN_OK && job.result != HEWN_OK && error)
        *error = job.error;
    return result == HEWN_OK ? job.result : result;
}

static uint64_t bytes(void *user, const hewn_mesh_part *part)
{
    const hewn_mesh_parts *parts = user;
    return hewn_certifier_bytes(parts->certifier, part);
}

static hewn_result begin(hewn_mesh_parts *parts, const char *output, hewn_error *error)
{
    HEWN_TRY(hewn_spool_create(output, &parts->spool, error));
    return hewn_certifier_create(&parts->certifier, error);
}

static hewn_result finish(hewn_mesh_parts *parts, uint64_t vertices, uint64_t triangles, hewn_certificate *certificate,
                          hewn_error *error)
{
    HEWN_TRY(hewn_certifier_finish(parts->certifier, certificate, error));
    hewn_certifier_destroy(&parts->certifier);
    return hewn_spool_view(parts->spool, vertices, triangles, &parts->triangles, error);
}

hewn_result hewn_mesh_parts_make(hewn_mesh_parts *parts, hewn_extractor *extractor, const hewn_extract_desc *desc,
                                 const char *output, hewn_extract_stats *stats, hewn_certificate *certificate,
                                 hewn_error *error)
{
    const hewn_mesh_sink sink = {.user = parts, .take = take, .bytes = bytes};
    HEWN_TRY(begin(parts, output, error));
    HEWN_TRY(hewn_extract_parts(extractor, desc, &sink, stats, error));
    HEWN_TRY(finish(parts, stats->vertices, stats->triangles, certificate, error));
    parts->triangles.paired = hewn_method_is_dual(stats->method) && stats->fans == 0;
    return HEWN_OK;
}

hewn_result hewn_mesh_parts_of_volume(hewn_mesh_parts *parts, const hewn_volume *volume,
                                      const hewn_volume_extract_desc *desc, const char *output,
                                      hewn_volume_extract_stats *stats, hewn_certificate *certificate,
                                      hewn_error *error)
{
    const hewn_mesh_sink sink = {.user = parts, .take = take, .bytes = bytes};
    HEWN_TRY(begin(parts, output, error));
    HEWN_TRY(hewn_volume_extract_parts(volume, desc, &sink, stats, error));
    return finish(parts, stats->vertices, stats->triangles, certificate, error);
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
