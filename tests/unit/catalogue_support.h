/* Arguments at random for the functions of the catalogue: what each is meant to take. */
#ifndef HEWN_TEST_CATALOGUE_SUPPORT_H
#define HEWN_TEST_CATALOGUE_SUPPORT_H

#include "field/catalogue.h"
#include "test_field_support.h"

enum { SUPPORT_POINTS = 8 };

/* What pointers of arguments point to. */
typedef struct argument_room {
    double points[3 * SUPPORT_POINTS];
    hewn_curve curves[SUPPORT_POINTS];
} argument_room;

/* An exact distance: to a solid, or to a flat shape at x > 0. */
static inline hewn_node random_operand(random_state *random, hewn_field *f, bool flat)
{
    double size = random_between(random, 0.3, 0.6);
    hewn_node out;
    if (flat) {
        switch (random_below(random, 3)) {
        case 0: out = hewn_circle(f, size); break;
        case 1: out = hewn_rectangle(f, size, 2 * size); break;
        default: out = hewn_star(f, 5, size, 0.5 * size);
        }
        return hewn_translate(f, out, random_between(random, 0.7, 1), random_between(random, -0.3, 0.3), 0);
    }
    switch (random_below(random, 4)) {
    case 0: out = hewn_sphere(f, size); break;
    case 1: out = hewn_box_shape(f, size, 1.4 * size, 2 * size); break;
    case 2: out = hewn_torus(f, size, 0.3 * size); break;
    default: out = hewn_cone(f, size, 0.5 * size, 1.5 * size);
    }
    out = hewn_rotate(f, out, 1, random_between(random, -1, 1), 0.3, random_between(random, 0, 3));
    return hewn_translate(f, out, random_between(random, -0.3, 0.3), random_between(random, -0.3, 0.3),
                          random_between(random, -0.3, 0.3));
}

static inline double random_number(random_state *random, const char *function, const hewn_argument_info *info)
{
    bool thin = strcmp(info->name, "edge") == 0 || strcmp(info->name, "wire") == 0 ||
                strcmp(info->name, "minor") == 0 || strcmp(info->name, "thickness") == 0 ||
                strcmp(info->name, "amount") == 0;
    if (thin ||
        (strcmp(info->name, "radius") == 0 && (strstr(function, "tube") || strcmp(function, "rounded_box") == 0)))
        return random_between(random, 0.05, 0.14);
    if (strcmp(info->name, "period") == 0)
        return random_between(random, 2, 3);
    switch (info->kind) {
    case HEWN_ARGUMENT_POSITIVE: return random_between(random, 0.5, 0.8);
    case HEWN_ARGUMENT_NOT_NEGATIVE: return random_between(random, 0.6, 1.2);
    case HEWN_ARGUMENT_PART: return random_between(random, 0, 1);
    case HEWN_ARGUMENT_ANGLE: return random_between(random, -1, 1);
    case HEWN_ARGUMENT_WHOLE: return floor(fmin(random_between(random, info->least, info->least + 5), info->most));
    case HEWN_ARGUMENT_AXIS: return random_below(random, 3);
    case HEWN_ARGUMENT_NOISE: return random_below(random, 4);
    default: return random_between(random, -0.5, 0.7);
    }
}

/* A loop around (1, 0), so that nothing of it crosses; {0} where numbers make one that bulges. */
static inline void random_points(random_state *random, hewn_argument *out, hewn_argument_kind kind, argument_room *room)
{
    out->count = kind == HEWN_ARGUMENT_POINTS ? 4 : SUPPORT_POINTS;
    for (size_t i = 0; i < out->count; i++) {
        double angle = 2 * M_PI * (double)i / (double)out->count, radius = random_between(random, 0.3, 0.9);
        double x = 1 + radius * cos(angle), y = radius * sin(angle);
        if (kind == HEWN_ARGUMENT_FLAT_POINTS) {
            room->points[2 * i] = x;
            room->points[2 * i + 1] = y;
        } else if (kind == HEWN_ARGUMENT_POINTS) {
            for (int k = 0; k < 3; k++)
                room->points[3 * i + (size_t)k] = random_between(random, -1, 1);
        } else {
            hewn_curve *curve = &room->curves[i];
            curve->degree = 1 + (unsigned)(i % 3);
            for (unsigned k = 0; k < curve->degree; k++) {
                double before = 0.2 * (curve->degree - 1 - k);
                curve->points[k][0] = 1 + radius * cos(angle - before);
                curve->points[k][1] = radius * sin(angle - before);
            }
        }
    }
    out->points = room->points;
    out->curves = room->curves;
}

static inline hewn_node random_call(random_state *random, hewn_field *f, const hewn_function *function,
                                    hewn_argument values[HEWN_ARGUMENTS_MOST], argument_room *room)
{
    int needed, count = hewn_function_arguments(function, &needed);
    memset(values, 0, HEWN_ARGUMENTS_MOST * sizeof *values);
    for (int i = 0; i < count; i++) {
        const hewn_argument_info *info = &function->arguments[i];
        values[i].number = random_number(random, function->name, info);
        if (info->kind == HEWN_ARGUMENT_FIELD)
            values[i].node = random_operand(random, f, function->section == HEWN_SECTION_SPACE);
        if (info->kind == HEWN_ARGUMENT_OPERAND)
            values[i].node = random_below(random, 2)
                                 ? hewn_constant(f, random_between(random, 0, 0.2))
                                 : hewn_mul(f, hewn_constant(f, 0.1), hewn_square(f, hewn_cos(f, hewn_x(f))));
        if (info->kind >= HEWN_ARGUMENT_POINTS)
            random_points(random, &values[i], info->kind, room);
    }
    if (strcmp(function->name, "round_cone") == 0 || strcmp(function->name, "helix") == 0)
        values[2].number += 1;
    return function->build(f, values);
}

/* Whether the function's shapes (of bounded operands) are bounded. */
static inline bool is_bounded_function(const hewn_function *function)
{
    const char *name = function->name;
    return function->section != HEWN_SECTION_SURFACES && function->section != HEWN_SECTION_NOISE &&
           function->section != HEWN_SECTION_FLAT && strcmp(name, "plane") != 0 && strcmp(name, "half_space") != 0 &&
           strcmp(name, "complement") != 0 && strcmp(name, "tile") != 0 && strcmp(name, "mirror_tile") != 0;
}

#endif
