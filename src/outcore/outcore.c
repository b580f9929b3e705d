#include "outcore/outcore.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "outcore/assemble.h"
#include "outcore/pass.h"
#include "simplify/channels.h"
#include "simplify/desc.h"

/* A pass leaves no less than this share, since several small steps, each with other planes, come out better and sooner
 * than a large one; but with an error, which every pass takes its share of, few steps do. How full memory shall be when
 * passes end. The share of the error that is left that a pass may take. */
static const double least_share = 0.51, least_share_of_errors = 0.1, fullness = 0.85, error_share = 0.5;

/* A pass that leaves more than this share has done next to nothing; where only as few are left as may be, the second.
 */
static const double idle_share = 0.995, idle_share_of_errors = 0.9;

enum { MOST_IDLE = 2, MOST_PASSES = 24 };

typedef struct outcore_work {
    hewn_store *store;
    const hewn_simplify_desc *desc;
    uint64_t memory, capacity, target;
    double allowed;   /* a length; 0: no error is given */
    double distances; /* sum of the passes' */
    double largest, largest_low;
    double done; /* of all work, for progress */
    hewn_simplify_report *report;
    hewn_outcore_report *more;
} outcore_work;

/* --- memory ------------------------------------------------------------------------------------------------------- */

uint64_t hewn_outcore_bytes(const hewn_model *channels, uint64_t triangles)
{
    uint64_t each = 560, wedges = 0;
    for (uint32_t i = 0; i < channels->channel_count; i++) {
        const hewn_attribute_info *info = &channels->channels[i].info;
        const uint64_t size = info->components * hewn_scalar_size(info->scalar);
        if (info->domain == HEWN_DOMAIN_VERT)
            each += 40 * (uint64_t)info->components;
        else if (info->domain == HEWN_DOMAIN_FACE)
            each += 3 * size;
        else
            each += 3 * (size + 64 * (uint64_t)info->components);
        wedges |= info->domain == HEWN_DOMAIN_CORNER;
    }
    return triangles * (each + 400 * wedges);
}

uint64_t hewn_outcore_model_bytes(const hewn_model *channels, uint64_t triangles)
{
    uint64_t each = 100;
    for (uint32_t i = 0; i < channels->channel_count; i++) {
        const hewn_attribute_info *info = &channels->channels[i].info;
        const uint64_t size = info->components * hewn_scalar_size(info->scalar);
        each += 2 * size * (info->domain == HEWN_DOMAIN_CORNER ? 3 : 1);
    }
    return triangles * each;
}

/* --- passes ------------------------------------------------------------------------------------------------------- */

static void add_distance(outcore_work *work, double high, double low)
{
    work->distances += high;
    if (high > work->largest) {
        work->largest = high;
        work->largest_low = low;
    }
}

/* What is left of the error that is allowed; 0: none is given. */
static double error_left(const outcore_work *work)
{
    return work->allowed > 0 ? work->allowed - work->distances : 0;
}

/* How many triangles a pass shall leave: of what does not fit in the end either, half of the work in the first, so that
 * what lies between regions can do its part in the second. */
static uint64_t choose_aim(const outcore_work *work, bool *strictly)
{
    const double now = (double)work->store->triangles.count, target = (double)work->target;
    const double room = fullness * (double)work->capacity;
    double aim = room;
    if (target > room)
        aim = work->more->passes == 0 ? sqrt(now * target) : target;
    aim = fmax(aim, (work->allowed > 0 ? least_share_of_errors : least_share) * now);
    *strictly = target > room && aim <= target;
    return (uint64_t)aim;
}

static hewn_result run_pass(outcore_work *work, hewn_error *error)
{
    static const double shifts[] = {0, -0.2, 0.2};
    hewn_pass_report come;
    hewn_pass pass = {.store = work->store,
                      .desc = work->desc,
                      .first = work->more->passes == 0,
                      .shift = shifts[work->more->passes % 3],
                      .capacity = work->capacity,
                      .list_memory = (size_t)(work->memory / 2),
                      .error = error_share * error_left(work),
                      .began = work->done,
                      .span = 0.75 * (1 - work->done),
                      .progress = work->desc->progress};
    pass.aim = choose_aim(work, &pass.strictly);
    HEWN_TRY(hewn_pass_run(&pass, &come, error));
    if (pass.first)
        work->report->dropped_vertices = work->store->vertex_count - come.vertices;
    add_distance(work, come.distance, come.distance_low);
    work->done += pass.span;
    work->more->passes++;
    work->more->regions = come.regions > work->more->regions ? come.regions : work->more->regions;
    return HEWN_OK;
}

/* Whether there is something left that a pass can do. */
static bool may_go_on(const outcore_work *work)
{
    const bool bounded = work->allowed > 0 && work->allowed - work->distances < 0.02 * work->allowed;
    return !bounded && work->more->passes < MOST_PASSES &&
           (work->target == 0 || work->store->triangles.count > work->target);
}

static hewn_result run_passes(outcore_work *work, hewn_error *error)
{
    int idle = 0;
    while (work->store->triangles.count > work->capacity && may_go_on(work) && idle < MOST_IDLE) {
        const double before = (double)work->store->triangles.count;
        HEWN_TRY(run_pass(work, error));
        const double share = (double)work->store->triangles.count / before;
        idle = share > (work->target > 0 ? idle_share : idle_share_of_errors) ? idle + 1 : 0;
    }
    return HEWN_OK;
}

/* --- the end ------------------------------------------------------------------------------------------------------ */

typedef struct end_progress {
    const hewn_progress *caller;
    double began;
} end_progress;

