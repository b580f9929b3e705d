/* Shared by the tests of volumes: a volume whose every sample and place is known, and files of it. */
#ifndef HEWN_TEST_VOLUME_SUPPORT_H
#define HEWN_TEST_VOLUME_SUPPORT_H

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "hewn/volume_io.h"
#include "io/volume/formats.h"
#include "test_model_support.h"

/* Small, no two axes alike, and with samples that tell every voxel from every other where the type has room. */
enum { TRUTH_X = 5, TRUTH_Y = 4, TRUTH_Z = 3, TRUTH_FRAME = TRUTH_X * TRUTH_Y * TRUTH_Z };

/* Oblique, left-handed, anisotropic: the directions are a rotation about (1, 2, 3), the second one turned around. */
typedef struct truth {
    double columns[3][3], origin[3]; /* RAS, mm */
} truth;

static inline truth make_truth(void)
{
    static const double spacing[3] = {0.7, 1.3, 2.9};
    truth out = {.origin = {-12.25, 31.5, 7.125}};
    double angle = 0.6, length = sqrt(14), u[3] = {1 / length, 2 / length, 3 / length};
    double c = cos(angle), s = sin(angle);
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 3; row++) {
            double cross = row == column ? 0 : (column - row + 3) % 3 == 1 ? -u[3 - row - column] : u[3 - row - column];
            double turned = (row == column ? c : 0) + s * cross + (1 - c) * u[row] * u[column];
            out.columns[column][row] = (column == 1 ? -1 : 1) * turned * spacing[column];
        }
    }
    return out;
}

static inline void truth_place(const truth *known, int i, int j, int k, double out[3])
{
    for (int row = 0; row < 3; row++)
        out[row] =
            known->origin[row] + i * known->columns[0][row] + j * known->columns[1][row] + k * known->columns[2][row];
}

/* The sample at a voxel; small enough for int8, negative where there are such, with halves where there are such. */
static inline double truth_sample(hewn_voxel type, int i, int j, int k, int frame)
{
    double value = i + TRUTH_X * (j + TRUTH_Y * k) + 7 * frame;
    bool is_unsigned =
        type == HEWN_VOXEL_UINT8 || type == HEWN_VOXEL_UINT16 || type == HEWN_VOXEL_UINT32 || type == HEWN_VOXEL_UINT64;
    if (hewn_voxel_size(type) > 1 && hewn_voxel_is_integer(type))
        value *= 300;
    if (!hewn_voxel_is_integer(type))
        value = value / 2;
    return is_unsigned ? value : value - 20;
}

/* Appends a sample's bytes. */
static inline void put_sample(hewn_text *text, hewn_voxel type, double value, bool big)
{
    char bytes[8];
    size_t size = hewn_voxel_size(type);
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    /* Half: of numbers that it holds exactly. */
    uint16_t half =
        value == 0 ? 0 : (uint16_t)((bits >> 16 & 0x8000) | ((bits >> 13 & 0x3fc00) - 0x1c000) | (bits >> 13 & 0x3ff));
    int64_t whole = (int64_t)value;
    if (type == HEWN_VOXEL_FLOAT)
        memcpy(bytes, &single, 4);
    else if (type == HEWN_VOXEL_DOUBLE)
        memcpy(bytes, &value, 8);
    else if (type == HEWN_VOXEL_HALF)
        memcpy(bytes, &half, 2);
    else
        memcpy(bytes, &whole, size); /* little-endian */
    for (size_t i = 0; i < size; i++)
        hewn_text_append_bytes(text, &bytes[big ? size - 1 - i : i], 1);
}

static inline void put_samples(hewn_text *text, hewn_voxel type, int frames, bool big)
{
    for (int frame = 0; frame < frames; frame++)
        for (int k = 0; k < TRUTH_Z; k++)
            for (int j = 0; j < TRUTH_Y; j++)
                for (int i = 0; i < TRUTH_X; i++)
                    put_sample(text, type, truth_sample(type, i, j, k, frame), big);
}

static inline void write_text(const char *path, const hewn_text *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text->bytes, 1, text->length, file), text->length);
    assert_int_equal(fclose(file), 0);
}

