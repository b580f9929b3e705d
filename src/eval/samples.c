#include "eval/samples.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* Words that a step reads. */
typedef struct wanted {
    const hewn_sampling *sampling; /* or NULL: of a table */
    const uint32_t *words;
    size_t count;
} wanted;

static wanted wanted_by(const hewn_listing *listing, const hewn_code_step *step)
{
    if (step->samples)
        return (wanted){step->samples, step->samples->words, step->samples->word_count};
    const hewn_outline_table *table = &listing->tables[step->table - 1];
    return (wanted){NULL, table->words, table->word_count};
}

/* Tables are made anew with each listing, so their words tell whether they are the same. */
static const hewn_buffer *find(const hewn_samples *samples, const wanted *of)
{
    for (size_t i = 0; i < samples->count; i++) {
        const hewn_held_samples *held = &samples->held[i];
        bool same = of->sampling ? held->sampling == of->sampling
                                 : !held->sampling && held->word_count == of->count &&
                                       memcmp(held->words, of->words, of->count * sizeof *of->words) == 0;
        if (same)
            return &held->buffer;
    }
    return NULL;
}

/* In pieces through a buffer that the host writes, where the device has memory of its own. */
static hewn_result copy_over(hewn_device *device, const wanted *from, const hewn_buffer *to, hewn_error *error)
{
    enum { PIECE = 64 << 20 };
    hewn_buffer piece;
    uint64_t bytes = from->count * sizeof(uint32_t);
    HEWN_TRY(hewn_buffer_create(device, "samples on their way", bytes < PIECE ? bytes : PIECE, HEWN_BUFFER_UPLOAD,
                                &piece, error));
    hewn_result result = HEWN_OK;
    for (uint64_t at = 0; at < bytes && result == HEWN_OK; at += PIECE) {
        uint64_t length = bytes - at < PIECE ? bytes - at : PIECE;
        memcpy(piece.mapped, (const char *)from->words + at, length);
        hewn_commands *commands;
        result = hewn_commands_begin(device, &commands, error);
        if (result != HEWN_OK)
            break;
        hewn_commands_copy(commands, &piece, 0, to, at, length);
        result = hewn_commands_submit(&commands, NULL, error);
    }
    hewn_buffer_destroy(device, &piece);
    return result;
}

static hewn_result bring(hewn_device *device, hewn_samples *samples, const wanted *of, hewn_error *error)
{
    void *items = samples->held;
    HEWN_TRY(hewn_reserve(&items, &samples->capacity, samples->count + 1, sizeof *samples->held, error));
    samples->held = items;
    hewn_held_samples *held = &samples->held[samples->count];
    *held = (hewn_held_samples){.word_count = of->count};
    uint64_t bytes = of->count * sizeof(uint32_t);
    if (!of->sampling && !(held->words = hewn_alloc(of->count, sizeof *held->words)))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the table of an outline");
    hewn_result result =
        hewn_buffer_create(device, "samples of a field", bytes, HEWN_BUFFER_DEVICE, &held->buffer, error);
    if (result != HEWN_OK) {
        hewn_free(held->words);
        return result;
    }
    samples->count++;
    if (of->sampling)
        held->sampling = hewn_sampling_share(of->sampling);
    else
        memcpy(held->words, of->words, bytes);
    if (!held->buffer.mapped)
        return copy_over(device, of, &held->buffer, error);
    memcpy(held->buffer.mapped, of->words, bytes);
    return HEWN_OK;
}

hewn_result hewn_samples_bring(hewn_device *device, hewn_samples *samples, hewn_listing *listing, hewn_error *error)
{
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        if (!hewn_listing_has_address(step))
            continue;
        const wanted of = wanted_by(listing, step);
        if (!find(samples, &of))
            HEWN_TRY(bring(device, samples, &of, error));
        hewn_listing_set_address(listing, step, find(samples, &of)->address);
    }
    return HEWN_OK;
}

bool hewn_samples_find(const hewn_samples *samples, hewn_listing *listing)
{
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        if (!hewn_listing_has_address(step))
            continue;
        const wanted of = wanted_by(listing, step);
        const hewn_buffer *buffer = find(samples, &of);
        if (!buffer)
            return false;
        hewn_listing_set_address(listing, step, buffer->address);
    }
    return true;
}

void hewn_samples_destroy(hewn_device *device, hewn_samples *samples)
{
    for (size_t i = 0; i < samples->count; i++) {
        hewn_buffer_destroy(device, &samples->held[i].buffer);
        hewn_sampling_destroy(&samples->held[i].sampling);
        hewn_free(samples->held[i].words);
    }
    hewn_free(samples->held);
    *samples = (hewn_samples){0};
}
