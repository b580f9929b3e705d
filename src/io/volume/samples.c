/* From a file's bytes to a volume's samples. No count of a header is believed: it is held against the bytes that are
 * there before anything of its size is allocated. */
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/shim/number.h"
#include "io/unpack.h"
#include "io/volume/source.h"

static bool machine_is_big(void)
{
    return __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
}

void hewn_swap_samples(void *samples, size_t count, size_t size)
{
    uint16_t *two = samples;
    uint32_t *four = samples;
    uint64_t *eight = samples;
    for (size_t i = 0; size == 2 && i < count; i++)
        two[i] = __builtin_bswap16(two[i]);
    for (size_t i = 0; size == 4 && i < count; i++)
        four[i] = __builtin_bswap32(four[i]);
    for (size_t i = 0; size == 8 && i < count; i++)
        eight[i] = __builtin_bswap64(eight[i]);
}

static size_t sample_bytes(const hewn_volume *volume)
{
    return (size_t)(hewn_volume_frame_size(volume) * volume->frame_count) * hewn_voxel_size(volume->type);
}

static void to_machine_order(hewn_volume *volume, void *samples, bool big_endian)
{
    size_t size = hewn_voxel_size(volume->type);
    if (big_endian != machine_is_big())
        hewn_swap_samples(samples, sample_bytes(volume) / size, size);
}

hewn_result hewn_volume_head_check(const hewn_volume_source *source, const hewn_volume *volume, size_t *bytes,
                                   hewn_error *error)
{
    hewn_error reason = {0};
    if (bytes)
        *bytes = 0;
    hewn_result result = hewn_volume_check(volume, &reason);
    if (result != HEWN_OK)
        return hewn_fail_at(error, result, source->name, 0, "%s", reason.message);
    if (bytes)
        *bytes = sample_bytes(volume);
    return HEWN_OK;
}

static hewn_result too_large(const hewn_volume_source *source, size_t bytes, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_LIMIT, source->name, 0, "%zu bytes of samples are over the limit of %llu", bytes,
                        (unsigned long long)hewn_volume_limit(source));
}

/* Memory that the other process has too; all of it is there, so that nobody falls into a hole later. */
static void *map_room(int file, size_t bytes)
{
    if (fallocate(file, 0, 0, (off_t)(HEWN_VOLUME_ROOM_AT + bytes)) != 0)
        return NULL;
    void *block = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, HEWN_VOLUME_ROOM_AT);
    return block == MAP_FAILED ? NULL : block;
}

static hewn_result make_room(const hewn_volume_source *source, size_t bytes, hewn_volume *volume, hewn_error *error)
{
    if (bytes > hewn_volume_limit(source))
        return too_large(source, bytes, error);
    volume->mapped = source->room_file > 0;
    volume->memory = volume->mapped ? map_room(source->room_file, bytes) : hewn_alloc(bytes, 1);
    if (!volume->memory)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, source->name, 0, "out of memory for %zu bytes of samples",
                            bytes);
    volume->memory_length = bytes;
    return HEWN_OK;
}

hewn_result hewn_volume_make_room(const hewn_volume_source *source, hewn_volume *volume, hewn_error *error)
{
    HEWN_TRY(make_room(source, sample_bytes(volume), volume, error));
    volume->samples = volume->memory;
    return HEWN_OK;
}

hewn_result hewn_volume_make_blocks_room(const hewn_volume_source *source, uint64_t bytes, hewn_volume *volume,
                                         hewn_error *error)
{
    HEWN_TRY(make_room(source, bytes, volume, error));
    volume->blocks = volume->memory;
    return HEWN_OK;
}

static hewn_result too_short(const hewn_volume_source *source, size_t bytes, size_t left, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                        "the header tells of %zu bytes of samples, but there are only %zu", bytes, left);
}

