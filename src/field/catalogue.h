/* Every function that makes a shape or changes one, described once: what it is called, what it takes, what it means,
 * and what may be said of its values. The Lua front end reads arguments by this table, docs/scene.md is written from
 * it, and tests go through it. */
#ifndef HEWN_SRC_FIELD_CATALOGUE_H
#define HEWN_SRC_FIELD_CATALOGUE_H

#include "base/text.h"
#include "hewn/field.h"

typedef enum hewn_argument_kind {
    HEWN_ARGUMENT_FIELD,
    HEWN_ARGUMENT_OPERAND, /* a field, or a number made one */
    HEWN_ARGUMENT_NUMBER,
    HEWN_ARGUMENT_POSITIVE,
    HEWN_ARGUMENT_NOT_NEGATIVE,
    HEWN_ARGUMENT_PART,  /* from 0 to 1 */
    HEWN_ARGUMENT_ANGLE, /* degrees for people, radians in a hewn_argument */
    HEWN_ARGUMENT_WHOLE, /* from `least` to `most` */
    HEWN_ARGUMENT_AXIS,
    HEWN_ARGUMENT_NOISE,       /* a kind of noise */
    HEWN_ARGUMENT_POINTS,      /* a list of {x, y, z} */
    HEWN_ARGUMENT_FLAT_POINTS, /* a list of {x, y} */
    HEWN_ARGUMENT_CURVES       /* a list of {x, y}, {cx, cy, x, y} and {cx, cy, dx, dy, x, y} */
} hewn_argument_kind;

typedef struct hewn_argument_info {
    const char *name;
    hewn_argument_kind kind;
    double least, most; /* of whole numbers */
    bool optional;
    double otherwise; /* its number where it is left out */
} hewn_argument_info;

/* One argument's value. */
typedef struct hewn_argument {
    hewn_node node;
    double number;        /* axes and kinds of noise too */
    const double *points; /* points */
    const hewn_curve *curves;
    size_t count; /* of points or curves */
} hewn_argument;

/* What the values of a function of exact distances are. */
typedef enum hewn_exactness {
    HEWN_EXACT,         /* distances, less than 0 inside */
    HEWN_EXACT_OUTSIDE, /* distances outside, inside no more than the distance */
    HEWN_BOUND,         /* never more than the distance */
    HEWN_LOOSE          /* neither: only the sign is meant */
} hewn_exactness;

typedef enum hewn_section {
    HEWN_SECTION_SOLIDS,
    HEWN_SECTION_FLAT,
    HEWN_SECTION_SPACE, /* flat shapes made solids */
    HEWN_SECTION_SURFACES,
    HEWN_SECTION_NOISE,
    HEWN_SECTION_FILES,
    HEWN_SECTION_COMBINING,
    HEWN_SECTION_CHANGING,
    HEWN_SECTION_PAINT,
    HEWN_SECTION_MOVING,
    HEWN_SECTION_BENDING,
    HEWN_SECTIONS
} hewn_section;

enum { HEWN_ARGUMENTS_MOST = 7 };

typedef struct hewn_function {
    const char *name;
    hewn_section section;
    hewn_exactness exactness;
    double slope; /* no value differs by more than this times the distance (operands: 1); 0: no such number, the bounds
                     are those of interval arithmetic */
    int slope_over;   /* the argument, from 1, that the slope is divided by; 0 for none */
    const char *call; /* how it is written, where the arguments do not say; then Lua reads them by hand */
    const char *meaning;
    hewn_argument_info arguments[HEWN_ARGUMENTS_MOST];
    hewn_node (*build)(hewn_field *field, const hewn_argument *values); /* NULL for other names of one */
} hewn_function;

extern const hewn_function hewn_functions[];
extern const size_t hewn_function_count;

/* How many arguments it takes, and how many of them it needs. */
int hewn_function_arguments(const hewn_function *function, int *needed);

/* The rows of docs/scene.md for one section, with the head of the table. */
void hewn_catalogue_write(hewn_section section, hewn_text *text);

/* The line before and after which a section's table stands in docs/scene.md. */
const char *hewn_section_name(hewn_section section);

#endif
