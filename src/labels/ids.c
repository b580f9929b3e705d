#include "labels/ids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "volume/voxel.h"

enum { MOST_LABELS = UINT16_MAX, ROW_PART = 4096 };

/* Whole numbers beyond are not all doubles. */
static const double largest = 9007199254740992.0;

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for labels");
}

/* --- sets of values ------------------------------------------------------------------------------------------------
 */

/* Labels that were met, each with an entry: how often, or, later, its id. */
typedef struct label_set {
    int64_t *keys;
    uint64_t *values;
    bool *used;
    size_t slot_count, count;
} label_set;

static void set_free(label_set *set)
{
    hewn_free(set->keys);
    hewn_free(set->values);
    hewn_free(set->used);
    *set = (label_set){0};
}

static size_t set_slot(const label_set *set, int64_t key)
{
    size_t at = (uint64_t)key * 0x9E3779B97F4A7C15u >> 20 & (set->slot_count - 1);
    while (set->used[at] && set->keys[at] != key)
        at = (at + 1) & (set->slot_count - 1);
    return at;
}

static bool set_make(label_set *set, size_t slots)
{
    *set = (label_set){.slot_count = slots};
    set->keys = hewn_alloc(slots, sizeof *set->keys);
    set->values = hewn_alloc_zero(slots, sizeof *set->values);
    set->used = hewn_alloc_zero(slots, sizeof *set->used);
    return set->keys && set->values && set->used;
}

/* The value of a key, 0 if it is new; NULL: out of memory. */
static uint64_t *set_at(label_set *set, int64_t key)
{
    if (2 * set->count >= set->slot_count) {
        label_set larger;
        if (!set_make(&larger, set->slot_count ? 2 * set->slot_count : 256)) {
            set_free(&larger);
            return NULL;
        }
        for (size_t i = 0; i < set->slot_count; i++)
            if (set->used[i]) {
                size_t at = set_slot(&larger, set->keys[i]);
                larger.used[at] = true;
                larger.keys[at] = set->keys[i];
                larger.values[at] = set->values[i];
            }
        larger.count = set->count;
        set_free(set);
        *set = larger;
    }
    size_t at = set_slot(set, key);
    set->count += !set->used[at];
    set->used[at] = true;
    set->keys[at] = key;
    return &set->values[at];
}

/* --- reading voxels ------------------------------------------------------------------------------------------------
 */

/* A thread's work over rows of voxels. */
typedef struct reader {
    const hewn_volume *volume;
    uint64_t frame_start; /* first sample */
    label_set met;
    int64_t last; /* the label before, and its entry: runs are long */
    uint64_t *last_at;
    uint64_t bad; /* the first sample that is no label; UINT64_MAX: none */
    bool no_memory;
    double samples[ROW_PART];
    int64_t labels[ROW_PART];
} reader;

/* Samples as labels; false where one is none. */
static bool take_labels(reader *by, uint64_t at, size_t count)
{
    const hewn_volume *volume = by->volume;
    hewn_voxels_to_double(volume, at, count, by->samples);
    for (size_t i = 0; i < count; i++) {
        double value = volume->slope * by->samples[i] + volume->intercept;
        if (!(fabs(value) <= largest) || rint(value) != value) {
            by->bad = at + i < by->bad ? at + i : by->bad;
            return false;
        }
        by->labels[i] = (int64_t)value;
    }
    return true;
}

static void count_labels(reader *by, size_t count)
{
    for (size_t i = 0; i < count && !by->no_memory; i++) {
        if (!by->last_at || by->labels[i] != by->last) {
            by->last_at = set_at(&by->met, by->labels[i]);
            by->last = by->labels[i];
            by->no_memory = !by->last_at;
        }
        if (by->last_at)
            ++*by->last_at;
    }
}

/* Looks at all samples of slice k. */
static void count_slice(reader *by, uint32_t k)
{
    uint64_t size = (uint64_t)by->volume->dims[0] * by->volume->dims[1];
    uint64_t begin = by->frame_start + size * k, end = begin + size;
    for (uint64_t at = begin; at < end; at += ROW_PART) {
        size_t count = end - at < ROW_PART ? (size_t)(end - at) : ROW_PART;
        if (by->bad != UINT64_MAX || by->no_memory || by->met.count > (size_t)MOST_LABELS + 1 ||
            !take_labels(by, at, count))
            return;
        count_labels(by, count);
    }
}

