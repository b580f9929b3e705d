/* The values of PLY files, from their bytes or words into arrays of channels. */
#ifndef HEWN_SRC_IO_PLY_VALUES_H
#define HEWN_SRC_IO_PLY_VALUES_H

#include "hewn/mesh.h"
#include "io/ply_header.h"

/* The scalar that holds every value of a type; unsigned 32 bits need a double. */
hewn_scalar hewn_ply_scalar_of(hewn_ply_type type);

/* A run of values in a binary file and where they go. Strides are in bytes. */
typedef struct hewn_ply_run {
    hewn_ply_type type;
    bool big; /* the highest byte first */
    const char *from;
    size_t from_stride;
    hewn_scalar scalar; /* that of the type, or HEWN_SCALAR_DOUBLE */
    char *to;
    size_t to_stride;
    size_t count;
} hewn_ply_run;
void hewn_ply_decode(const hewn_ply_run *run);

/* The next word of a text as a value of a type; HEWN_BAD_INPUT where it is none. */
hewn_result hewn_ply_read_word(hewn_scan *scan, hewn_ply_type type, double *out, hewn_error *error);

/* Puts a value where a scalar stands that can hold it. */
void hewn_ply_store(double value, hewn_scalar scalar, char *to);

#endif
