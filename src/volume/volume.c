#include "hewn/volume.h"

#include <math.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"

void hewn_volume_destroy(hewn_volume *volume)
{
    if (volume->mapped && volume->memory)
        munmap(volume->memory, volume->memory_length);
    else
        hewn_free(volume->memory);
    hewn_free(volume->name);
    hewn_free(volume->remark);
    *volume = (hewn_volume){0};
}

uint64_t hewn_volume_frame_size(const hewn_volume *volume)
{
    return (uint64_t)volume->dims[0] * volume->dims[1] * volume->dims[2];
}

const void *hewn_volume_frame(const hewn_volume *volume, uint64_t frame)
{
    if (!volume->samples)
        return NULL;
    return (const char *)volume->samples + frame * hewn_volume_frame_size(volume) * hewn_voxel_size(volume->type);
}

static hewn_result check_counts(const hewn_volume *volume, hewn_error *error)
{
    size_t bytes = hewn_voxel_size(volume->type);
    for (int axis = 0; axis < 3; axis++) {
        if (volume->dims[axis] == 0)
            return hewn_fail(error, HEWN_BAD_INPUT, "the volume has no voxels along axis %d", axis + 1);
        if (__builtin_mul_overflow(bytes, (size_t)volume->dims[axis], &bytes))
            return hewn_fail(error, HEWN_LIMIT, "%u x %u x %u voxels are more than memory can address", volume->dims[0],
                             volume->dims[1], volume->dims[2]);
    }
    if (volume->frame_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "the volume has no frame");
    if (__builtin_mul_overflow(bytes, (size_t)volume->frame_count, &bytes) || bytes > SIZE_MAX / 4)
        return hewn_fail(error, HEWN_LIMIT, "%u x %u x %u voxels, %llu times, are more than memory can address",
                         volume->dims[0], volume->dims[1], volume->dims[2], (unsigned long long)volume->frame_count);
    return HEWN_OK;
}

static hewn_result check_place(const hewn_volume *volume, hewn_error *error)
{
    const double *m = volume->to_world;
    double spacing[3];
    for (int i = 0; i < 12; i++)
        if (!isfinite(m[i]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the voxels' place in the world has a number that is not finite");
    hewn_volume_spacing(volume, spacing);
    for (int axis = 0; axis < 3; axis++)
        if (!(spacing[axis] > 0) || !isfinite(spacing[axis]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the spacing of the voxels along axis %d is %g", axis + 1,
                             spacing[axis]);
    /* The share of the box of these edges that the cell fills: 1 where they are at right angles. */
    double fill = fabs(hewn_volume_determinant(volume)) / spacing[0] / spacing[1] / spacing[2];
    if (!(fill > 1e-6))
        return hewn_fail(error, HEWN_BAD_INPUT,
                         "the directions of the voxels' axes lie in one plane (singular affine)");
    return HEWN_OK;
}

hewn_result hewn_volume_check(const hewn_volume *volume, hewn_error *error)
{
    HEWN_TRY(check_counts(volume, error));
    HEWN_TRY(check_place(volume, error));
    if (!isfinite(volume->slope) || volume->slope == 0 || !isfinite(volume->intercept))
        return hewn_fail(error, HEWN_BAD_INPUT, "values are %g times the sample plus %g, which says nothing",
                         volume->slope, volume->intercept);
    return HEWN_OK;
}

void hewn_volume_forget_samples(const hewn_volume *volume, uint64_t at, uint64_t count)
{
    if (!volume->mapped || volume->blocks)
        return;
    uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
    size_t size = hewn_voxel_size(volume->type);
    uintptr_t begin = (uintptr_t)volume->samples + at * size, end = begin + count * size;
    begin = (begin + page - 1) / page * page; /* pages that samples outside share stay */
    end = end / page * page;
    if (begin < end)
        madvise((void *)begin, end - begin, MADV_DONTNEED); /* a private mapping that nobody writes: nothing is lost */
}

void hewn_volume_forget(const hewn_volume *volume, uint64_t frame, uint32_t k0, uint32_t k1)
{
    uint64_t slice = (uint64_t)volume->dims[0] * volume->dims[1];
    hewn_volume_forget_samples(volume, frame * hewn_volume_frame_size(volume) + k0 * slice, (k1 - k0) * slice);
}