hewn_result hewn_volume_take_samples(hewn_volume_source *source, uint64_t offset, bool big_endian, hewn_volume *volume,
                                     hewn_error *error)
{
    size_t bytes = sample_bytes(volume), size = hewn_voxel_size(volume->type);
    size_t left = offset < source->length ? source->length - (size_t)offset : 0;
    if (bytes > left)
        return too_short(source, bytes, left, error);
    const char *from = source->bytes + offset;
    bool ordered = size == 1 || big_endian == machine_is_big(), aligned = (uintptr_t)from % size == 0;
    if (!source->memory || !aligned || (source->mapped && !ordered)) {
        HEWN_TRY(hewn_volume_make_room(source, volume, error));
        memcpy(volume->memory, from, bytes);
    } else {
        volume->memory = source->memory;
        volume->memory_length = source->memory_length;
        volume->mapped = source->mapped;
        volume->samples = from;
        source->memory = NULL;
    }
    if (!ordered)
        to_machine_order(volume, (char *)volume->memory + ((const char *)volume->samples - (char *)volume->memory),
                         big_endian);
    return HEWN_OK;
}

hewn_result hewn_volume_unpack_samples(const hewn_volume_source *source, uint64_t offset, int packing, uint64_t skip,
                                       bool big_endian, hewn_volume *volume, hewn_error *error)
{
    size_t bytes = sample_bytes(volume), length;
    char *unpacked;
    if (bytes > hewn_volume_limit(source) || skip > hewn_volume_limit(source) - bytes)
        return too_large(source, bytes, error);
    if (offset > source->length)
        return too_short(source, bytes, 0, error);
    HEWN_TRY(hewn_unpack_some(source->bytes + offset, source->length - (size_t)offset, (hewn_packing)packing,
                              bytes + (size_t)skip, source->name, source->desc->progress, &unpacked, &length, error));
    if (length < bytes + skip) {
        hewn_free(unpacked);
        return too_short(source, bytes, length < skip ? 0 : length - (size_t)skip, error);
    }
    memmove(unpacked, unpacked + skip, skip > 0 ? bytes : 0);
    volume->memory = unpacked;
    volume->memory_length = bytes;
    volume->samples = unpacked;
    to_machine_order(volume, unpacked, big_endian);
    return HEWN_OK;
}

/* --- text --------------------------------------------------------------------------------------------------------- */

static bool is_between(char c)
{
    return c == ' ' || c == ',' || (c >= '\t' && c <= '\r');
}

/* Stores a number that was read; false where the type does not have it. */
static bool store_integer(hewn_voxel type, void *samples, size_t at, int64_t value)
{
    switch (type) {
#define CASE(enumerator, ctype)                                                                                        \
    case enumerator: ((ctype *)samples)[at] = (ctype)value; return (int64_t)((ctype *)samples)[at] == value;
        CASE(HEWN_VOXEL_INT8, int8_t)
        CASE(HEWN_VOXEL_UINT8, uint8_t)
        CASE(HEWN_VOXEL_INT16, int16_t)
        CASE(HEWN_VOXEL_UINT16, uint16_t)
        CASE(HEWN_VOXEL_INT32, int32_t)
        CASE(HEWN_VOXEL_UINT32, uint32_t)
        CASE(HEWN_VOXEL_INT64, int64_t)
#undef CASE
    case HEWN_VOXEL_UINT64: ((uint64_t *)samples)[at] = (uint64_t)value; return value >= 0;
    case HEWN_VOXEL_HALF:
    case HEWN_VOXEL_FLOAT:
    case HEWN_VOXEL_DOUBLE: break;
    }
    return false;
}

/* The digits of a whole number past what 63 bits hold. */
static const char *parse_large(const char *at, const char *end, uint64_t *out)
{
    const char *begin = at;
    uint64_t value = 0;
    for (; at < end && *at >= '0' && *at <= '9'; at++)
        if (__builtin_mul_overflow(value, (uint64_t)10, &value) ||
            __builtin_add_overflow(value, (uint64_t)(*at - '0'), &value))
            return NULL;
    *out = value;
    return at > begin ? at : NULL;
}

static const char *parse_sample(const char *at, const char *end, hewn_volume *volume, size_t index)
{
    int64_t whole = 0;
    const char *next = NULL;
    switch (volume->type) {
    case HEWN_VOXEL_FLOAT: return hewn_number_parse_float(at, end, (float *)volume->memory + index);
    case HEWN_VOXEL_DOUBLE: return hewn_number_parse_double(at, end, (double *)volume->memory + index);
    case HEWN_VOXEL_UINT64: return parse_large(at, end, (uint64_t *)volume->memory + index);
    default: next = hewn_number_parse_integer(at, end, &whole);
    }
    return next && store_integer(volume->type, volume->memory, index, whole) ? next : NULL;
}

