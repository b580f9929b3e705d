/* Items are put into blocks by all threads at once, and the blocks are written in their order: a thread whose block is
 * the next one writes it and those behind it that are full, while the others fill more. So what puts the items and what
 * takes the bytes, which for a large file is the system's copy of them, go on at the same time. */
#include "io/stream.h"

#include <omp.h>
#include <pthread.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

enum {
    BLOCK = 1 << 18, /* bytes */
    LARGE = 1 << 22, /* a block of more than that is put by whoever writes it, item by item */
    MOST_THREADS = 8,
    SLOTS_EACH = 4 /* a thread: how far those that fill may be ahead */
};

/* A block that is being filled, or waits to be written. */
typedef struct slot {
    char *bytes;
    size_t room, length;
    bool full, large;
} slot;

typedef struct belt {
    const hewn_writing *job;
    const hewn_stream *stream;
    hewn_output *output;
    uint64_t each, blocks; /* items in a block */
    uint32_t slot_count;
    slot *slots;
    /* What follows belongs to whoever has the lock. */
    pthread_mutex_t lock;
    pthread_cond_t change;
    uint64_t taken, written; /* blocks */
    bool writing;
    hewn_result result; /* the first that failed */
    hewn_error failure;
} belt;

/* --- a block ------------------------------------------------------------------------------------------------------ */

static size_t room_of(const belt *on, uint64_t item)
{
    return on->stream->room_of ? on->stream->room_of(on->job, item) : on->stream->room;
}

static uint64_t end_of(const belt *on, uint64_t block)
{
    return block + 1 < on->blocks ? (block + 1) * on->each : on->stream->count;
}

/* Room for all items of a block, or more than LARGE. */
static size_t block_room(const belt *on, uint64_t block)
{
    const uint64_t begin = block * on->each, end = end_of(on, block);
    size_t sum = 0;
    if (!on->stream->room_of)
        return on->stream->room > LARGE ? on->stream->room : (size_t)(end - begin) * on->stream->room;
    for (uint64_t i = begin; i < end && sum <= LARGE; i++) {
        size_t room = room_of(on, i);
        sum += room < LARGE ? room : LARGE + 1;
    }
    return sum;
}

static hewn_result make_room(slot *to, size_t needed, hewn_error *error)
{
    if (to->bytes && to->room >= needed)
        return HEWN_OK;
    hewn_free(to->bytes);
    to->bytes = hewn_alloc(needed, 1);
    to->room = to->bytes ? needed : 0;
    return to->bytes ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
}

static char *put_items(const belt *on, uint64_t begin, uint64_t end, char *to)
{
    if (on->stream->put_run)
        return on->stream->put_run(on->job, begin, end, to);
    for (uint64_t i = begin; i < end; i++)
        to = on->stream->put(on->job, i, to);
    return to;
}

static hewn_result fill(const belt *on, uint64_t block, slot *to, hewn_error *error)
{
    const size_t needed = block_room(on, block);
    to->large = needed > LARGE;
    to->length = 0;
    if (to->large)
        return HEWN_OK;
    HEWN_TRY(make_room(to, needed, error));
    to->length = (size_t)(put_items(on, block * on->each, end_of(on, block), to->bytes) - to->bytes);
    return HEWN_OK;
}

static hewn_result write_block(const belt *on, uint64_t block, slot *from, hewn_error *error)
{
    if (!from->large)
        return hewn_output_write(on->output, from->bytes, from->length, error);
    for (uint64_t i = block * on->each; i < end_of(on, block); i++) {
        HEWN_TRY(make_room(from, room_of(on, i), error));
        const char *end = put_items(on, i, i + 1, from->bytes);
        HEWN_TRY(hewn_output_write(on->output, from->bytes, (size_t)(end - from->bytes), error));
    }
    return HEWN_OK;
}

/* --- the threads -------------------------------------------------------------------------------------------------- */

/* The callback is the caller's, and hears from its thread only. */
static hewn_result report(const belt *on, uint64_t written, hewn_error *error)
{
    const double share = (double)written / (double)on->blocks;
    if (omp_get_thread_num() != 0)
        return HEWN_OK;
    return hewn_progress_report(on->job->progress, "write", on->stream->begin + on->stream->span * share, error);
}

