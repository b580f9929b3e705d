#include "volume/blocks.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { ALIGNED = 64, RECENT = 8 };

static hewn_result no_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a volume in blocks");
}

/* --- tables ------------------------------------------------------------------------------------------------------- */

/* One more table, all of whose entries are `entry`; `*table` leads to it. */
static hewn_result add_table(uint32_t **tables, size_t *room, uint64_t *count, uint32_t size, uint32_t *entry,
                             hewn_error *error)
{
    if (*count >= UINT32_MAX / 2 ||
        hewn_reserve((void **)tables, room, (size_t)(*count + 1) * size, sizeof **tables, NULL) != HEWN_OK)
        return no_memory(error);
    uint32_t *to = *tables + *count * size;
    for (uint32_t i = 0; i < size; i++)
        to[i] = *entry;
    *entry = (uint32_t)*count << 1 | 1;
    (*count)++;
    return HEWN_OK;
}

/* The number of a constant: equal ones that follow each other closely share it. */
static hewn_result add_constant(hewn_blocks_plan *plan, const void *sample, uint32_t *number, hewn_error *error)
{
    const size_t size = hewn_voxel_size(plan->type);
    uint64_t *count = &plan->head.constant_count;
    for (uint64_t back = 1; back <= *count && back <= RECENT; back++)
        if (memcmp(plan->constants + (*count - back) * size, sample, size) == 0) {
            *number = (uint32_t)(*count - back);
            return HEWN_OK;
        }
    if (*count > 0 && memcmp(plan->constants, sample, size) == 0) {
        *number = 0; /* the background */
        return HEWN_OK;
    }
    if (*count >= UINT32_MAX / 2 ||
        hewn_reserve((void **)&plan->constants, &plan->constant_room, (size_t)*count + 1, size, NULL) != HEWN_OK)
        return no_memory(error);
    memcpy(plan->constants + *count * size, sample, size);
    *number = (uint32_t)(*count)++;
    return HEWN_OK;
}

/* The entry of the cube of `side` at a place, in a table that is made where there is none. */
static hewn_result find_entry(hewn_blocks_plan *plan, const uint32_t at[3], uint32_t side, uint32_t **out,
                              hewn_error *error)
{
    hewn_blocks *head = &plan->head;
    uint64_t root =
        at[0] / HEWN_UPPER_SPAN +
        (uint64_t)head->roots[0] * (at[1] / HEWN_UPPER_SPAN + (uint64_t)head->roots[1] * (at[2] / HEWN_UPPER_SPAN));
    *out = &plan->root[root];
    if (side == HEWN_UPPER_SPAN)
        return HEWN_OK;
    if (!hewn_entry_leads_on(**out))
        HEWN_TRY(add_table(&plan->uppers, &plan->upper_room, &head->upper_count, HEWN_UPPER_ENTRIES, *out, error));
    uint32_t *upper = plan->uppers + (size_t)(**out >> 1) * HEWN_UPPER_ENTRIES;
    const uint32_t x = at[0] / HEWN_LOWER_SPAN % HEWN_UPPER, y = at[1] / HEWN_LOWER_SPAN % HEWN_UPPER,
                   z = at[2] / HEWN_LOWER_SPAN % HEWN_UPPER;
    *out = &upper[x + HEWN_UPPER * (y + HEWN_UPPER * z)];
    if (side == HEWN_LOWER_SPAN)
        return HEWN_OK;
    if (!hewn_entry_leads_on(**out))
        HEWN_TRY(add_table(&plan->lowers, &plan->lower_room, &head->lower_count, HEWN_LOWER_ENTRIES, *out, error));
    uint32_t *lower = plan->lowers + (size_t)(**out >> 1) * HEWN_LOWER_ENTRIES;
    const uint32_t a = at[0] / HEWN_BLOCK % HEWN_LOWER, b = at[1] / HEWN_BLOCK % HEWN_LOWER,
                   c = at[2] / HEWN_BLOCK % HEWN_LOWER;
    *out = &lower[a + HEWN_LOWER * (b + HEWN_LOWER * c)];
    return HEWN_OK;
}

/* The place of a cube at a multiple of its side; false where no sample of the volume is in it. The first place is such
 * a multiple too, and there are samples from the place 1 on, so what has some of them begins at no place before 0. */
static bool find_place(const hewn_blocks_plan *plan, const int32_t origin[3], uint32_t side, uint32_t at[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const int64_t begin = origin[axis] - plan->first[axis], lead = plan->head.lead[axis];
        if (begin + (int64_t)side <= lead || begin >= lead + (int64_t)plan->dims[axis])
            return false;
        at[axis] = (uint32_t)begin;
    }
    return true;
}

/* Everything above, and all that reads blocks, counts on this. */
static hewn_result check_origin(const int32_t origin[3], uint32_t side, hewn_error *error)
{
    for (int axis = 0; axis < 3; axis++)
        if (origin[axis] % (int32_t)side != 0)
            return hewn_fail(error, HEWN_BAD_INPUT,
                             "a cube of %u samples begins at (%d, %d, %d), not at multiples of %u", side, origin[0],
                             origin[1], origin[2], side);
    return HEWN_OK;
}

