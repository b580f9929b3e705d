/* Cutting a tape down: what a choice makes superfluous goes, steps move together, and registers are given out anew from
 * the last step back, so that a short tape works in little memory. */
#include "base/alloc.h"
#include "base/error.h"
#include "lanes/internal.h"
#include "lanes/outline.h"

enum { NO_REGISTER = 0xFFFF };

typedef struct cutting {
    const hewn_lane_tape *from;
    const int32_t *choices;      /* the box's column, or NULL */
    hewn_lane_operands *in;      /* of each step; then those of the new tape's */
    hewn_lane_outline *outlines; /* what those that are needed become; they move together, as steps do */
    uint32_t *same;              /* the step that has a step's value */
    uint32_t *place;             /* in the new tape, HEWN_NO_STEP: not needed */
    uint32_t *held;              /* register */
    uint16_t *free;              /* those given back */
    uint32_t free_count, registers;
} cutting;

/* Follows choices to whose value each step has, and marks what the last one needs; returns how many steps that is. */
static uint32_t mark(cutting *cut, uint32_t last)
{
    const hewn_lane_step *steps = cut->from->steps;
    for (uint32_t i = 0, choice = 0; i <= last; i++) {
        cut->same[i] = i;
        cut->place[i] = HEWN_NO_STEP;
        cut->held[i] = NO_REGISTER;
        if (!cut->choices || !hewn_lane_can_cut(&steps[i]))
            continue;
        int32_t keep = cut->choices[(size_t)choice++ * HEWN_LANES];
        if (keep == HEWN_KEEP_FIRST)
            cut->same[i] = cut->same[cut->in[i][0]];
        else if (keep == HEWN_KEEP_SECOND && steps[i].input_count > 1)
            cut->same[i] = cut->same[cut->in[i][1]];
        else if (keep == HEWN_KEEP_SECOND)
            cut->held[i] = HEWN_NO_STEP; /* its number alone */
    }
    uint32_t needed = 0;
    cut->place[cut->same[last]] = 0;
    for (uint32_t i = last + 1; i-- > 0;) {
        if (cut->place[i] == HEWN_NO_STEP)
            continue;
        needed++;
        for (uint32_t k = 0; k < steps[i].input_count && cut->held[i] != HEWN_NO_STEP; k++)
            cut->place[cut->same[cut->in[i][k]]] = 0;
    }
    return needed;
}

static uint32_t copy_steps(cutting *cut, uint32_t last, hewn_lane_tape *to)
{
    uint32_t cuts = 0;
    for (uint32_t i = 0; i <= last; i++) {
        if (cut->place[i] == HEWN_NO_STEP)
            continue;
        uint32_t at = cut->place[i] = to->count++; /* not after i, so what is written over has been read */
        hewn_lane_step *step = &to->steps[at];
        *step = cut->from->steps[i];
        if (step->kind == HEWN_LANE_OUTLINE) {
            hewn_lane_outline *place = &cut->outlines[to->outline_count], other = *place;
            *place = cut->outlines[step->node];
            cut->outlines[step->node] = other;
            to->side_count += place->side_count;
            step->node = to->outline_count++;
        }
        if (cut->held[i] == HEWN_NO_STEP) {
            step->kind = HEWN_LANE_NUMBER;
            step->input_count = 0;
        }
        for (uint32_t k = 0; k < step->input_count; k++)
            cut->in[at][k] = cut->place[cut->same[cut->in[i][k]]];
        cuts += hewn_lane_can_cut(step);
    }
    return cuts;
}

static uint16_t take(cutting *cut)
{
    return cut->free_count > 0 ? cut->free[--cut->free_count] : (uint16_t)cut->registers++;
}

/* A step's own register is given back after its operands have theirs, so that no step writes what it reads. */
static bool give_registers(cutting *cut, hewn_lane_tape *to)
{
    uint32_t *held = cut->held;
    for (uint32_t i = 0; i < to->count; i++)
        held[i] = NO_REGISTER;
    held[to->count - 1] = take(cut);
    for (uint32_t i = to->count; i-- > 0;) {
        hewn_lane_step *step = &to->steps[i];
        step->out = (uint16_t)held[i];
        for (uint32_t k = 0; k < step->input_count; k++) {
            uint32_t in = cut->in[i][k];
            if (held[in] == NO_REGISTER)
                held[in] = take(cut);
            step->from[k] = (uint16_t)held[in];
        }
        if (cut->registers >= NO_REGISTER)
            return false;
        cut->free[cut->free_count++] = step->out;
    }
    to->registers = cut->registers;
    return true;
}

