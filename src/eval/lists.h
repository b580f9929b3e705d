/* Listed code: the field as lists of instructions that kernels walk over, one list for the whole field and a shorter
 * one for each box that somebody prunes for.
 *
 * A kernel calls field_select(slot) to evaluate the list of a box that hewn_code_use_lists() named; before that it is
 * the whole field's, and so it is again after field_select(FIELD_WHOLE); field_select(field_around(slot)) takes that of
 * the larger box which the slot's was cut from. Straight code has a field_select() that does nothing, so most kernels
 * need not know which it is; where they do, `FIELD_LISTED` is defined.
 *
 * Pruning drops an operand of a min, max or blend where bounds show that the arithmetic returns the other operand's
 * bits, so every list gives the same bits in its box as the whole field. With HEWN_FLAVOUR_CHOICES a kernel has
 *   void field_choose(vec2 x[4], vec2 y[4], vec2 z[4], hewn_words choices, uint first[4], out vec2 ranges[4])
 *       field_interval() of four boxes, which also writes two bits an instruction for each, from word `first` on
 *   uint field_keep(hewn_words choices, uint first, bool write, hewn_words to, uint end)
 *       how many instructions those choices leave; with `write` they go to where the list `to` has instructions up to
 *       `end`
 * with HEWN_FLAVOUR_FOUR
 *   vec4 field_points(vec4 x, vec4 y, vec4 z)
 *   void field_gradients(vec4 x, vec4 y, vec4 z, out vec4 gradients[4])
 * and with that one or HEWN_FLAVOUR_WORD
 *   void field_narrow(vec2 x, vec2 y, vec2 z, bool matters, uint least)
 *       all that follows is in such boxes, an invocation one, which matters where `matters` says so: together they may
 *       leave out of the list what is needed in none, where it has `least` instructions or more. Until the next
 *       field_select() or field_narrow().
 * `FIELD_TOGETHER` is defined where the kernel is made so that a subgroup reads instructions together: then no
 * invocation may leave before the last evaluation, and what subgroups decide they decide by vote. */
#ifndef HEWN_SRC_EVAL_LISTS_H
#define HEWN_SRC_EVAL_LISTS_H

#include "eval/code.h"

/* How a field is evaluated. */
typedef enum hewn_evaluation {
    HEWN_EVALUATION_AUTO,     /* listed where the field is large enough for pruning to pay, and can be */
    HEWN_EVALUATION_STRAIGHT, /* code for each operation */
    HEWN_EVALUATION_LISTED    /* lists, where there can be */
} hewn_evaluation;

typedef struct hewn_code_desc {
    hewn_numbers numbers; /* of straight code */
    hewn_evaluation evaluation;
    bool whole;   /* no list is pruned: for comparison */
    bool chained; /* outlines are walked over side by side, without tables: for comparison */
} hewn_code_desc;

hewn_result hewn_code_create_as(hewn_device *device, const hewn_field *field, hewn_node root,
                                const hewn_code_desc *desc, hewn_code **out, hewn_error *error);

bool hewn_code_is_listed(const hewn_code *code);

/* Instructions of the whole field, and their list. */
uint32_t hewn_code_instruction_count(const hewn_code *code);
const uint32_t *hewn_code_whole_list(const hewn_code *code);

/* Bytes of one in a list: the numbers of all stand in one place. */
#define HEWN_LIST_ENTRY 8u

/* Kernels made with HEWN_FLAVOUR_TOGETHER give one list to this many invocations in a row, or to a multiple. */
#define HEWN_LIST_INVOCATIONS 8u

/* Bytes that a list's buffer has past its end: what is read together may reach beyond the last instruction. */
#define HEWN_LIST_SLACK 64u

/* Lists of boxes, which are slots, and of the larger boxes that they were cut from. */
typedef struct hewn_code_lists {
    const hewn_buffer *lists, *ranges;         /* a slot: first instruction in `lists`, and count */
    const hewn_buffer *around, *around_ranges; /* or NULL: that is the whole field's */
    const hewn_buffer *origins;                /* a slot: 64 times the larger box's number, and more */
} hewn_code_lists;

/* Used from the next submit on. */
void hewn_code_use_lists(hewn_code *code, const hewn_code_lists *lists);

#endif
