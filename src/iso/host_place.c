#include "iso/host_place.h"

#include <omp.h>
#include <pthread.h>

#include "base/error.h"
#include "gpu/device.h"
#include "iso/host_search.h"

/* Vertices that a thread places together: so few that what is known of them stays in a processor's cache, and so many
 * that few dispatches do. All threads together have no more than the last of these, unless there are very many. */
enum { BLOCK = 16384, LEAST_BLOCK = 8, TOGETHER = 65536, LEAST_SHARE = 1024 };

/* A vertex that is farther than this off a surface that is not smooth there has lost something. */
static const float LOST = 0.05f, UNSEEN = 3.0e38f;

/* A vertex on the way to its place. */
typedef struct work {
    hewn_search search;
    vec along; /* sum of the crossings' normals */
    float count;
    bool capped;
    uint32_t slot;
    uint32_t question; /* number of its first one */
} work;

typedef struct question {
    float place[3];
    uint32_t slot;
} question;

_Static_assert(sizeof(question) == sizeof(vec), "questions and answers begin at the same places");

/* What the threads share. Each places a block by itself, and they ask the device by turns: so while it answers one of
 * them, others have work. Waiting in turns for all of a team would keep its threads busy with waiting. */
typedef struct crew {
    const hewn_placing *placing;
    uint64_t own_end; /* vertices before this one count */
    uint32_t threads, block;
    work *works; /* of all, and so on */
    uint32_t *active, *counts;
    const hewn_buffer *questions, *answers;
    pthread_mutex_t turn; /* for the device and for what follows */
    hewn_result result;
    hewn_error *error;
} crew;

/* One thread's share. */
typedef struct placement {
    crew *crew;
    const hewn_placing *placing;
    uint64_t first; /* of the block */
    uint32_t count;
    work *works;
    uint32_t *active, *counts; /* works that go on, and how many questions each has */
    uint32_t active_count;
    uint64_t question_bytes; /* where its questions and answers begin */
} placement;

static const struct hewn_grid *grid_of(const placement *run)
{
    return &run->placing->dual->grid;
}

/* --- a vertex ----------------------------------------------------------------------------------------------------- */

/* Whether a crossing is where the surface was cut at the bounds. */
static bool is_cap(const struct hewn_grid *grid, const float *point, uint32_t axis)
{
    return grid->open == 0 && (point[axis] == grid->origin[axis] || point[axis] == grid->far[axis]);
}

static void begin_vertex(const placement *run, uint32_t i)
{
    const hewn_host_dual *dual = run->placing->dual;
    const uint32_t *record = (const uint32_t *)dual->positions + 3 * (run->first + i);
    const uint32_t at[3] = {record[1] & 7, record[1] >> 3 & 7, record[1] >> 6 & 7};
    work *own = &run->works[i];
    own->slot = record[0];
    own->search.cell = hewn_host_cell_of(&dual->grid, dual->bricks.bricks[own->slot], at);
    own->along = (vec){0};
    own->count = 0;
    own->capped = false;
    hewn_qef_begin(&own->search.qef);
    for (uint32_t rest = record[1] >> 9; rest != 0; rest &= rest - 1) {
        uint32_t edge = (uint32_t)__builtin_ctz(rest);
        uint64_t crossing = hewn_host_dual_crossing(&dual->bricks, own->slot, at, edge);
        const float *point = dual->points + 3 * crossing;
        vec normal = vec_load(run->placing->point_normals + 3 * crossing);
        hewn_qef_add_crossing(&own->search.qef, hewn_host_into_cell(&dual->grid, &own->search.cell, vec_load(point)),
                              normal);
        own->capped = own->capped || is_cap(&dual->grid, point, edge >> 2);
        own->along += normal;
        own->count += 1;
    }
    if (run->placing->method == HEWN_METHOD_NETS)
        hewn_search_begin_at_mean(&own->search);
    else
        hewn_search_begin(&own->search, record[2] == 1, own->along / most(length3(own->along), 1.0e-6f));
}

/* A vertex's normal: that of the surface there where its crossings' normals agree within about 37 degrees, and so are
 * those of one smooth piece; else their mean. */
static vec normal_of(const work *own)
{
    vec seen = own->search.seen;
    float usual = length3(own->along);
    bool smooth = (seen[0] != 0 || seen[1] != 0 || seen[2] != 0) && usual > 0.8f * own->count;
    return smooth ? seen : usual > 0 ? own->along / usual : vec3(0, 0, 1);
}

