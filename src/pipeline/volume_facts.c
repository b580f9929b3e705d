#include "pipeline/volume_facts.h"

#include <string.h>

#include "base/clock.h"
#include "base/error.h"
#include "pipeline/json_parts.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"

static hewn_result read_and_measure(hewn_volume_facts *job, hewn_error *error)
{
    job->format = job->read.format != HEWN_VOLUME_UNKNOWN ? job->read.format : hewn_volume_format_of_file(job->path);
    job->read.blocks = true;
    HEWN_TRY(hewn_volume_read(job->path, &job->read, &job->volume, error));
    job->stages[0].end = job->stages[1].begin = hewn_clock_now() - job->began;
    if (job->frame >= job->volume.frame_count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no frame %llu; the volume has %llu, counted from 0",
                         (unsigned long long)job->frame, (unsigned long long)job->volume.frame_count);
    job->range = hewn_volume_find_range(&job->volume, job->frame);
    if (job->iso)
        HEWN_TRY(hewn_iso_find(job->iso, &job->volume, job->frame, &job->iso_value, error));
    job->stages[1].end = hewn_clock_now() - job->began;
    return HEWN_OK;
}

hewn_result hewn_volume_facts_find(hewn_volume_facts *job, hewn_error *error)
{
    job->stages[0] = (hewn_report_stage){.name = "load"};
    job->stages[1] = (hewn_report_stage){.name = "measure"};
    hewn_result result = read_and_measure(job, error);
    if (result != HEWN_OK && result != HEWN_INVALID_ARGUMENT && result != HEWN_CANCELLED)
        return hewn_blame_input(result, job->path, error);
    return result;
}

void hewn_volume_facts_clear(hewn_volume_facts *job)
{
    hewn_volume_destroy(&job->volume);
}

/* --- JSON -------------------------------------------------------------------------------------------------------- */

static void print_place(hewn_json *json, const hewn_volume *volume)
{
    double spacing[3];
    char orientation[4];
    hewn_box bounds = hewn_volume_bounds(volume);
    hewn_volume_spacing(volume, spacing);
    hewn_volume_orientation(volume, orientation);
    hewn_json_vector(json, "spacing", spacing);
    hewn_json_string(json, "unit", volume->unit ? volume->unit->name : NULL);
    hewn_json_string(json, "world", volume->anatomical ? "RAS" : NULL);
    hewn_json_string(json, "orientation", volume->anatomical ? orientation : NULL);
    hewn_json_bool(json, "left_handed", hewn_volume_determinant(volume) < 0);
    hewn_json_array(json, "to_world");
    for (int i = 0; i < 16; i++)
        hewn_json_number(json, NULL, volume->to_world[i]);
    hewn_json_end_array(json);
    hewn_json_box(json, "bounds", &bounds);
}

static void print_values(hewn_json *json, const hewn_volume_facts *job)
{
    const hewn_volume_range *range = &job->range;
    hewn_json_number(json, "slope", job->volume.slope);
    hewn_json_number(json, "intercept", job->volume.intercept);
    hewn_json_bool(json, "hounsfield", job->volume.hounsfield);
    hewn_json_bool(json, "level_set", job->volume.level_set);
    hewn_json_unsigned(json, "frames", job->volume.frame_count);
    hewn_json_unsigned(json, "frame", job->frame);
    hewn_json_object(json, "range");
    hewn_json_number(json, "lo", range->lo);
    hewn_json_number(json, "hi", range->hi);
    hewn_json_unsigned(json, "finite", range->finite_count);
    hewn_json_unsigned(json, "nan", range->nan_count);
    hewn_json_unsigned(json, "infinite", range->infinite_count);
    hewn_json_end_object(json);
    if (job->iso)
        hewn_json_number(json, "iso", job->iso_value);
    else
        hewn_json_string(json, "iso", NULL);
}

hewn_result hewn_volume_facts_write(const hewn_volume_facts *job, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    const hewn_volume *volume = &job->volume;
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_string(&json, "input", job->path);
    hewn_json_string(&json, "format", hewn_volume_format_name(job->format));
    hewn_json_stages(&json, job->stages, 2, job->stages[1].end);
    hewn_json_object(&json, "peak");
    hewn_json_unsigned(&json, "host_bytes", hewn_peak_host_bytes());
    hewn_json_end_object(&json);
    hewn_json_string(&json, "name", volume->name);
    hewn_json_string(&json, "remark", volume->remark);
    hewn_json_array(&json, "dims");
    for (int axis = 0; axis < 3; axis++)
        hewn_json_unsigned(&json, NULL, volume->dims[axis]);
    hewn_json_end_array(&json);
    hewn_json_string(&json, "type", hewn_voxel_name(volume->type));
    print_place(&json, volume);
    print_values(&json, job);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
