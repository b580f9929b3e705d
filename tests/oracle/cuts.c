#include "cuts.h"

#include <stdlib.h>
#include <string.h>

typedef struct oracle_tracer {
    const uint32_t *cells;
    const bool *inside;
    oracle_surface out;
    size_t capacity;
} oracle_tracer;

static uint64_t sample_name(const oracle_tracer *tracer, const uint32_t at[3])
{
    return at[0] + (uint64_t)(tracer->cells[0] + 1) * (at[1] + (uint64_t)(tracer->cells[1] + 1) * at[2]);
}

static void add_cut(oracle_tracer *tracer, uint64_t from, uint64_t to)
{
    if (tracer->out.cut_count == tracer->capacity) {
        tracer->capacity = tracer->capacity ? 2 * tracer->capacity : 1024;
        tracer->out.cuts = realloc(tracer->out.cuts, tracer->capacity * sizeof *tracer->out.cuts);
        if (!tracer->out.cuts)
            abort();
    }
    tracer->out.cuts[tracer->out.cut_count++] = (oracle_cut){from, to};
}

/* The name of the grid edge between two neighbouring samples. */
static uint64_t edge_name(const oracle_tracer *tracer, const uint32_t a[3], const uint32_t b[3])
{
    for (unsigned axis = 0; axis < 3; axis++)
        if (a[axis] != b[axis])
            return 3 * sample_name(tracer, a[axis] < b[axis] ? a : b) + axis;
    abort();
}

/* Each inside corner of a face with an outside corner next to it in turning order closes a run of inside corners: a cut
 * leads from where the run is entered to where it is left. `turn` lists the corners counter-clockwise seen from outside
 * the cell. */
static void trace_face(oracle_tracer *tracer, uint32_t turn[4][3])
{
    bool in[4];
    for (int i = 0; i < 4; i++)
        in[i] = tracer->inside[sample_name(tracer, turn[i])];
    bool ambiguous = in[0] == in[2] && in[1] == in[3] && in[0] != in[1];
    for (int i = 0; i < 4; i++) {
        if (!in[i] || in[(i + 1) % 4])
            continue;
        int first = i;
        while (!ambiguous && in[(first + 3) % 4])
            first = (first + 3) % 4;
        add_cut(tracer, edge_name(tracer, turn[(first + 3) % 4], turn[first]),
                edge_name(tracer, turn[i], turn[(i + 1) % 4]));
    }
}

static void trace_cell(oracle_tracer *tracer, const uint32_t cell[3])
{
    size_t before = tracer->out.cut_count;
    for (unsigned axis = 0; axis < 3; axis++) {
        for (uint32_t side = 0; side < 2; side++) {
            uint32_t turn[4][3];
            static const uint32_t square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
            for (int i = 0; i < 4; i++) {
                const uint32_t *place = square[side ? i : (4 - i) % 4];
                memcpy(turn[i], cell, sizeof turn[i]);
                turn[i][axis] += side;
                turn[i][(axis + 1) % 3] += place[0];
                turn[i][(axis + 2) % 3] += place[1];
            }
            trace_face(tracer, turn);
        }
    }
    /* Every cut's end is another's start; count the loops by following them. */
    size_t count = tracer->out.cut_count - before;
    const oracle_cut *cuts = tracer->out.cuts + before;
    bool seen[16] = {false};
    for (size_t i = 0; i < count; i++) {
        size_t length = 0;
        for (size_t at = i; !seen[at]; length++) {
            seen[at] = true;
            uint64_t next = cuts[at].to;
            for (at = 0; cuts[at].from != next; at++)
                ;
        }
        tracer->out.triangle_count += length ? length - 2 : 0;
    }
}

static void count_vertices(oracle_tracer *tracer)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] <= tracer->cells[2]; at[2]++)
        for (at[1] = 0; at[1] <= tracer->cells[1]; at[1]++)
            for (at[0] = 0; at[0] <= tracer->cells[0]; at[0]++)
                for (int axis = 0; axis < 3; axis++) {
                    uint32_t next[3] = {at[0], at[1], at[2]};
                    next[axis]++;
                    if (next[axis] <= tracer->cells[axis] &&
                        tracer->inside[sample_name(tracer, at)] != tracer->inside[sample_name(tracer, next)])
                        tracer->out.vertex_count++;
                }
}

static int by_name(const void *a, const void *b)
{
    const oracle_cut *left = a, *right = b;
    if (left->from != right->from)
        return left->from < right->from ? -1 : 1;
    return (left->to > right->to) - (left->to < right->to);
}

void oracle_sort(oracle_cut *cuts, size_t count)
{
    if (count)
        qsort(cuts, count, sizeof *cuts, by_name);
}

oracle_surface oracle_trace(const uint32_t cells[3], const bool *inside)
{
    oracle_tracer state = {.cells = cells, .inside = inside};
    uint32_t cell[3];
    for (cell[2] = 0; cell[2] < cells[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < cells[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < cells[0]; cell[0]++)
                trace_cell(&state, cell);
    count_vertices(&state);
    oracle_sort(state.out.cuts, state.out.cut_count);
    return state.out;
}