static bool report_end(void *user, const char *stage, double fraction)
{
    const end_progress *end = user;
    return end->caller->report(end->caller->user, stage, end->began + (1 - end->began) * fraction);
}

static hewn_result finish_in_memory(outcore_work *work, hewn_model *model, const uint8_t *frozen, hewn_error *error)
{
    hewn_simplify_report *report = work->report, last;
    hewn_simplify_desc desc = *work->desc;
    end_progress end = {desc.progress, work->done};
    const hewn_progress progress = {report_end, &end};
    desc.progress = desc.progress && desc.progress->report ? &progress : NULL;
    desc.faces = work->target;
    desc.ratio = desc.relative_error = 0;
    desc.error = error_left(work);
    if (work->more->passes > 0) {
        desc.frozen = frozen;
        desc.lock_boundary = desc.lock_labels = false;
        desc.lock_angle = 0;
    }
    HEWN_TRY(hewn_model_simplify(model, &desc, &last, error));
    add_distance(work, last.distance, last.distance_low);
    report->runs = last.runs;
    report->locked_vertices = last.locked_vertices;
    report->unwalked_vertices = last.unwalked_vertices;
    return HEWN_OK;
}

/* As it is: there are few enough, or no pass makes them fewer. */
static hewn_result take_as_is(outcore_work *work, hewn_model *model, const uint8_t *frozen, hewn_error *error)
{
    work->report->runs = 1;
    for (uint64_t v = 0; v < model->vertex_count; v++)
        work->report->locked_vertices += frozen[v];
    return work->store->preserve & HEWN_PRESERVE_NORMAL ? HEWN_OK : hewn_simplify_renew_normals(model, error);
}

static hewn_result finish(outcore_work *work, hewn_model *out, hewn_error *error)
{
    const uint64_t count = work->store->triangles.count;
    const uint64_t needed = hewn_outcore_model_bytes(&work->store->schema, count);
    const bool few = work->target > 0 && count <= work->target;
    const bool in_memory = count <= work->capacity && (work->more->passes == 0 || (!few && may_go_on(work)));
    uint8_t *frozen;
    if (count > work->capacity && needed > work->memory)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                         "the %llu triangles that are left take about %llu bytes, and %llu are allowed for them",
                         (unsigned long long)count, (unsigned long long)needed, (unsigned long long)work->memory);
    HEWN_TRY(hewn_store_assemble(work->store, out, &frozen, error));
    if (work->more->passes == 0)
        work->report->dropped_vertices = work->store->vertex_count - out->vertex_count;
    hewn_result result = in_memory ? finish_in_memory(work, out, frozen, error) : take_as_is(work, out, frozen, error);
    hewn_free(frozen);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result find_error(outcore_work *work, hewn_error *error)
{
    const hewn_simplify_desc *desc = work->desc;
    double low[3], high[3], square = 0;
    HEWN_TRY(hewn_store_bounds(work->store, low, high, error));
    for (int axis = 0; axis < 3; axis++)
        square += (high[axis] - low[axis]) * (high[axis] - low[axis]);
    const double relative = desc->relative_error * sqrt(square);
    work->allowed = desc->error > 0 && (relative <= 0 || desc->error < relative) ? desc->error : relative;
    return HEWN_OK;
}

static hewn_result check(const outcore_work *work, hewn_error *error)
{
    hewn_simplify_desc desc = *work->desc;
    desc.lock_labels = false; /* whether there are labels shows later */
    HEWN_TRY(hewn_simplify_check(&desc, error));
    if (work->store->triangles.count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "there are no faces to simplify");
    if (desc.no_self_intersections && work->store->triangles.count > work->capacity)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "to make no self-intersections the whole mesh must be in memory, where %llu triangles do not "
                         "fit",
                         (unsigned long long)work->store->triangles.count);
    return HEWN_OK;
}

static hewn_result run(outcore_work *work, hewn_model *out, hewn_error *error)
{
    hewn_simplify_report *report = work->report;
    HEWN_TRY(check(work, error));
    HEWN_TRY(find_error(work, error));
    work->target = hewn_simplify_target(work->desc, work->store->triangles_before);
    HEWN_TRY(run_passes(work, error));
    work->more->disk_bytes =
        hewn_chains_file_bytes(&work->store->chains) + work->store->vertex_count * hewn_store_vertex_bytes(work->store);
    HEWN_TRY(finish(work, out, error));
    report->triangles_before = work->store->triangles_before;
    report->dropped_faces = work->store->dropped_faces;
    report->triangles = out->face_count;
    report->target = work->target;
    report->reached = work->target == 0 || out->face_count <= work->target;
    report->measured = work->desc->measure || work->allowed > 0;
    report->error_allowed = work->allowed;
    report->distance = work->distances;
    report->distance_low = fmax(work->largest_low - (work->distances - work->largest), 0);
    return hewn_progress_report(work->desc->progress, "simplify", 1, error);
}

hewn_result hewn_outcore_simplify(hewn_store *store, const hewn_simplify_desc *desc, uint64_t memory, hewn_model *out,
                                  hewn_simplify_report *report, hewn_outcore_report *more, hewn_error *error)
{
    const uint64_t each = hewn_outcore_bytes(&store->schema, 1);
    outcore_work work = {
        .store = store, .desc = desc, .memory = memory, .capacity = memory / each, .report = report, .more = more};
    *out = (hewn_model){0};
    *report = (hewn_simplify_report){0};
    *more = (hewn_outcore_report){0};
    const hewn_result result = run(&work, out, error);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}