static inline hewn_volume read_volume(const char *path, const hewn_volume_read_desc *desc)
{
    hewn_volume volume;
    hewn_error error = {0};
    if (hewn_volume_read(path, desc, &volume, &error) != HEWN_OK)
        fail_msg("%s: %s: %s", path, error.file, error.message);
    if (hewn_volume_check(&volume, &error) != HEWN_OK)
        fail_msg("a reader made a bad volume: %s", error.message);
    assert_int_equal((uintptr_t)volume.samples % hewn_voxel_size(volume.type), 0);
    return volume;
}

/* Of every voxel of the truth: its place is that of a voxel of the volume to 1e-4 of a voxel, and its value is there.
 */
static inline void assert_true_places(const hewn_volume *volume, const truth *known, hewn_voxel type, int frames)
{
    double back[12];
    hewn_volume_from_world(volume, back);
    assert_int_equal(hewn_volume_frame_size(volume), TRUTH_FRAME);
    assert_int_equal(volume->frame_count, frames);
    for (int index = 0; index < TRUTH_FRAME * frames; index++) {
        int i = index % TRUTH_X, j = index / TRUTH_X % TRUTH_Y, k = index / (TRUTH_X * TRUTH_Y) % TRUTH_Z;
        int frame = index / TRUTH_FRAME;
        double place[3], ijk[3], nearest[3];
        truth_place(known, i, j, k, place);
        for (int axis = 0; axis < 3; axis++) {
            ijk[axis] = back[4 * axis] * place[0] + back[4 * axis + 1] * place[1] + back[4 * axis + 2] * place[2] +
                        back[4 * axis + 3];
            nearest[axis] = round(ijk[axis]);
            if (!(fabs(ijk[axis] - nearest[axis]) < 1e-4 && nearest[axis] >= 0 && nearest[axis] < volume->dims[axis]))
                fail_msg("voxel (%d, %d, %d) lies at %g along axis %d", i, j, k, ijk[axis], axis);
        }
        uint64_t at =
            (uint64_t)nearest[0] + volume->dims[0] * ((uint64_t)nearest[1] + volume->dims[1] * (uint64_t)nearest[2]);
        double sample = hewn_volume_sample(volume, at + (uint64_t)frame * TRUTH_FRAME);
        if (sample != truth_sample(type, i, j, k, frame))
            fail_msg("voxel (%d, %d, %d) of frame %d is %g, not %g", i, j, k, frame, sample,
                     truth_sample(type, i, j, k, frame));
    }
}

/* Only the samples, in the truth's own order. */
static inline void assert_true_samples(const hewn_volume *volume, hewn_voxel type, int frames)
{
    assert_int_equal(volume->type, type);
    assert_int_equal(volume->dims[0], TRUTH_X);
    assert_int_equal(volume->dims[1], TRUTH_Y);
    assert_int_equal(volume->dims[2], TRUTH_Z);
    assert_int_equal(volume->frame_count, frames);
    for (int index = 0; index < TRUTH_FRAME * frames; index++) {
        int i = index % TRUTH_X, j = index / TRUTH_X % TRUTH_Y, k = index / (TRUTH_X * TRUTH_Y) % TRUTH_Z;
        double wanted = truth_sample(type, i, j, k, index / TRUTH_FRAME);
        assert_true(hewn_volume_sample(volume, (uint64_t)index) == wanted);
    }
}

/* Reads a file's bytes from memory, in a block of exactly their size. Fails as bad input, or as more than there can be,
 * with this message, and leaves nothing. */
static inline void assert_bad_volume(hewn_volume_format_read read, const void *bytes, size_t length, const char *part)
{
    static const hewn_volume_read_desc desc;
    char *copy = malloc(length > 0 ? length : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, length);
    hewn_volume_source source = {.bytes = copy, .length = length, .name = "given", .desc = &desc};
    hewn_volume volume = {.frame_count = 7};
    hewn_error error = {0};
    hewn_result result = read(&source, &volume, &error);
    if ((result != HEWN_BAD_INPUT && result != HEWN_LIMIT) || !strstr(error.message, part))
        fail_msg("result %d: \"%s\" (not \"%s\")", result, error.message, part);
    assert_string_equal(error.file, "given");
    const hewn_volume nothing = {0};
    assert_memory_equal(&volume, &nothing, sizeof volume);
    free(copy);
}

#endif