static hewn_result make(cutting *cut, uint32_t last, uint32_t needed, hewn_lane_tape **out, hewn_error *error)
{
    hewn_lane_tape *to = hewn_alloc(1, sizeof *to + needed * sizeof *to->steps);
    if (!to)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the tape of a field");
    *to = (hewn_lane_tape){.others = cut->from->others, .factors = cut->from->factors};
    to->cuts = copy_steps(cut, last, to);
    hewn_result result = HEWN_OK;
    if (to->outline_count > 0 && !(to->outlines = hewn_lane_outlines_pack(cut->outlines, to->outline_count)))
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the tape of a field");
    else if (!give_registers(cut, to))
        result = hewn_fail(error, HEWN_LIMIT, "the field keeps more than 65,534 values at a time");
    if (result != HEWN_OK)
        hewn_lane_tape_destroy(&to);
    *out = to;
    return result;
}

hewn_result hewn_lane_tape_settle(const hewn_lane_tape *steps, hewn_lane_operands *in, uint32_t last,
                                  hewn_lane_tape **out, hewn_error *error)
{
    *out = NULL;
    uint32_t *room = hewn_alloc((size_t)steps->count * 3, sizeof *room);
    uint16_t *free = hewn_alloc((size_t)steps->count + 1, sizeof *free);
    hewn_result result = HEWN_OUT_OF_MEMORY;
    if (room && free) {
        cutting cut = {.from = steps, .in = in, .same = room, .free = free, .outlines = steps->outlines};
        cut.place = room + steps->count;
        cut.held = room + 2 * (size_t)steps->count;
        uint32_t needed = mark(&cut, last);
        result = make(&cut, last, needed, out, error);
    } else {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the tape of a field");
    }
    hewn_free(room);
    hewn_free(free);
    return result;
}

/* Cuts down the outlines that are needed; returns how many sides they have left. */
static uint32_t pick(const cutting *cut, hewn_lane_work *work, uint32_t lane)
{
    const hewn_lane_tape *tape = cut->from;
    uint32_t sides = 0;
    hewn_lane_side *side = work->picked[0].sides;
    double *turns = work->picked[0].turns;
    for (uint32_t i = 0; tape->outline_count > 0 && i < tape->count; i++) {
        uint32_t number = tape->steps[i].node;
        if (tape->steps[i].kind != HEWN_LANE_OUTLINE || cut->place[i] == HEWN_NO_STEP)
            continue;
        const float *place = work->places + (size_t)number * 4 * HEWN_LANES + lane;
        const float lo[2] = {place[0], place[2 * HEWN_LANES]}, hi[2] = {place[HEWN_LANES], place[3 * HEWN_LANES]};
        hewn_lane_outline *out = &work->picked[number];
        out->sides = side;
        out->turns = turns;
        hewn_lane_outline_pick(&tape->outlines[number], lo, hi, work->distances, out);
        sides += out->side_count;
        side += out->side_count;
        turns += out->turn_count;
    }
    return sides;
}

/* Who wrote a register last before a step reads it: that is the step's operand. */
static void find_operands(const hewn_lane_tape *tape, uint32_t *writer, hewn_lane_operands *in)
{
    for (uint32_t i = 0; i < tape->count; i++) {
        const hewn_lane_step *step = &tape->steps[i];
        for (uint32_t k = 0; k < step->input_count; k++)
            in[i][k] = writer[step->from[k]];
        writer[step->out] = i;
    }
}

hewn_result hewn_lane_tape_cut(const hewn_lane_tape *tape, hewn_lane_work *work, uint32_t lane, hewn_lane_tape **out,
                               hewn_error *error)
{
    *out = NULL;
    cutting cut = {.from = tape, .choices = work->choices + lane, .same = work->scratch, .free = work->held};
    cut.place = work->scratch + tape->count;
    cut.held = work->scratch + 2 * (size_t)tape->count;
    cut.in = (hewn_lane_operands *)(work->scratch + 4 * (size_t)tape->count);
    find_operands(tape, work->scratch + 3 * (size_t)tape->count, cut.in);
    uint32_t needed = mark(&cut, tape->count - 1);
    uint32_t sides = pick(&cut, work, lane);
    if (needed > tape->count - tape->count / 8 && sides >= tape->side_count - tape->side_count / 8)
        return HEWN_OK;
    cut.outlines = work->picked;
    return make(&cut, tape->count - 1, needed, out, error);
}