static hewn_result fail_voxel(const hewn_volume *volume, uint64_t frame_start, uint64_t at, hewn_error *error)
{
    uint64_t index = at - frame_start;
    unsigned long long i = index % volume->dims[0], j = index / volume->dims[0] % volume->dims[1],
                       k = index / volume->dims[0] / volume->dims[1];
    return hewn_fail(error, HEWN_BAD_INPUT,
                     "voxel %llu,%llu,%llu is %.17g, but labels are whole numbers up to 2^53 (--iso makes a surface of "
                     "values)",
                     i, j, k, hewn_volume_value(volume, at));
}

/* All labels that there are, with how often. */
static hewn_result count_all(const hewn_volume *volume, uint64_t frame_start, label_set *out, hewn_error *error)
{
    uint64_t bad = UINT64_MAX;
    bool no_memory = false;
#pragma omp parallel
    {
        reader *by = hewn_alloc(1, sizeof *by);
        if (by)
            *by = (reader){.volume = volume, .frame_start = frame_start, .bad = UINT64_MAX};
#pragma omp for schedule(static)
        for (uint32_t k = 0; k < volume->dims[2]; k++)
            if (by)
                count_slice(by, k);
#pragma omp critical(hewn_label_ids_count)
        {
            no_memory = no_memory || !by || by->no_memory;
            bad = by && by->bad < bad ? by->bad : bad;
            for (size_t i = 0; by && !no_memory && i < by->met.slot_count; i++) {
                if (!by->met.used[i])
                    continue;
                uint64_t *count = set_at(out, by->met.keys[i]);
                no_memory = !count;
                if (count)
                    *count += by->met.values[i];
            }
            if (by)
                set_free(&by->met);
            hewn_free(by);
        }
    }
    if (no_memory)
        return fail_memory(error);
    if (bad != UINT64_MAX)
        return fail_voxel(volume, frame_start, bad, error);
    if (out->count > (size_t)MOST_LABELS + 1)
        return hewn_fail(error, HEWN_LIMIT,
                         "there are more than %d labels (is it a volume of values? --iso makes a surface of those)",
                         MOST_LABELS);
    return HEWN_OK;
}

/* --- choosing ------------------------------------------------------------------------------------------------------
 */

static bool is_wanted(const hewn_label_desc *desc, int64_t label)
{
    for (size_t i = 0; desc->labels && i < desc->label_count; i++)
        if (desc->labels[i] == label)
            return true;
    return !desc->labels && label != 0;
}

static int compare_labels(const void *a, const void *b)
{
    int64_t one = *(const int64_t *)a, other = *(const int64_t *)b;
    return (one > other) - (one < other);
}

/* Gives the labels that are wanted their ids, others 0. */
static hewn_result choose(const hewn_label_desc *desc, label_set *met, hewn_label_ids *out, hewn_error *error)
{
    out->labels = hewn_alloc(met->count, sizeof *out->labels);
    out->voxel_count = hewn_alloc(met->count, sizeof *out->voxel_count);
    if (!out->labels || !out->voxel_count)
        return fail_memory(error);
    for (size_t i = 0; i < met->slot_count; i++)
        if (met->used[i] && is_wanted(desc, met->keys[i]))
            out->labels[out->label_count++] = met->keys[i];
    if (out->label_count > MOST_LABELS)
        return hewn_fail(error, HEWN_LIMIT, "there are more than %d labels", MOST_LABELS);
    if (out->label_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT,
                         desc->labels ? "no voxel has a label that was asked for"
                                      : "all voxels are 0: there is no label");
    qsort(out->labels, out->label_count, sizeof *out->labels, compare_labels);
    for (uint32_t n = 0; n < out->label_count; n++)
        out->voxel_count[n] = met->values[set_slot(met, out->labels[n])];
    memset(met->values, 0, met->slot_count * sizeof *met->values);
    for (uint32_t n = 0; n < out->label_count; n++)
        met->values[set_slot(met, out->labels[n])] = n + 1;
    return HEWN_OK;
}

/* --- writing ids ---------------------------------------------------------------------------------------------------
 */

static uint16_t id_of(const label_set *ids, int64_t label)
{
    return (uint16_t)ids->values[set_slot(ids, label)];
}

