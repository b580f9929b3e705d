#include "iso/host_place.h"

#include "base/error.h"
#include "gpu/device.h"
#include "iso/host_search.h"

/* Vertices that are placed together: so few that what is known of them stays in a processor's cache, and so many that
 * few dispatches do. Below the other number it does not pay to wake other threads. */
enum { BLOCK = 16384, LEAST_BLOCK = 8, ALONE = 256 };

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

typedef struct placement {
    const hewn_placing *placing;
    uint64_t first;        /* of the block */
    uint32_t count, block; /* how many it has, and at most */
    work *works;
    uint32_t *active, *counts; /* works that go on, and how many questions each has */
    uint32_t active_count;
    const hewn_buffer *questions, *answers;
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
#pragma omp parallel for schedule(static) if (run->active_count >= ALONE)
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
#pragma omp parallel for schedule(static) if (run->active_count >= ALONE)
    for (uint32_t k = 0; k < run->active_count; k++) {
        const work *own = &run->works[run->active[k]];
        question *out = (question *)run->questions->mapped + own->question;
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
#pragma omp parallel for schedule(static) if (run->active_count >= ALONE)
    for (uint32_t k = 0; k < run->active_count; k++) {
        work *own = &run->works[run->active[k]];
        hewn_search_take(&own->search, grid_of(run), (const vec *)run->answers->mapped + own->question);
    }
}

static hewn_result ask_device(const placement *run, uint32_t questions, hewn_error *error)
{
    const hewn_placing *placing = run->placing;
    const hewn_extractor *extractor = placing->extractor;
    const struct hewn_dual_asked_push push = {.grid = placing->dual->grid,
                                              .count = questions,
                                              .beyond = placing->bricks->beyond,
                                              .bricks = placing->bricks->list->address,
                                              .questions = run->questions->address,
                                              .answers = run->answers->address,
                                              .summary = placing->summary};
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    hewn_commands_dispatch(commands, extractor->dual.asked, &push, hewn_code_uniforms(extractor->code),
                           hewn_groups_for(questions, 64));
    return hewn_commands_submit(&commands, NULL, error);
}

/* --- blocks ------------------------------------------------------------------------------------------------------- */

static void begin_block(placement *run, uint64_t first, uint64_t end)
{
    run->first = first;
    run->count = run->active_count = (uint32_t)(end - first < run->block ? end - first : run->block);
#pragma omp parallel for schedule(static) if (run->count >= ALONE)
    for (uint32_t i = 0; i < run->count; i++) {
        run->active[i] = i;
        begin_vertex(run, i);
    }
}

static void end_block(const placement *run, hewn_emission *sums)
{
    uint32_t caps = 0, edges = 0, corners = 0, planes = 0, lost = 0;
    float residual = sums->max_residual;
#pragma omp parallel for schedule(static) if (run->count >= ALONE) reduction(+ : caps, edges, corners, planes, lost)   \
    reduction(max : residual)
    for (uint32_t i = 0; i < run->count; i++) {
        const work *own = &run->works[i];
        const hewn_search *search = &own->search;
        float off = fabsf(search->seen[3]);
        bool feature = search->rank >= 2 && search->sharp && off <= LOST;
        bool rough = length3(own->along) <= 0.8f * own->count;
        write_vertex(run, i);
        caps += own->capped;
        residual = !own->capped && off <= UNSEEN && off > residual ? off : residual;
        edges += feature && search->rank == 2;
        corners += feature && search->rank == 3;
        planes += search->found;
        lost += search->missed || (run->placing->method == HEWN_METHOD_DC && off > LOST && off <= UNSEEN && rough);
    }
    sums->caps += caps;
    sums->edge_vertices += edges;
    sums->corner_vertices += corners;
    sums->planes_found += planes;
    sums->features_lost += lost;
    sums->max_residual = residual;
}

/* Bytes for each vertex of a block. */
static uint64_t bytes_each(const placement *run)
{
    uint64_t questions = run->placing->method == HEWN_METHOD_NETS ? 1 : HEWN_SEARCH_QUESTIONS;
    return sizeof(work) + 2 * sizeof(uint32_t) + questions * (sizeof(question) + sizeof(vec));
}

/* Where memory is limited, an eighth of what is left will do. */
static uint32_t choose_block(const placement *run, uint64_t vertices)
{
    const hewn_device *device = run->placing->extractor->device;
    uint64_t left = device->most_bytes > device->bytes ? device->most_bytes - device->bytes : 0;
    uint64_t fits = device->most_bytes > 0 ? left / 8 / bytes_each(run) : BLOCK, count = fits < BLOCK ? fits : BLOCK;
    count = count > LEAST_BLOCK ? count : LEAST_BLOCK;
    return (uint32_t)(vertices < count ? vertices : count);
}

static hewn_result take_memory(placement *run, uint64_t vertices, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t count = run->block = choose_block(run, vertices);
    uint64_t most = count * (run->placing->method == HEWN_METHOD_NETS ? 1 : HEWN_SEARCH_QUESTIONS);
    hewn_buffer *works, *active, *counts, *questions, *answers;
    HEWN_TRY(hewn_workspace_take(workspace, "searches for vertices", count * sizeof(work), HEWN_BUFFER_UPLOAD, &works,
                                 error));
    HEWN_TRY(hewn_workspace_take(workspace, "searches that go on", 4 * count, HEWN_BUFFER_UPLOAD, &active, error));
    HEWN_TRY(hewn_workspace_take(workspace, "questions a search", 4 * count, HEWN_BUFFER_UPLOAD, &counts, error));
    HEWN_TRY(
        hewn_workspace_take(workspace, "questions", most * sizeof(question), HEWN_BUFFER_UPLOAD, &questions, error));
    HEWN_TRY(hewn_workspace_take(workspace, "answers", most * sizeof(vec), HEWN_BUFFER_READBACK, &answers, error));
    run->works = works->mapped;
    run->active = active->mapped;
    run->counts = counts->mapped;
    run->questions = questions;
    run->answers = answers;
    return HEWN_OK;
}

static hewn_result place_range(placement *run, uint64_t first, uint64_t end, hewn_emission *sums, hewn_error *error)
{
    for (; first < end; first += run->count) {
        begin_block(run, first, end);
        for (uint32_t questions; (questions = prepare_questions(run)) > 0;) {
            write_questions(run);
            HEWN_TRY(ask_device(run, questions, error));
            take_answers(run);
        }
        end_block(run, sums);
    }
    return HEWN_OK;
}

hewn_result hewn_host_place(const hewn_placing *placing, const uint64_t own[2], uint64_t end, hewn_workspace *workspace,
                            hewn_emission *sums, hewn_error *error)
{
    placement run = {.placing = placing};
    hewn_emission others = {0};
    if (own[0] == end)
        return HEWN_OK;
    HEWN_TRY(take_memory(&run, end - own[0], workspace, error));
    HEWN_TRY(place_range(&run, own[0], own[1], sums, error));
    return place_range(&run, own[1], end, &others, error);
}
