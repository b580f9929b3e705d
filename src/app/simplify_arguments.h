/* Simplification on the command line: for `simplify`, and in short for `convert` and `mesh`. */
#ifndef HEWN_SRC_APP_SIMPLIFY_ARGUMENTS_H
#define HEWN_SRC_APP_SIMPLIFY_ARGUMENTS_H

#include "app/options.h"
#include "hewn/simplify.h"

#define HEWN_OPTION_SIMPLIFY                                                                                           \
    {                                                                                                                  \
        0, "simplify", "TARGET",                                                                                       \
            "Simplify it on the way, to faces:N, ratio:R or error:LENGTH; `hewn simplify` tells what they mean, and "  \
            "has more."                                                                                                \
    }

/* How a mesh is simplified, whatever the target. */
#define HEWN_OPTIONS_SIMPLIFY_MANNER                                                                                   \
    {0, "lock", "LIST",                                                                                                \
     "What stays, with commas between: boundary, features:ANGLE (edges that bend by more), labels (where faces "       \
     "differ in label, material, group or object)."},                                                                  \
        {0, "preserve", "LIST",                                                                                        \
         "What counts besides the shape, with commas between: uv, normal, color, label, or none. Default: "            \
         "uv,color,label. Normals that do not count are made anew, texture coordinates that do not count are "         \
         "dropped."},                                                                                                  \
    {                                                                                                                  \
        0, "no-self-intersections", NULL, "Make no faces that run through others."                                     \
    }

/* Those; what else is in `out` stays. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_simplify_manner_read(const hewn_arguments *arguments, hewn_simplify_desc *out, hewn_error *error);

/* The options of `hewn simplify`. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_simplify_arguments_read(const hewn_arguments *arguments, hewn_simplify_desc *out, hewn_error *error);

/* --simplify; `*given` tells whether it is there. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_simplify_target_read(const hewn_arguments *arguments, hewn_simplify_desc *out, bool *given,
                                      hewn_error *error);

/* Lines on standard error about what was done. */
void hewn_simplify_print(const hewn_simplify_report *done);

#endif