/* Ids of 8- and 16-bit samples that lie in a row, by sample; slope and intercept are 1 and 0. */
static bool make_table(const hewn_volume *volume, const label_set *ids, uint16_t **out)
{
    static const struct {
        hewn_voxel type;
        int64_t lo, hi;
    } small[] = {{HEWN_VOXEL_UINT8, 0, UINT8_MAX},
                 {HEWN_VOXEL_INT8, INT8_MIN, INT8_MAX},
                 {HEWN_VOXEL_UINT16, 0, UINT16_MAX},
                 {HEWN_VOXEL_INT16, INT16_MIN, INT16_MAX}};
    *out = NULL;
    for (size_t t = 0; t < sizeof small / sizeof *small; t++) {
        if (volume->blocks || volume->type != small[t].type || volume->slope != 1 || volume->intercept != 0)
            continue;
        *out = hewn_alloc_zero((size_t)(small[t].hi - small[t].lo + 1), sizeof **out);
        if (!*out)
            return false;
        uint64_t mask = (uint64_t)(small[t].hi - small[t].lo); /* negative samples by their bits */
        for (size_t i = 0; i < ids->slot_count; i++)
            if (ids->used[i])
                (*out)[(uint64_t)ids->keys[i] & mask] = (uint16_t)ids->values[i];
    }
    return true;
}

/* One row of ids from samples `at` on. */
static void write_row(reader *by, const label_set *ids, const uint16_t *table, uint64_t at, uint16_t *row)
{
    size_t count = by->volume->dims[0];
    if (table && hewn_voxel_size(by->volume->type) == 1) {
        const uint8_t *from = (const uint8_t *)by->volume->samples + at;
        for (size_t i = 0; i < count; i++)
            row[i] = table[from[i]];
        return;
    }
    if (table) {
        const uint16_t *from = (const uint16_t *)by->volume->samples + at;
        for (size_t i = 0; i < count; i++)
            row[i] = table[from[i]];
        return;
    }
    uint16_t last = 0;
    for (size_t done = 0; done < count; done += ROW_PART) {
        size_t part = count - done < ROW_PART ? count - done : ROW_PART;
        take_labels(by, at + done, part);
        for (size_t i = 0; i < part; i++) {
            if (done + i == 0 || by->labels[i] != by->last)
                last = id_of(ids, by->labels[i]);
            by->last = by->labels[i];
            row[done + i] = last;
        }
    }
}

static hewn_result write_ids(const hewn_volume *volume, uint64_t frame_start, const label_set *ids, hewn_label_ids *out,
                             hewn_error *error)
{
    uint16_t *table;
    bool no_memory = !make_table(volume, ids, &table);
#pragma omp parallel reduction(|| : no_memory)
    {
        reader *by = hewn_alloc(1, sizeof *by);
        no_memory = no_memory || !by;
        if (by)
            *by = (reader){.volume = volume, .bad = UINT64_MAX};
#pragma omp for schedule(static)
        for (uint32_t k = 0; k < out->dims[2]; k++) {
            uint64_t slice = (uint64_t)out->dims[0] * out->dims[1];
            uint16_t *to = out->ids + slice * k;
            memset(to, 0, slice * sizeof *to);
            if (!by || k == 0 || k == out->dims[2] - 1)
                continue;
            for (uint32_t j = 0; j < volume->dims[1]; j++)
                write_row(by, ids, table, frame_start + volume->dims[0] * (j + (uint64_t)volume->dims[1] * (k - 1)),
                          to + 1 + (uint64_t)out->dims[0] * (j + 1));
        }
        hewn_free(by);
    }
    hewn_free(table);
    return no_memory ? fail_memory(error) : HEWN_OK;
}

hewn_result hewn_label_ids_find(const hewn_volume *volume, const hewn_label_desc *desc, hewn_label_ids *out,
                                hewn_error *error)
{
    *out = (hewn_label_ids){0};
    if (desc->frame >= volume->frame_count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no frame %llu; the volume has %llu, counted from 0",
                         (unsigned long long)desc->frame, (unsigned long long)volume->frame_count);
    uint64_t frame_start = hewn_volume_frame_size(volume) * desc->frame, count = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (volume->dims[axis] > UINT32_MAX - 2)
            return hewn_fail(error, HEWN_LIMIT, "the volume is too long");
        out->dims[axis] = volume->dims[axis] + 2;
        count *= out->dims[axis];
    }
    label_set met = {0};
    hewn_result result = count_all(volume, frame_start, &met, error);
    if (result == HEWN_OK)
        result = choose(desc, &met, out, error);
    if (result == HEWN_OK) {
        out->ids = hewn_alloc(count, sizeof *out->ids);
        result = out->ids ? write_ids(volume, frame_start, &met, out, error) : fail_memory(error);
    }
    set_free(&met);
    return result;
}

void hewn_label_ids_free(hewn_label_ids *ids)
{
    hewn_free(ids->ids);
    hewn_free(ids->labels);
    hewn_free(ids->voxel_count);
    *ids = (hewn_label_ids){0};
}
