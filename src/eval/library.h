/* The GLSL library of operations, of which a kernel takes only the blocks that its field needs. */
#ifndef HEWN_SRC_EVAL_LIBRARY_H
#define HEWN_SRC_EVAL_LIBRARY_H

#include "base/text.h"

enum { HEWN_LIBRARY_NAMES_MAX = 64 };

/* A set of block names, and of what those need in turn. */
typedef struct hewn_library_choice {
    uint64_t bits;
} hewn_library_choice;

/* One of the library's three texts. */
typedef enum hewn_library_text {
    HEWN_LIBRARY_POINT,
    HEWN_LIBRARY_INTERVAL,
    HEWN_LIBRARY_GRADIENT,
    HEWN_LIBRARY_TEXTS
} hewn_library_text;

/* The library cut into blocks. Names are shared by the three texts: choosing `sin` takes the block of that name from
 * each text that is asked for. Plain data that points into the embedded texts. */
typedef struct hewn_library {
    struct {
        const char *name;
        size_t length;
        uint64_t needs; /* directly, over all texts */
    } names[HEWN_LIBRARY_NAMES_MAX];
    size_t count;
} hewn_library;

/* Reads the markers. HEWN_INTERNAL where there are more names than a set holds. */
hewn_result hewn_library_read(hewn_library *out, hewn_error *error);

/* Adds a block by name, with all that it needs. HEWN_INTERNAL for a name that no text has. */
hewn_result hewn_library_choose(const hewn_library *library, const char *name, hewn_library_choice *choice,
                                hewn_error *error);

/* Appends the chosen blocks of one text, in its order. */
void hewn_library_write(const hewn_library *library, hewn_library_choice choice, hewn_library_text which,
                        hewn_text *text);

#endif
