#include "iso/host_lists.h"

#include <stdbool.h>
#include <string.h>

/* Blocks that a thread takes at a time, and fewer than it pays to wake other threads for. */
enum { SHARE = 16, ALONE = 64 };

enum { NO_SLOT = 15 };

/* --- blocks ------------------------------------------------------------------------------------------------------- */

static uint32_t pack_block(const hewn_host_lists *view, uint32_t at)
{
    const uint32_t *dense = view->dense;
    if (dense[0] != 0)
        return at % dense[0] | at / dense[0] % dense[1] << 10 | at / (dense[0] * dense[1]) << 20;
    uint32_t child = (at & 3) | (at >> 2 & 3) << 10 | (at >> 4 & 3) << 20;
    return HEWN_LEVEL_RATIO * view->parents[at >> 6] + child; /* no coordinate overflows into the next */
}

static uint32_t list_blocks(const hewn_host_lists *view)
{
    uint32_t kept = 0;
    for (uint32_t at = 0; at < view->tested; at++) {
        if (view->states[at] != 0)
            continue;
        view->states[at] = kept;
        view->origins[kept] = at;
        view->kept[kept++] = pack_block(view, at);
    }
    return kept;
}

/* --- lists -------------------------------------------------------------------------------------------------------- */

/* As in keep.glsl. */
typedef struct keeping {
    uint8_t map[16]; /* the shorter list's number of a slot that is needed, or NO_SLOT */
    uint32_t used;   /* numbers in use, a bit each */
} keeping;

static uint32_t ask(keeping *state, uint32_t slot)
{
    if (slot == NO_SLOT)
        return NO_SLOT;
    if (state->map[slot] == NO_SLOT) {
        uint32_t number = 0;
        while (state->used >> number & 1u)
            number++;
        state->map[slot] = (uint8_t)number;
        state->used |= 1u << number;
    }
    return state->map[slot];
}

static bool keeps(keeping *state, uint32_t head, uint32_t choice, uint32_t *made)
{
    uint32_t out_slot = head >> 12 & 15, number = state->map[out_slot], body = head & 255;
    if (number == NO_SLOT)
        return false;
    uint32_t a = head >> 16 & 15, b = head >> 20 & 15, how = choice == 2 ? 0 : head >> 8 & 15;
    state->map[out_slot] = NO_SLOT;
    state->used &= ~(1u << number);
    uint32_t only = choice == 1 ? a : choice == 2 && body == 0 ? b : NO_SLOT;
    if (only == NO_SLOT) {
        uint32_t from_a = how ? ask(state, a) : NO_SLOT, from_b = ask(state, b);
        uint32_t from_c = ask(state, head >> 24 & 15), from_d = ask(state, head >> 28);
        *made = body | how << 8 | number << 12 | from_a << 16 | from_b << 20 | from_c << 24 | from_d << 28;
        return true;
    }
    if (state->map[only] == NO_SLOT) { /* nobody else wants it: it takes the number over */
        state->map[only] = (uint8_t)number;
        state->used |= 1u << number;
        return false;
    }
    *made = number << 12 | 0xFF0F0000u | (uint32_t)state->map[only] << 20;
    return true;
}

/* Applies the choices of tested block `at`, from the last instruction back. Returns how many are kept; with `end` they
 * are written before it. */
static uint32_t keep(const hewn_host_lists *view, uint32_t at, uint32_t *end)
{
    const uint32_t *list = view->parent_entries, *choices = view->choices;
    uint32_t count = view->whole_count, kept = 0;
    if (view->dense[0] != 0) {
        choices += (uint64_t)at * ((count + 15) / 16);
    } else {
        const uint32_t parent = at >> 6, *range = view->parent_ranges + (uint64_t)2 * parent;
        count = range[1];
        list += (uint64_t)2 * range[0];
        choices += (uint64_t)4 * range[0] + (uint64_t)64 * parent + (uint64_t)(at & 63) * ((count + 15) / 16);
    }
    keeping state = {.used = 1};
    memset(state.map, NO_SLOT, sizeof state.map);
    state.map[0] = 0;
    for (uint32_t left = count; left-- > 0 && state.used != 0;) {
        uint32_t choice = choices[left >> 4] >> 2 * (left & 15) & 3, made;
        if (!keeps(&state, list[(uint64_t)2 * left], choice, &made))
            continue;
        kept++;
        if (end) {
            end -= 2;
            end[0] = made;
            end[1] = list[(uint64_t)2 * left + 1];
        }
    }
    return kept;
}

uint32_t hewn_host_lists_count(const hewn_host_lists *view, uint64_t *instructions)
{
    uint32_t kept = list_blocks(view);
#pragma omp parallel for schedule(dynamic, SHARE) if (kept >= ALONE)
    for (uint32_t rank = 0; rank < kept; rank++)
        view->places[rank] = keep(view, view->origins[rank], NULL);
    *instructions = 0;
    for (uint32_t rank = 0; rank <= kept; rank++) {
        uint32_t length = rank < kept ? view->places[rank] : 0;
        view->places[rank] = (uint32_t)*instructions;
        *instructions += length;
    }
    return kept;
}

void hewn_host_lists_write(const hewn_host_lists *view, uint32_t kept, uint32_t *entries, uint32_t *ranges)
{
#pragma omp parallel for schedule(dynamic, SHARE) if (kept >= ALONE)
    for (uint32_t rank = 0; rank < kept; rank++) {
        ranges[(uint64_t)2 * rank] = view->places[rank];
        ranges[(uint64_t)2 * rank + 1] = view->places[rank + 1] - view->places[rank];
        keep(view, view->origins[rank], entries + (uint64_t)2 * view->places[rank + 1]);
    }
}
