#include <math.h>
#include <string.h>

#include "base/error.h"
#include "hewn/model.h"

/* Where the axes of a model go when its up axis is turned to +Y: row i has `sign` at column `axis`. Each is a quarter
 * turn about an axis that is not the up axis. */
typedef struct turn {
    int axis[3], sign[3];
} turn;

static const turn to_plus_y[] = {
    [HEWN_AXIS_PLUS_Y] = {{0, 1, 2}, {1, 1, 1}},
    [HEWN_AXIS_PLUS_Z] = {{0, 2, 1}, {1, 1, -1}},
    [HEWN_AXIS_PLUS_X] = {{1, 0, 2}, {-1, 1, 1}},
};

/* By way of +Y: what one axis needs to get there, then the other one's turn backwards. */
static turn turn_between(hewn_axis before, hewn_axis after)
{
    const turn *there = &to_plus_y[before], *back = &to_plus_y[after];
    turn result = {{0}, {0}};
    for (int row = 0; row < 3; row++) {
        int to = back->axis[row];
        result.axis[to] = there->axis[row];
        result.sign[to] = there->sign[row] * back->sign[row];
    }
    return result;
}

static uint64_t common_factor(uint64_t a, uint64_t b)
{
    while (b > 0) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static void set_scale(hewn_conversion *record)
{
    const hewn_unit *before = record->unit_before, *after = record->unit_after;
    record->scale_numerator = record->scale_denominator = 1;
    if (!before || before == after)
        return;
    uint64_t numerator = (uint64_t)before->numerator * after->denominator;
    uint64_t denominator = (uint64_t)before->denominator * after->numerator;
    uint64_t factor = common_factor(numerator, denominator);
    record->scale_numerator = numerator / factor;
    record->scale_denominator = denominator / factor;
}

static bool is_unit(const hewn_unit *unit)
{
    return unit->numerator > 0 && unit->denominator > 0;
}

static hewn_result check(const hewn_model *model, const hewn_unit *unit, const hewn_axis *up, hewn_error *error)
{
    if ((unit && !is_unit(unit)) || (model->unit && !is_unit(model->unit)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a unit without length");
    if ((up && (unsigned)*up > HEWN_AXIS_PLUS_X) || (unsigned)model->up > HEWN_AXIS_PLUS_X)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an unknown up axis");
    return HEWN_OK;
}

static double scaled(double value, const hewn_conversion *record)
{
    return value * (double)record->scale_numerator / (double)record->scale_denominator;
}

static hewn_result check_scale(const hewn_model *model, const hewn_conversion *record, hewn_error *error)
{
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++)
        if (!isfinite(scaled(model->positions[i], record)))
            return hewn_fail(error, HEWN_LIMIT, "vertex %llu lies too far out to be given in %s",
                             (unsigned long long)(i / 3), record->unit_after->name);
    return HEWN_OK;
}

static void turn_doubles(const turn *by, double *values)
{
    double old[3] = {values[0], values[1], values[2]};
    for (int axis = 0; axis < 3; axis++)
        values[axis] = by->sign[axis] < 0 ? -old[by->axis[axis]] : old[by->axis[axis]];
}

static void turn_floats(const turn *by, float *values)
{
    float old[3] = {values[0], values[1], values[2]};
    for (int axis = 0; axis < 3; axis++)
        values[axis] = by->sign[axis] < 0 ? -old[by->axis[axis]] : old[by->axis[axis]];
}

/* Normals have three components. Tangents may have a fourth, a sign, that no rotation changes. */
static bool is_direction(const hewn_attribute_info *info)
{
    bool real = info->scalar == HEWN_SCALAR_FLOAT || info->scalar == HEWN_SCALAR_DOUBLE;
    return real && ((strcmp(info->name, "normal") == 0 && info->components == 3) ||
                    (strcmp(info->name, "tangent") == 0 && (info->components == 3 || info->components == 4)));
}

static void turn_directions(hewn_model *model, const turn *by)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        hewn_channel *channel = &model->channels[i];
        if (!is_direction(&channel->info))
            continue;
        uint64_t count = hewn_model_domain_count(model, channel->info.domain);
        for (uint64_t at = 0; at < count * channel->info.components; at += channel->info.components) {
            if (channel->info.scalar == HEWN_SCALAR_FLOAT)
                turn_floats(by, (float *)channel->values + at);
            else
                turn_doubles(by, (double *)channel->values + at);
        }
    }
}

static void write_rotation(const turn *by, int8_t rotation[9])
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            rotation[3 * row + column] = (int8_t)(by->axis[row] == column ? by->sign[row] : 0);
}

hewn_result hewn_model_convert(hewn_model *model, const hewn_unit *unit, const hewn_axis *up, hewn_conversion *record,
                               hewn_error *error)
{
    if (record)
        *record = (hewn_conversion){0};
    HEWN_TRY(check(model, unit, up, error));
    hewn_conversion done = {
        .unit_before = model->unit,
        .unit_after = unit ? unit : model->unit,
        .unit_assumed = unit && !model->unit,
        .up_before = model->up_known || !up ? model->up : *up,
        .up_after = up ? *up : model->up,
        .up_assumed = up && !model->up_known,
    };
    set_scale(&done);
    turn by = turn_between(done.up_before, done.up_after);
    write_rotation(&by, done.rotation);
    bool scales = done.scale_numerator != done.scale_denominator, turns = done.up_before != done.up_after;
    if (scales)
        HEWN_TRY(check_scale(model, &done, error));
    for (uint64_t i = 0; scales && i < 3 * model->vertex_count; i++)
        model->positions[i] = scaled(model->positions[i], &done);
    for (uint64_t v = 0; turns && v < model->vertex_count; v++)
        turn_doubles(&by, model->positions + 3 * v);
    if (turns)
        turn_directions(model, &by);
    model->unit = done.unit_after;
    model->up = done.up_after;
    model->up_known = model->up_known || up;
    if (record)
        *record = done;
    return HEWN_OK;
}