/* What a table or a block stands for cannot be had twice: one of the two would be there and never be found. */
static hewn_result check_free(uint32_t entry, const int32_t origin[3], uint32_t side, hewn_error *error)
{
    if (hewn_entry_leads_on(entry))
        return hewn_fail(error, HEWN_BAD_INPUT, "there are two cubes of %u samples at (%d, %d, %d)", side, origin[0],
                         origin[1], origin[2]);
    return HEWN_OK;
}

/* --- making ------------------------------------------------------------------------------------------------------- */

hewn_result hewn_blocks_begin(const hewn_volume *volume, const int32_t origin[3], const void *background,
                              hewn_blocks_plan *out, hewn_error *error)
{
    uint64_t roots = 1;
    uint32_t number;
    *out = (hewn_blocks_plan){.type = volume->type};
    for (int axis = 0; axis < 3; axis++) {
        /* One sample before the first has a place too, and one after the last. */
        const int64_t before = (int64_t)origin[axis] - 1, past = before % HEWN_UPPER_SPAN;
        out->dims[axis] = volume->dims[axis];
        out->first[axis] = before - past - (past < 0 ? HEWN_UPPER_SPAN : 0);
        out->head.lead[axis] = (uint32_t)(origin[axis] - out->first[axis]);
        if (volume->dims[axis] > UINT32_MAX - 3 * HEWN_UPPER_SPAN)
            return hewn_fail(error, HEWN_LIMIT, "%u samples along axis %d are too many", volume->dims[axis], axis + 1);
        out->head.roots[axis] = (out->head.lead[axis] + volume->dims[axis]) / HEWN_UPPER_SPAN + 1;
        roots *= out->head.roots[axis];
    }
    out->root = hewn_alloc_zero(roots, sizeof *out->root);
    return out->root ? add_constant(out, background, &number, error) : no_memory(error);
}

hewn_result hewn_blocks_add_constant(hewn_blocks_plan *plan, const int32_t origin[3], uint32_t side, const void *sample,
                                     hewn_error *error)
{
    uint32_t at[3], *entry, number;
    HEWN_TRY(check_origin(origin, side, error));
    if (!find_place(plan, origin, side, at))
        return HEWN_OK;
    HEWN_TRY(add_constant(plan, sample, &number, error));
    HEWN_TRY(find_entry(plan, at, side, &entry, error));
    HEWN_TRY(check_free(*entry, origin, side, error));
    *entry = number << 1;
    return HEWN_OK;
}

hewn_result hewn_blocks_add_block(hewn_blocks_plan *plan, const int32_t origin[3], bool *added, hewn_error *error)
{
    uint32_t at[3], *entry;
    uint64_t *count = &plan->head.block_count;
    *added = false;
    HEWN_TRY(check_origin(origin, HEWN_BLOCK, error));
    if (!find_place(plan, origin, HEWN_BLOCK, at))
        return HEWN_OK;
    HEWN_TRY(find_entry(plan, at, HEWN_BLOCK, &entry, error));
    HEWN_TRY(check_free(*entry, origin, HEWN_BLOCK, error));
    if (*count >= UINT32_MAX / 2 || hewn_reserve((void **)&plan->places, &plan->place_room, (size_t)*count + 1,
                                                 3 * sizeof *plan->places, NULL) != HEWN_OK)
        return no_memory(error);
    for (int axis = 0; axis < 3; axis++)
        plan->places[3 * *count + (uint64_t)axis] = at[axis] / HEWN_BLOCK;
    *entry = (uint32_t)*count << 1 | 1;
    (*count)++;
    *added = true;
    return HEWN_OK;
}

bool hewn_blocks_hold(const hewn_blocks_plan *plan, const int32_t origin[3])
{
    uint32_t at[3];
    return find_place(plan, origin, HEWN_BLOCK, at);
}

static uint64_t take(uint64_t *bytes, uint64_t count, uint64_t size)
{
    uint64_t at = *bytes;
    *bytes += (count * size + ALIGNED - 1) / ALIGNED * ALIGNED;
    return at;
}

static uint64_t root_count(const hewn_blocks *head)
{
    return (uint64_t)head->roots[0] * head->roots[1] * head->roots[2];
}

static hewn_blocks lay_out(const hewn_blocks_plan *plan)
{
    hewn_blocks head = plan->head;
    const uint64_t size = hewn_voxel_size(plan->type);
    uint64_t bytes = 0;
    (void)take(&bytes, 1, sizeof head);
    head.constants = take(&bytes, head.constant_count, size);
    head.weights = take(&bytes, head.constant_count, sizeof(uint64_t));
    head.places = take(&bytes, head.block_count, 3 * sizeof(uint32_t));
    head.root = take(&bytes, root_count(&head), sizeof(uint32_t));
    head.uppers = take(&bytes, head.upper_count, HEWN_UPPER_ENTRIES * sizeof(uint32_t));
    head.lowers = take(&bytes, head.lower_count, HEWN_LOWER_ENTRIES * sizeof(uint32_t));
    head.samples = take(&bytes, head.block_count, HEWN_BLOCK_SAMPLES * size);
    head.bytes = bytes;
    return head;
}