hewn_result hewn_volume_parse_samples(const hewn_volume_source *source, uint64_t offset, hewn_volume *volume,
                                      hewn_error *error)
{
    enum { STEP = 1 << 16 };
    size_t count = sample_bytes(volume) / hewn_voxel_size(volume->type);
    size_t left = offset < source->length ? source->length - (size_t)offset : 0;
    if (count > left / 2 + 1) /* a digit each and something between */
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                            "the header tells of %zu samples, but only %zu bytes of text follow", count, left);
    HEWN_TRY(hewn_volume_make_room(source, volume, error));
    const char *at = source->bytes + (source->length - left), *end = source->bytes + source->length;
    for (size_t i = 0; i < count; i++) {
        while (at < end && is_between(*at))
            at++;
        const char *next = at < end ? parse_sample(at, end, volume, i) : NULL;
        if (!next || (next < end && !is_between(*next)))
            return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0,
                                at < end ? "sample %zu of %zu is not a number of the type %s"
                                         : "the text ends before sample %zu of %zu (%s)",
                                i + 1, count, hewn_voxel_name(volume->type));
        at = next;
        if (i % STEP == 0)
            HEWN_TRY(hewn_progress_report(source->desc->progress, "load", (double)i / (double)count, error));
    }
    return HEWN_OK;
}

/* --- order of axes ------------------------------------------------------------------------------------------------ */

/* Copies one frame whose samples lie `strides` apart. */
static void gather(const char *from, const uint64_t strides[3], const hewn_volume *volume, char *to)
{
    size_t size = hewn_voxel_size(volume->type);
    for (uint32_t k = 0; k < volume->dims[2]; k++) {
        for (uint32_t j = 0; j < volume->dims[1]; j++) {
            const char *row = from + (k * strides[2] + j * strides[1]) * size;
            for (uint32_t i = 0; i < volume->dims[0]; i++, to += size)
                memcpy(to, row + i * strides[0] * size, size);
        }
    }
}

static bool lies_in_order(const hewn_file_axis *axes, size_t axis_count)
{
    int last = 0;
    for (size_t i = 0; i < axis_count; i++) {
        int place = axes[i].axis < 0 ? 3 : axes[i].axis;
        if (axes[i].size != 1 && place < last)
            return false;
        last = axes[i].size != 1 ? place : last;
    }
    return true;
}

hewn_result hewn_volume_reorder(const hewn_volume_source *source, const hewn_file_axis *axes, size_t axis_count,
                                hewn_volume *volume, hewn_error *error)
{
    if (lies_in_order(axes, axis_count))
        return HEWN_OK;
    hewn_volume ordered = *volume;
    uint64_t strides[3] = {0}, stride = 1;
    for (size_t i = 0; i < axis_count; stride *= axes[i].size, i++)
        if (axes[i].axis >= 0)
            strides[axes[i].axis] = stride;
    ordered.memory = NULL;
    ordered.mapped = false;
    HEWN_TRY(hewn_volume_make_room(source, &ordered, error));
    size_t frame_bytes = (size_t)hewn_volume_frame_size(volume) * hewn_voxel_size(volume->type);
    for (uint64_t frame = 0; frame < volume->frame_count; frame++) {
        uint64_t rest = frame, offset = 0;
        stride = 1;
        for (size_t i = 0; i < axis_count; stride *= axes[i].size, i++) {
            if (axes[i].axis < 0) {
                offset += rest % axes[i].size * stride;
                rest /= axes[i].size;
            }
        }
        const char *from = (const char *)volume->samples + offset * hewn_voxel_size(volume->type);
        gather(from, strides, volume, (char *)ordered.memory + frame * frame_bytes);
    }
    volume->name = volume->remark = NULL; /* the new one has them */
    hewn_volume_destroy(volume);
    *volume = ordered;
    return HEWN_OK;
}
