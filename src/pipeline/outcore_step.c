#include "pipeline/outcore_step.h"

#include <malloc.h>
#include <string.h>
#include <sys/stat.h>

#include "base/error.h"
#include "io/parts.h"
#include "outcore/facets.h"
#include "outcore/outcore.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"

/* Bytes: of code, stacks and small things that are not there yet when a job begins; steps in which the program's own
 * are counted, so that the same limit always leaves the same; and the least that is of use. */
enum { PROGRAM_MORE = 8 << 20, PROGRAM_STEP = 24 << 20, LEAST = 8 << 20 };

/* How many times its bytes a file may take while it is read whole: numbers as text can be short. */
enum { TIMES_BINARY = 6, TIMES_OTHERS = 10 };

typedef struct outcore_job {
    const hewn_file_job_desc *desc;
    hewn_file_report *report;
    hewn_outcore_budget budget;
    hewn_store store;
    hewn_facets facets; /* on the way there, where a format shares no vertices */
    uint64_t pages;     /* bytes of the store's */
} outcore_job;

hewn_result hewn_outcore_budget_make(uint64_t limit, hewn_outcore_budget *out, hewn_error *error)
{
    const uint64_t now = hewn_host_bytes() + PROGRAM_MORE, program = (now / PROGRAM_STEP + 1) * PROGRAM_STEP;
    *out = (hewn_outcore_budget){limit, program, limit > program ? limit - program : 0};
    if (out->left >= LEAST)
        return HEWN_OK;
    return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                     "a limit of %llu bytes is too small: the program itself takes about %llu, and parts of a mesh at "
                     "least %d more",
                     (unsigned long long)limit, (unsigned long long)program, LEAST);
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

/* Where the size is not known, as of standard input, it is taken for large. Of what is not there the reader tells. */
static bool may_read_whole(const outcore_job *job)
{
    struct stat status;
    const hewn_mesh_format format = job->report->from;
    const bool binary = format == HEWN_MESH_PLY || format == HEWN_MESH_STL;
    const uint64_t most = job->budget.left / (binary ? TIMES_BINARY : TIMES_OTHERS);
    if (strcmp(job->desc->input, "-") == 0)
        return false;
    return stat(job->desc->input, &status) != 0 || (S_ISREG(status.st_mode) && (uint64_t)status.st_size <= most);
}

static void begin_store(outcore_job *job)
{
    const hewn_simplify_desc *desc = job->desc->simplify;
    job->pages = job->budget.left / 8;
    hewn_store_begin(job->desc->output, desc->preserve ? desc->preserve : HEWN_PRESERVE_USUAL, (size_t)job->pages,
                     &job->store);
}

static hewn_result take(void *user, hewn_model *part, hewn_error *error)
{
    outcore_job *job = user;
    return hewn_mesh_format_welds(job->report->from) ? hewn_facets_add(&job->facets, part, error)
                                                     : hewn_store_add(&job->store, part, error);
}

static uint64_t count_triangles(const hewn_model *model)
{
    return hewn_model_corner_count(model) - 2 * model->face_count;
}

/* `*fits`: the model is in `out`, and can be simplified there; else it is in the store. */
static hewn_result read_whole(outcore_job *job, hewn_model *out, bool *fits, hewn_error *error)
{
    const hewn_read_desc read = {
        .format = job->report->from, .memory_limit = job->budget.left / TIMES_OTHERS, .progress = job->desc->progress};
    const hewn_result read_result = hewn_model_read(job->desc->input, &read, out, error);
    if (read_result != HEWN_OK)
        return hewn_blame_input(read_result, job->desc->input, error);
    *fits = hewn_outcore_bytes(out, count_triangles(out)) <= job->budget.left;
    if (*fits)
        return HEWN_OK;
    begin_store(job);
    const hewn_result result = hewn_store_add(&job->store, out, error);
    job->store.schema.unit = out->unit;
    job->store.schema.up = out->up;
    job->store.schema.up_known = out->up_known;
    hewn_model_destroy(out);
    malloc_trim(0);
    return result;
}

static hewn_result read_parts(outcore_job *job, hewn_error *error)
{
    const hewn_file_job_desc *desc = job->desc;
    const hewn_read_desc read = {.format = job->report->from, .progress = desc->progress};
    const uint32_t preserve = desc->simplify->preserve ? desc->simplify->preserve : HEWN_PRESERVE_USUAL;
    const hewn_part_taker taker = {.take = take,
                                   .user = job,
                                   .memory = job->budget.left / 2,
                                   .no_uvs = !(preserve & HEWN_PRESERVE_UV),
                                   .no_normals = !(preserve & HEWN_PRESERVE_NORMAL)};
    hewn_model about;
    if (!hewn_mesh_format_has_parts(job->report->from) || strcmp(desc->input, "-") == 0)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                         "the file does not fit in the %llu bytes that are left of the limit; only .ply, .stl and "
                         ".obj files that are not compressed, and not standard input, can be read in parts",
                         (unsigned long long)job->budget.left);
    begin_store(job);
    hewn_facets_begin(desc->output, &job->facets);
    HEWN_TRY(hewn_model_read_parts(desc->input, &read, &taker, &about, error));
    HEWN_TRY(hewn_facets_weld(&job->facets, job->budget.left - job->pages, &job->store, error));
    hewn_facets_free(&job->facets);
    malloc_trim(0);
    job->store.schema.unit = about.unit;
    job->store.schema.up = about.up;
    job->store.schema.up_known = about.up_known;
    return HEWN_OK;
}

static hewn_result load(outcore_job *job, hewn_model *out, bool *fits, hewn_error *error)
{
    *fits = false;
    HEWN_TRY(may_read_whole(job) ? read_whole(job, out, fits, error) : read_parts(job, error));
    if (!*fits)
        HEWN_TRY(hewn_store_finish(&job->store, error));
    job->report->vertices_before = *fits ? out->vertex_count : job->store.vertex_count;
    job->report->faces_before = *fits ? out->face_count : job->store.faces_before;
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(outcore_job *job, hewn_stages *stages, hewn_model *out, bool *done, hewn_error *error)
{
    bool fits;
    hewn_outcore_report more;
    HEWN_TRY(hewn_outcore_budget_make(job->desc->max_memory, &job->budget, error));
    hewn_stage_begin(stages);
    HEWN_TRY(load(job, out, &fits, error));
    hewn_stage_end(stages, "load");
    if (fits)
        return HEWN_OK;
    hewn_stage_begin(stages);
    hewn_simplify_desc desc = *job->desc->simplify;
    desc.labels = NULL;
    desc.frozen = NULL;
    desc.progress = job->desc->progress;
    HEWN_TRY(hewn_outcore_simplify(&job->store, &desc, job->budget.left - job->pages, out, &job->report->simplify,
                                   &more, error));
    hewn_stage_end(stages, "simplify");
    job->report->simplified = true;
    job->report->passes = more.passes;
    job->report->parts = more.regions;
    job->report->disk_bytes = more.disk_bytes;
    *done = true;
    return HEWN_OK;
}

hewn_result hewn_outcore_step(const hewn_file_job_desc *desc, hewn_file_report *report, hewn_stages *stages,
                              hewn_model *out, bool *done, hewn_error *error)
{
    outcore_job job = {.desc = desc, .report = report};
    *out = (hewn_model){0};
    *done = false;
    hewn_result result = run(&job, stages, out, done, error);
    hewn_store_free(&job.store);
    hewn_facets_free(&job.facets);
    malloc_trim(0);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result == HEWN_BAD_INPUT ? hewn_blame_input(result, desc->input, error) : result;
}