uint64_t hewn_blocks_bytes(const hewn_blocks_plan *plan)
{
    return lay_out(plan).bytes;
}

/* --- how much of the volume each constant is ---------------------------------------------------------------------- */

typedef struct blocks_weighing {
    const hewn_blocks_plan *plan;
    uint64_t *weights;
} blocks_weighing;

/* Samples of the volume in a cube at a place. */
static uint64_t count_samples(const hewn_blocks_plan *plan, const uint64_t at[3], uint64_t side)
{
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++) {
        const uint64_t begin = plan->head.lead[axis], end = begin + plan->dims[axis];
        const uint64_t lo = at[axis] > begin ? at[axis] : begin, hi = at[axis] + side < end ? at[axis] + side : end;
        count *= lo < hi ? hi - lo : 0;
    }
    return count;
}

static void weigh_entry(const blocks_weighing *all, uint32_t entry, const uint64_t at[3], uint32_t side);

static void weigh_table(const blocks_weighing *all, const uint32_t *entries, uint32_t count, const uint64_t at[3],
                        uint32_t side)
{
    for (uint32_t n = 0; n < count * count * count; n++) {
        const uint64_t there[3] = {at[0] + (uint64_t)side * (n % count), at[1] + (uint64_t)side * (n / count % count),
                                   at[2] + (uint64_t)side * (n / count / count)};
        weigh_entry(all, entries[n], there, side);
    }
}

static void weigh_entry(const blocks_weighing *all, uint32_t entry, const uint64_t at[3], uint32_t side)
{
    const uint64_t number = entry >> 1;
    if (!hewn_entry_leads_on(entry))
        all->weights[number] += count_samples(all->plan, at, side);
    else if (side == HEWN_UPPER_SPAN)
        weigh_table(all, all->plan->uppers + number * HEWN_UPPER_ENTRIES, HEWN_UPPER, at, HEWN_LOWER_SPAN);
    else if (side == HEWN_LOWER_SPAN)
        weigh_table(all, all->plan->lowers + number * HEWN_LOWER_ENTRIES, HEWN_LOWER, at, HEWN_BLOCK);
}

static void weigh(const hewn_blocks_plan *plan, uint64_t *weights)
{
    const blocks_weighing all = {plan, weights};
    const hewn_blocks *head = &plan->head;
    memset(weights, 0, head->constant_count * sizeof *weights);
    for (uint64_t n = 0; n < root_count(head); n++) {
        const uint64_t at[3] = {HEWN_UPPER_SPAN * (n % head->roots[0]),
                                HEWN_UPPER_SPAN * (n / head->roots[0] % head->roots[1]),
                                HEWN_UPPER_SPAN * (n / head->roots[0] / head->roots[1])};
        weigh_entry(&all, plan->root[n], at, HEWN_UPPER_SPAN);
    }
}

/* --- the end ------------------------------------------------------------------------------------------------------ */

void *hewn_blocks_finish(const hewn_blocks_plan *plan, void *memory)
{
    const hewn_blocks head = lay_out(plan);
    char *to = memory;
    memcpy(to, &head, sizeof head);
    memcpy(to + head.constants, plan->constants, head.constant_count * hewn_voxel_size(plan->type));
    weigh(plan, (uint64_t *)(void *)(to + head.weights));
    memcpy(to + head.root, plan->root, root_count(&head) * sizeof *plan->root);
    if (head.upper_count > 0)
        memcpy(to + head.uppers, plan->uppers, head.upper_count * HEWN_UPPER_ENTRIES * sizeof *plan->uppers);
    if (head.lower_count > 0)
        memcpy(to + head.lowers, plan->lowers, head.lower_count * HEWN_LOWER_ENTRIES * sizeof *plan->lowers);
    if (head.block_count > 0)
        memcpy(to + head.places, plan->places, head.block_count * 3 * sizeof *plan->places);
    return to + head.samples;
}

void hewn_blocks_clear(hewn_blocks_plan *plan)
{
    hewn_free(plan->root);
    hewn_free(plan->uppers);
    hewn_free(plan->lowers);
    hewn_free(plan->places);
    hewn_free(plan->constants);
    *plan = (hewn_blocks_plan){0};
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

void hewn_block_within(const hewn_volume *volume, uint64_t block, uint32_t lo[3], uint32_t hi[3])
{
    const uint32_t *place = HEWN_BLOCKS_ARRAY(volume->blocks, uint32_t, places) + 3 * block;
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t begin = HEWN_BLOCK * place[axis], lead = volume->blocks->lead[axis];
        const uint32_t end = lead + volume->dims[axis];
        lo[axis] = begin < lead ? lead - begin : 0;
        hi[axis] = end - begin < HEWN_BLOCK ? end - begin : HEWN_BLOCK;
    }
}