static void write_vertex(const placement *run, uint32_t i)
{
    const work *own = &run->works[i];
    vec place = hewn_host_out_of_cell(grid_of(run), &own->search.cell, own->search.at), normal = normal_of(own);
    for (int k = 0; k < 3; k++) {
        run->placing->dual->positions[3 * (run->first + i) + (uint64_t)k] = place[k];
        run->placing->normals[3 * (run->first + i) + (uint64_t)k] = normal[k];
    }
}

/* --- rounds of questions ------------------------------------------------------------------------------------------ */

/* What a block's searches ask next; those that ask nothing more leave. Returns how many questions there are. */
static uint32_t prepare_questions(placement *run)
{
    uint32_t total = 0, kept = 0;
    for (uint32_t k = 0; k < run->active_count; k++)
        run->counts[k] = hewn_search_next(&run->works[run->active[k]].search);
    for (uint32_t k = 0; k < run->active_count; k++) {
        if (run->counts[k] == 0)
            continue;
        run->active[kept] = run->active[k];
        run->works[run->active[kept++]].question = total;
        total += run->counts[k];
    }
    run->active_count = kept;
    return total;
}

static void write_questions(const placement *run)
{
    for (uint32_t k = 0; k < run->active_count; k++) {
        const work *own = &run->works[run->active[k]];
        question *out = (question *)((char *)run->crew->questions->mapped + run->question_bytes) + own->question;
        vec asked[HEWN_SEARCH_QUESTIONS];
        uint32_t count = hewn_search_ask(&own->search, asked);
        for (uint32_t i = 0; i < count; i++) {
            vec place = hewn_host_out_of_cell(grid_of(run), &own->search.cell, asked[i]);
            out[i] = (question){{place[0], place[1], place[2]}, own->slot};
        }
    }
}

static void take_answers(const placement *run)
{
    for (uint32_t k = 0; k < run->active_count; k++) {
        work *own = &run->works[run->active[k]];
        hewn_search_take(&own->search, grid_of(run),
                         (const vec *)((const char *)run->crew->answers->mapped + run->question_bytes) + own->question);
    }
}

static hewn_result dispatch(const placement *run, uint32_t questions, hewn_error *error)
{
    const hewn_placing *placing = run->placing;
    const hewn_extractor *extractor = placing->extractor;
    const struct hewn_dual_asked_push push = {.grid = placing->dual->grid,
                                              .count = questions,
                                              .beyond = placing->bricks->beyond,
                                              .bricks = placing->bricks->list->address,
                                              .questions = run->crew->questions->address + run->question_bytes,
                                              .answers = run->crew->answers->address + run->question_bytes,
                                              .summary = placing->summary};
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    hewn_commands_dispatch(commands, extractor->dual.asked, &push, hewn_code_uniforms(extractor->code),
                           hewn_groups_for(questions, 64));
    return hewn_commands_submit(&commands, NULL, error);
}

/* The first failure is everybody's. */
static bool ask_device(const placement *run, uint32_t questions)
{
    crew *all = run->crew;
    pthread_mutex_lock(&all->turn);
    if (all->result == HEWN_OK)
        all->result = dispatch(run, questions, all->error);
    bool answered = all->result == HEWN_OK;
    pthread_mutex_unlock(&all->turn);
    return answered;
}

/* --- blocks ------------------------------------------------------------------------------------------------------- */

static void begin_block(placement *run, uint64_t first, uint64_t end)
{
    run->first = first;
    run->count = run->active_count = (uint32_t)(end - first);
    for (uint32_t i = 0; i < run->count; i++) {
        run->active[i] = i;
        begin_vertex(run, i);
    }
}

static void end_block(const placement *run, hewn_emission *sums)
{
    for (uint32_t i = 0; i < run->count; i++) {
        const work *own = &run->works[i];
        const hewn_search *search = &own->search;
        float off = fabsf(search->seen[3]);
        bool feature = search->rank >= 2 && search->sharp && off <= LOST;
        bool rough = length3(own->along) <= 0.8f * own->count;
        write_vertex(run, i);
        if (run->first + i >= run->crew->own_end)
            continue;
        sums->caps += own->capped;
        sums->max_residual = !own->capped && off <= UNSEEN ? most(sums->max_residual, off) : sums->max_residual;
        sums->edge_vertices += feature && search->rank == 2;
        sums->corner_vertices += feature && search->rank == 3;
        sums->planes_found += search->found;
        sums->features_lost +=
            search->missed || (run->placing->method == HEWN_METHOD_DC && off > LOST && off <= UNSEEN && rough);
    }
}

static void place_block(placement *run, uint64_t first, uint64_t end, hewn_emission *sums)
{
    begin_block(run, first, end);
    for (uint32_t questions; (questions = prepare_questions(run)) > 0;) {
        write_questions(run);
        if (!ask_device(run, questions))
            return;
        take_answers(run);
    }
    end_block(run, sums);
}

