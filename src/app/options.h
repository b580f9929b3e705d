/* Command lines: each command declares its options in a table, from which both the parser and the help are made. */
#ifndef HEWN_SRC_APP_OPTIONS_H
#define HEWN_SRC_APP_OPTIONS_H

#include <stdio.h>

#include "hewn/base.h"

typedef struct hewn_option {
    char letter;       /* 'o' for -o; 0 where there is none */
    const char *name;  /* "out" for --out; NULL where there is only the letter */
    const char *value; /* what the help calls its value; NULL for a flag */
    const char *help;  /* sentences; the help wraps them */
} hewn_option;

/* Among options: what the help puts above those that follow. */
#define HEWN_OPTIONS_OF(heading)                                                                                       \
    {                                                                                                                  \
        0, NULL, NULL, heading                                                                                         \
    }

/* One option as it was given. */
typedef struct hewn_given {
    const hewn_option *option;
    const char *value; /* NULL for a flag */
} hewn_given;

/* A command line taken apart. Its strings are those of argv. */
typedef struct hewn_arguments {
    const hewn_option *options;
    size_t option_count;
    hewn_given *given; /* in order */
    size_t given_count;
    const char **operands;
    size_t operand_count;
} hewn_arguments;

/* Takes apart argv[0..argc), which starts after the command's name. An option's value is the next argument whatever it
 * looks like, or follows `=` (long) or the letter (short) directly; flags may share a dash; `--` ends the options; `-`
 * is an operand. HEWN_INVALID_ARGUMENT with a hint at what may have been meant; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_arguments_parse(const hewn_option *options, size_t option_count, int argc, char **argv,
                                 hewn_arguments *out, hewn_error *error);
void hewn_arguments_destroy(hewn_arguments *arguments);

/* By the long name, or the letter where there is only that ("D"). The name must be one of the table's. */
bool hewn_arguments_has(const hewn_arguments *arguments, const char *name);
const char *hewn_arguments_value(const hewn_arguments *arguments, const char *name); /* the last; NULL if none */

/* The name among `count` that is nearest to `word`, or NULL where none is near. */
const char *hewn_nearest_name(const char *word, const char *const *names, size_t count);

/* The table as help, wrapped at 80 columns. */
void hewn_options_print(const hewn_option *options, size_t option_count, FILE *file);

#endif
