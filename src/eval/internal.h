/* What the files of this room share. */
#ifndef HEWN_SRC_EVAL_INTERNAL_H
#define HEWN_SRC_EVAL_INTERNAL_H

#include "eval/instructions.h"
#include "eval/library.h"
#include "eval/lists.h"
#include "eval/samples.h"

/* The kernels behind the batch functions, made when first asked for. */
typedef struct hewn_batches {
    hewn_program *programs[3];
} hewn_batches;

/* How kernels come by the numbers. */
typedef enum hewn_number_place {
    HEWN_PLACE_CODE,    /* literals */
    HEWN_PLACE_TABLE,   /* from uniforms into a table that a workgroup shares, and from there into variables */
    HEWN_PLACE_UNIFORM, /* read as uniforms where they are used */
    HEWN_PLACE_ADDRESS  /* more than uniforms hold: read through an address that is one */
} hewn_number_place;

/* The uniforms of listed code, as hewn_instruction_set_declare() has them. */
typedef struct hewn_list_block {
    uint64_t numbers, whole, lists, ranges, around, around_ranges, origins;
    uint32_t whole_count, pad;
} hewn_list_block;

struct hewn_code {
    hewn_listing listing;
    bool listed;
    bool chained; /* outlines have no tables */
    hewn_walking walking;
    hewn_instructions
        instructions; /* of listed code; `parameters` holds their words and from `entries_at` on the list */
    uint64_t entries_at;
    hewn_number_place place;
    hewn_library library;
    hewn_library_choice choice;
    hewn_buffer uniforms; /* the parameters, or, where they do not fit a uniform block, their address */
    hewn_buffer parameters;
    hewn_samples samples;  /* whose addresses are among the parameters */
    hewn_batches *batches; /* behind a pointer, since it fills while the code itself is constant */
};

void hewn_batches_destroy(hewn_device *device, hewn_batches *batches);

#endif
