/* What the files of this room share. */
#ifndef HEWN_SRC_EVAL_INTERNAL_H
#define HEWN_SRC_EVAL_INTERNAL_H

#include "eval/library.h"
#include "eval/listing.h"

/* The kernels behind the batch functions, made when first asked for. */
typedef struct hewn_batches {
    hewn_program *programs[3];
} hewn_batches;

struct hewn_code {
    hewn_listing listing;
    hewn_library library;
    hewn_library_choice choice;
    hewn_buffer uniforms; /* the parameters, or, where they do not fit a uniform block, their address */
    hewn_buffer parameters;
    hewn_batches *batches; /* behind a pointer, since it fills while the code itself is constant */
};

void hewn_batches_destroy(hewn_device *device, hewn_batches *batches);

#endif
