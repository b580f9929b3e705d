#include "eval/samples.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

static const hewn_buffer *find(const hewn_samples *samples, const hewn_sampling *sampling)
{
    for (size_t i = 0; i < samples->count; i++)
        if (samples->held[i].sampling == sampling)
            return &samples->held[i].buffer;
    return NULL;
}

/* In pieces through a buffer that the host writes, where the device has memory of its own. */
static hewn_result copy_over(hewn_device *device, const hewn_sampling *sampling, const hewn_buffer *to,
                             hewn_error *error)
{
    enum { PIECE = 64 << 20 };
    hewn_buffer piece;
    uint64_t bytes = sampling->word_count * sizeof(uint32_t);
    HEWN_TRY(hewn_buffer_create(device, "samples on their way", bytes < PIECE ? bytes : PIECE, HEWN_BUFFER_UPLOAD,
                                &piece, error));
    hewn_result result = HEWN_OK;
    for (uint64_t at = 0; at < bytes && result == HEWN_OK; at += PIECE) {
        uint64_t length = bytes - at < PIECE ? bytes - at : PIECE;
        memcpy(piece.mapped, (const char *)sampling->words + at, length);
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

static hewn_result bring(hewn_device *device, hewn_samples *samples, const hewn_sampling *sampling, hewn_error *error)
{
    void *items = samples->held;
    HEWN_TRY(hewn_reserve(&items, &samples->capacity, samples->count + 1, sizeof *samples->held, error));
    samples->held = items;
    hewn_buffer buffer;
    uint64_t bytes = sampling->word_count * sizeof(uint32_t);
    HEWN_TRY(hewn_buffer_create(device, "samples of a field", bytes, HEWN_BUFFER_DEVICE, &buffer, error));
    samples->held[samples->count++] = (hewn_held_samples){hewn_sampling_share(sampling), buffer};
    if (!buffer.mapped)
        return copy_over(device, sampling, &buffer, error);
    memcpy(buffer.mapped, sampling->words, bytes);
    return HEWN_OK;
}

hewn_result hewn_samples_bring(hewn_device *device, hewn_samples *samples, hewn_listing *listing, hewn_error *error)
{
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        if (!step->samples)
            continue;
        if (!find(samples, step->samples))
            HEWN_TRY(bring(device, samples, step->samples, error));
        hewn_listing_set_address(listing, step, find(samples, step->samples)->address);
    }
    return HEWN_OK;
}

bool hewn_samples_find(const hewn_samples *samples, hewn_listing *listing)
{
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        const hewn_buffer *buffer = step->samples ? find(samples, step->samples) : NULL;
        if (step->samples && !buffer)
            return false;
        if (buffer)
            hewn_listing_set_address(listing, step, buffer->address);
    }
    return true;
}

void hewn_samples_destroy(hewn_device *device, hewn_samples *samples)
{
    for (size_t i = 0; i < samples->count; i++) {
        hewn_buffer_destroy(device, &samples->held[i].buffer);
        hewn_sampling_destroy(&samples->held[i].sampling);
    }
    hewn_free(samples->held);
    *samples = (hewn_samples){0};
}
