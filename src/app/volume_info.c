#include "app/volume_info.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "base/error.h"
#include "pipeline/volume_facts.h"

static void print_place(const hewn_volume *volume)
{
    double spacing[3];
    char orientation[4];
    const double *m = volume->to_world;
    hewn_box bounds = hewn_volume_bounds(volume);
    hewn_volume_spacing(volume, spacing);
    hewn_volume_orientation(volume, orientation);
    printf("spacing      %g x %g x %g\n", spacing[0], spacing[1], spacing[2]);
    printf("unit         %s\n", volume->unit ? volume->unit->name : "unknown");
    printf("orientation  %s%s\n", volume->anatomical ? orientation : "unknown",
           hewn_volume_determinant(volume) < 0 ? ", left-handed" : "");
    for (int row = 0; row < 3; row++) /* adding 0 takes the sign from a zero */
        printf("%s%12.6g %12.6g %12.6g %12.6g\n", row == 0 ? "to world     " : "             ", m[4 * row] + 0.0,
               m[4 * row + 1] + 0.0, m[4 * row + 2] + 0.0, m[4 * row + 3] + 0.0);
    printf("bounds       %g,%g,%g to %g,%g,%g%s\n", bounds.lo[0], bounds.lo[1], bounds.lo[2], bounds.hi[0],
           bounds.hi[1], bounds.hi[2], volume->anatomical ? " (RAS)" : "");
}

static void print_values(const hewn_volume_facts *job)
{
    const hewn_volume *volume = &job->volume;
    const hewn_volume_range *range = &job->range;
    const char *kind = volume->hounsfield ? " (Hounsfield units)" : volume->level_set ? " (level set)" : "";
    if (volume->slope != 1 || volume->intercept != 0)
        printf("values       %g times the voxel plus %g\n", volume->slope, volume->intercept);
    printf("frames       %" PRIu64 "\n", volume->frame_count);
    if (volume->frame_count > 1)
        printf("frame        %" PRIu64 "\n", job->frame);
    if (range->finite_count > 0)
        printf("range        %g to %g%s\n", range->lo, range->hi, kind);
    else
        printf("range        none: no value is finite\n");
    printf("NaN          %" PRIu64 "\n", range->nan_count);
    printf("infinite     %" PRIu64 "\n", range->infinite_count);
    if (job->iso)
        printf("iso value    %.9g\n", job->iso_value);
}

static hewn_result print_volume(const hewn_volume_facts *job)
{
    const hewn_volume *volume = &job->volume;
    printf("%s: volume (%s)\n", strcmp(job->path, "-") == 0 ? "standard input" : job->path,
           hewn_volume_format_name(job->format));
    if (volume->name)
        printf("name         %s\n", volume->name);
    printf("voxels       %u x %u x %u\n", volume->dims[0], volume->dims[1], volume->dims[2]);
    printf("type         %s\n", hewn_voxel_name(volume->type));
    print_place(volume);
    print_values(job);
    if (volume->remark)
        printf("note         %s\n", volume->remark);
    return HEWN_OK;
}

hewn_result hewn_volume_tell(const char *path, const hewn_volume_arguments *wanted, bool json, hewn_error *error)
{
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(false);
    hewn_volume_facts job = {.path = path,
                             .read = wanted->read,
                             .frame = wanted->frame,
                             .iso = wanted->has_iso ? &wanted->iso : NULL,
                             .began = hewn_started()};
    job.read.progress = &progress;
    hewn_result result = hewn_volume_facts_find(&job, error);
    hewn_progress_end();
    if (result == HEWN_OK)
        result = json ? hewn_volume_facts_write(&job, "-", error) : print_volume(&job);
    hewn_volume_facts_clear(&job);
    return result;
}
