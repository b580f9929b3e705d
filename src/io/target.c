#include "io/target.h"

#include "base/error.h"

hewn_result hewn_target_find(const hewn_writing *job, const hewn_unit *unit, hewn_axis up, hewn_conversion *out,
                             hewn_error *error)
{
    hewn_model empty = {.unit = job->unit, .up = job->up, .up_known = job->up_known};
    return hewn_model_convert(&empty, unit, &up, out, error);
}

bool hewn_target_changes(const hewn_conversion *conversion)
{
    bool scales = conversion->unit_before && conversion->unit_before != conversion->unit_after;
    return scales || conversion->up_before != conversion->up_after;
}

void hewn_target_turn(const hewn_conversion *conversion, const double in[3], double out[3])
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (conversion->rotation[3 * row + column] != 0)
                out[row] = conversion->rotation[3 * row + column] < 0 ? -in[column] : in[column];
}

void hewn_target_convert(const hewn_conversion *conversion, const double in[3], double out[3])
{
    double scaled[3];
    for (int axis = 0; axis < 3; axis++)
        scaled[axis] = in[axis] * (double)conversion->scale_numerator / (double)conversion->scale_denominator;
    hewn_target_turn(conversion, scaled, out);
}

void hewn_target_print(const hewn_conversion *conversion, hewn_text *text)
{
    hewn_text_print(text, "{\"from\":{\"unit\":\"%s\",\"up\":\"%s\"},\"to\":{\"unit\":\"%s\",\"up\":\"%s\"},",
                    conversion->unit_before ? conversion->unit_before->name : "unknown",
                    hewn_axis_name(conversion->up_before), conversion->unit_after->name,
                    hewn_axis_name(conversion->up_after));
    hewn_text_print(text, "\"scale\":[%llu,%llu],\"rotation\":[", (unsigned long long)conversion->scale_numerator,
                    (unsigned long long)conversion->scale_denominator);
    for (int i = 0; i < 9; i++)
        hewn_text_print(text, "%s%d", i ? "," : "", conversion->rotation[i]);
    hewn_text_append(text, "]}");
}
