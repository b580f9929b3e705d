/* A field as a list of steps with their parameters side by side: what code is written from. */
#ifndef HEWN_SRC_EVAL_LISTING_H
#define HEWN_SRC_EVAL_LISTING_H

#include "base/text.h"
#include "eval/code.h"
#include "eval/outline_table.h"
#include "field/graph.h"

enum { HEWN_AXIS_X = 1, HEWN_AXIS_Y = 2, HEWN_AXIS_Z = 4 };

/* What one node becomes: a call of `function` for the steps `in`, then `parameter_count` parameters. Variables and
 * constants have no function: they are operands only. */
typedef struct hewn_code_step {
    const char *function;
    hewn_op op;
    uint32_t in[HEWN_MAX_OPERANDS]; /* positions in the listing */
    uint32_t in_count;
    uint32_t parameter; /* of the first one */
    uint32_t parameter_count;
    uint32_t axes;                       /* the variables it depends on */
    const struct hewn_sampling *samples; /* of SAMPLED, else NULL */
    uint32_t table;                      /* of an OUTLINE that goes by one: which, from 1 on; else 0 */
    double size;                         /* no value is larger, for coordinates up to HEWN_REACH */
    bool positive;                       /* no value is below 0, nor are the bounds that intervals give */
    bool sure; /* for such coordinates intervals are finite here and in all that it depends on: no NaN, no overflow */
    /* For walks along one axis, see along.c: */
    bool part;     /* it is evaluated anew at each place */
    bool shown;    /* it depends on one variable, and steps of several use it (or it is the root) */
    uint32_t same; /* of those shown: a part with the same function of its one variable */
} hewn_code_step;

typedef struct hewn_listing {
    hewn_code_step *steps; /* operands first, the root last */
    size_t count;
    float *parameters; /* rounded once; what is below the smallest normal number is 0 */
    size_t parameter_count;
    hewn_outline_table *tables; /* of outlines with many sides, whose links are left out */
    size_t table_count;
    bool fixed;   /* numbers are written into the code */
    bool near;    /* what is written is for coordinates up to HEWN_REACH: HEWN_FLAVOUR_NEAR */
    uint32_t row; /* while rows are written side by side: which one, from 1 on; else 0 */
    bool parted;  /* walks along an axis pay, and the steps tell how */
} hewn_listing;

/* Finds what places along one axis share (along.c). */
hewn_result hewn_listing_part(hewn_listing *listing, hewn_error *error);

/* Fills in size, positive and sure from the operands' (reach.c). */
void hewn_code_step_reach(const hewn_listing *listing, hewn_code_step *step);

/* With `chained` outlines are nothing but chains of links, whichever their number. */
hewn_result hewn_listing_create(hewn_listing *out, const hewn_field *field, hewn_node root, bool chained,
                                hewn_error *error);
void hewn_listing_destroy(hewn_listing *listing);

/* A parameter as devices have it. */
float hewn_listing_rounded(double value);

/* An edge of an outline so, with the reciprocal of the square of its length. */
void hewn_listing_round_edge(const double edge[4], float out[HEWN_TABLE_SIDE]);

/* What becomes of a node: whether it is listed at all, and if by a table, which (from 1 on) and of which coordinates.
 */
typedef struct hewn_table_use {
    bool needed;
    uint32_t table;
    uint32_t at[2]; /* nodes */
    uint32_t most;  /* sides that a table of it may have, 0: any number */
} hewn_table_use;

/* Makes the tables of outlines with many sides, none where `chained` (tables.c). Outlines that lie apart and of which
 * the least is taken, as of the letters of a text, are one. `uses` has an entry of zeros for each node. */
hewn_result hewn_listing_make_tables(hewn_listing *listing, const hewn_field *field, const uint32_t *ids, size_t count,
                                     bool chained, hewn_table_use *uses, hewn_error *error);

/* Whether the step reads memory of which it has the address: samples, or a table. */
static inline bool hewn_listing_has_address(const hewn_code_step *step)
{
    return step->samples || step->table;
}

/* Says where on the device that is. */
enum { HEWN_ADDRESS_NUMBERS = 3 };
void hewn_listing_set_address(hewn_listing *listing, const hewn_code_step *step, uint64_t address);

/* Whether operand i is handed over as a bare number: a finite constant, to operations that have a form for it. */
bool hewn_listing_is_plain(const hewn_listing *listing, const hewn_code_step *step, uint32_t i);

/* Whether the step's interval, or an operand's, may not be finite, so that f_guard must look. */
bool hewn_listing_needs_guard(const hewn_listing *listing, const hewn_code_step *step);

/* About how many instructions of a processor the step takes at a point. */
uint32_t hewn_listing_weight(const hewn_code_step *step);

/* What listing.c and along.c write with: a type, and steps that `wanted` picks, as declarations and statements. */
typedef enum hewn_listing_flavour {
    HEWN_LISTING_POINT,
    HEWN_LISTING_INTERVAL,
    HEWN_LISTING_GRADIENT
} hewn_listing_flavour;
typedef bool (*hewn_step_filter)(const hewn_code_step *step);
void hewn_listing_write_steps(const hewn_listing *listing, hewn_listing_flavour flavour, hewn_step_filter wanted,
                              hewn_text *text);
void hewn_listing_write_root(const hewn_listing *listing, hewn_listing_flavour flavour, hewn_text *text);
void hewn_listing_write_along(const hewn_listing *listing, hewn_text *text);

/* Appends the functions of `flavours`; the library must precede. Parameter i is P(i), or, where numbers are `fixed`, a
 * literal. */
void hewn_listing_write(const hewn_listing *listing, uint32_t flavours, hewn_text *text);

#endif