/* --- all of them -------------------------------------------------------------------------------------------------- */

static uint64_t questions_each(const crew *all)
{
    return all->placing->method == HEWN_METHOD_NETS ? 1 : HEWN_SEARCH_QUESTIONS;
}

/* Where memory is limited, an eighth of what is left will do. */
static void choose_blocks(crew *all, uint64_t vertices)
{
    const hewn_device *device = all->placing->extractor->device;
    uint64_t each = sizeof(work) + 2 * sizeof(uint32_t) + questions_each(all) * (sizeof(question) + sizeof(vec));
    uint64_t left = device->most_bytes > device->bytes ? device->most_bytes - device->bytes : 0;
    uint64_t together = device->most_bytes > 0 && left / 8 / each < TOGETHER ? left / 8 / each : TOGETHER;
    uint64_t threads = (uint64_t)omp_get_max_threads();
    threads = together / LEAST_SHARE < threads ? together / LEAST_SHARE : threads;
    threads = vertices / LEAST_SHARE < threads ? vertices / LEAST_SHARE : threads;
    threads = threads > 0 ? threads : 1;
    uint64_t block = together / threads < BLOCK ? together / threads : BLOCK;
    uint64_t share = (vertices + threads - 1) / threads;
    block = block > LEAST_BLOCK ? block : LEAST_BLOCK;
    all->threads = (uint32_t)threads;
    all->block = (uint32_t)(share < block ? share : block);
}

static hewn_result take_memory(crew *all, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t count = (uint64_t)all->threads * all->block, most = count * questions_each(all);
    hewn_buffer *works, *active, *counts, *questions, *answers;
    HEWN_TRY(hewn_workspace_take(workspace, "searches for vertices", count * sizeof(work), HEWN_BUFFER_UPLOAD, &works,
                                 error));
    HEWN_TRY(hewn_workspace_take(workspace, "searches that go on", 4 * count, HEWN_BUFFER_UPLOAD, &active, error));
    HEWN_TRY(hewn_workspace_take(workspace, "questions a search", 4 * count, HEWN_BUFFER_UPLOAD, &counts, error));
    HEWN_TRY(
        hewn_workspace_take(workspace, "questions", most * sizeof(question), HEWN_BUFFER_UPLOAD, &questions, error));
    HEWN_TRY(hewn_workspace_take(workspace, "answers", most * sizeof(vec), HEWN_BUFFER_READBACK, &answers, error));
    all->works = works->mapped;
    all->active = active->mapped;
    all->counts = counts->mapped;
    all->questions = questions;
    all->answers = answers;
    return HEWN_OK;
}

static placement share_of(crew *all, uint32_t thread)
{
    uint64_t before = (uint64_t)thread * all->block;
    return (placement){.crew = all,
                       .placing = all->placing,
                       .works = all->works + before,
                       .active = all->active + before,
                       .counts = all->counts + before,
                       .question_bytes = before * questions_each(all) * sizeof(question)};
}

static void add(hewn_emission *to, const hewn_emission *from)
{
    to->caps += from->caps;
    to->edge_vertices += from->edge_vertices;
    to->corner_vertices += from->corner_vertices;
    to->planes_found += from->planes_found;
    to->features_lost += from->features_lost;
    to->max_residual = most(to->max_residual, from->max_residual);
}

static void place_all(crew *all, uint64_t first, uint64_t end, hewn_emission *sums)
{
    uint64_t blocks = (end - first + all->block - 1) / all->block;
#pragma omp parallel num_threads((int)all->threads)
    {
        placement run = share_of(all, (uint32_t)omp_get_thread_num());
        hewn_emission own = {0};
#pragma omp for schedule(dynamic, 1)
        for (uint64_t i = 0; i < blocks; i++) {
            uint64_t begin = first + i * all->block;
            place_block(&run, begin, end - begin < all->block ? end : begin + all->block, &own);
        }
        pthread_mutex_lock(&all->turn);
        add(sums, &own);
        pthread_mutex_unlock(&all->turn);
    }
}

hewn_result hewn_host_place(const hewn_placing *placing, const uint64_t own[2], uint64_t end, hewn_workspace *workspace,
                            hewn_emission *sums, hewn_error *error)
{
    crew all = {.placing = placing, .own_end = own[1], .error = error};
    if (own[0] == end)
        return HEWN_OK;
    choose_blocks(&all, end - own[0]);
    HEWN_TRY(take_memory(&all, workspace, error));
    if (pthread_mutex_init(&all.turn, NULL) != 0)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a lock");
    place_all(&all, own[0], end, sums);
    pthread_mutex_destroy(&all.turn);
    return all.result;
}