static void note(belt *on, hewn_result result, const hewn_error *error)
{
    if (result == HEWN_OK || on->result != HEWN_OK)
        return;
    on->result = result;
    on->failure = *error;
    pthread_cond_broadcast(&on->change);
}

/* Takes the next block to be filled; waits where all slots are in use. */
static bool take(belt *on, uint64_t *block)
{
    while (on->result == HEWN_OK && on->taken < on->blocks && on->taken - on->written >= on->slot_count)
        pthread_cond_wait(&on->change, &on->lock);
    if (on->result != HEWN_OK || on->taken == on->blocks)
        return false;
    *block = on->taken++;
    return true;
}

/* Writes the blocks whose turn it is, where nobody does. Those who wait for a slot are woken when half of them are
 * free: waking takes time that the next write need not wait for. */
static void write_ready(belt *on)
{
    if (on->writing)
        return;
    on->writing = true;
    while (on->result == HEWN_OK && on->written < on->taken && on->slots[on->written % on->slot_count].full) {
        hewn_error error = {0};
        const uint64_t block = on->written;
        slot *from = &on->slots[block % on->slot_count];
        pthread_mutex_unlock(&on->lock);
        hewn_result result = write_block(on, block, from, &error);
        if (result == HEWN_OK)
            result = report(on, block + 1, &error);
        pthread_mutex_lock(&on->lock);
        note(on, result, &error);
        from->full = false;
        on->written++;
        if (on->taken - on->written == on->slot_count / 2)
            pthread_cond_broadcast(&on->change);
    }
    on->writing = false;
    pthread_cond_broadcast(&on->change);
}

static void work(belt *on)
{
    uint64_t block;
    pthread_mutex_lock(&on->lock);
    while (take(on, &block)) {
        hewn_error error = {0};
        const uint64_t written = on->written;
        slot *to = &on->slots[block % on->slot_count];
        pthread_mutex_unlock(&on->lock);
        hewn_result result = fill(on, block, to, &error);
        if (result == HEWN_OK)
            result = report(on, written, &error);
        pthread_mutex_lock(&on->lock);
        note(on, result, &error);
        to->full = true;
        write_ready(on);
    }
    pthread_mutex_unlock(&on->lock);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(belt *on, int threads, hewn_error *error)
{
    if (pthread_mutex_init(&on->lock, NULL) != 0)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    if (pthread_cond_init(&on->change, NULL) != 0) {
        pthread_mutex_destroy(&on->lock);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    }
#pragma omp parallel num_threads(threads) if (threads > 1)
    work(on);
    pthread_cond_destroy(&on->change);
    pthread_mutex_destroy(&on->lock);
    if (on->result != HEWN_OK && error)
        *error = on->failure;
    return on->result;
}

hewn_result hewn_stream_write(const hewn_writing *job, const hewn_stream *stream, hewn_output *output,
                              hewn_error *error)
{
    belt on = {.job = job, .stream = stream, .output = output, .each = HEWN_WRITE_BLOCK};
    if (stream->count == 0)
        return HEWN_OK;
    if (!stream->room_of && stream->room > BLOCK / HEWN_WRITE_BLOCK)
        on.each = stream->room < BLOCK ? BLOCK / stream->room : 1;
    on.blocks = (stream->count - 1) / on.each + 1;
    const uint64_t most = (uint64_t)omp_get_max_threads() < on.blocks ? (uint64_t)omp_get_max_threads() : on.blocks;
    const int threads = most < MOST_THREADS ? (int)most : MOST_THREADS;
    on.slot_count = (uint32_t)threads * SLOTS_EACH;
    on.slots = hewn_alloc_zero(on.slot_count, sizeof *on.slots);
    if (!on.slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    hewn_result result = run(&on, threads, error);
    for (uint32_t i = 0; i < on.slot_count; i++)
        hewn_free(on.slots[i].bytes);
    hewn_free(on.slots);
    return result == HEWN_OK ? hewn_progress_report(job->progress, "write", stream->begin + stream->span, error)
                             : result;
}
