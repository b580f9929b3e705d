/* A field as a tape that the host runs over many samples at once, in float, and that interval arithmetic cuts down to
 * what matters in a box (Keeter 2020, Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces).
 *
 * Shapes are taken apart into arithmetic, in the order in which shaders compute them, so values have the bits that a
 * device gives which rounds every sum, product and root correctly; operations without a kind of their own are computed
 * in double and rounded, and so are outlines, whose sides are dropped where others are nearer. A min, max or blend is
 * dropped only where the arithmetic returns the other operand's bits: every tape gives the bits of the whole one in its
 * box. Denormals are kept. */
#ifndef HEWN_SRC_LANES_TAPE_H
#define HEWN_SRC_LANES_TAPE_H

#include "field/graph.h"

enum {
    HEWN_LANES = 64,     /* samples or boxes at once; counts are multiples of HEWN_LANE_BLOCK */
    HEWN_LANE_BLOCK = 8, /* floats of a vector */
    HEWN_LANE_INPUTS = 3
};

/* What a step does with registers a, b and c, and its number n. */
typedef enum hewn_lane_kind {
    HEWN_LANE_X,
    HEWN_LANE_Y,
    HEWN_LANE_Z,
    HEWN_LANE_NUMBER, /* n */
    HEWN_LANE_NEG,
    HEWN_LANE_ABS,
    HEWN_LANE_SQRT,
    HEWN_LANE_SQUARE,
    HEWN_LANE_PLUS,  /* a + n */
    HEWN_LANE_TIMES, /* a n */
    HEWN_LANE_LESS,  /* n - a */
    HEWN_LANE_ADD,
    HEWN_LANE_SUB,
    HEWN_LANE_MUL,
    HEWN_LANE_OVER,     /* |a| + n */
    HEWN_LANE_LENGTH,   /* sqrt(a² + b² + c²) + n, of two or three */
    HEWN_LANE_AFFINE,   /* f0 a + f1 b + f2 c + n, of one to three, see hewn_lane_step.node */
    HEWN_LANE_FLOOR_AT, /* max(a, n); the first of the kinds that can be cut */
    HEWN_LANE_CEIL_AT,  /* min(a, n) */
    HEWN_LANE_MIN,
    HEWN_LANE_MAX,
    HEWN_LANE_BLEND, /* the quadratic one of size n */
    HEWN_LANE_OTHER_BLEND,
    HEWN_LANE_OTHER,  /* an operation of the field, see hewn_lane_step.node */
    HEWN_LANE_OUTLINE /* the distance from an outline at (a, b), see hewn_lane_step.node */
} hewn_lane_kind;

/* Factors of an affine form, in the order of its registers. */
typedef float hewn_lane_factors[HEWN_LANE_INPUTS];

/* Small, since a picture needs many thousands of tapes. */
typedef struct hewn_lane_step {
    uint8_t kind;
    uint8_t input_count;
    uint16_t out;                    /* register */
    uint16_t from[HEWN_LANE_INPUTS]; /* registers */
    float number;
    union {
        float inverse; /* of the quadratic blend's size */
        uint32_t node; /* of an operation of the field: which of `others`; of an outline: which of `outlines`; of an
                          affine form: which of `factors` */
    };
} hewn_lane_step;

/* A side of an outline, and what is wanted of it again and again. */
typedef struct hewn_lane_side {
    double from[2], to[2], along[2];
    double square, inverse; /* of its length's square */
} hewn_lane_side;

/* The sides of an outline that can be nearest. The others count by what a ray along x does: it crosses an odd number of
 * them where `odd` says so, and where it does not from each of the heights `turns` on upwards, turn by turn. */
typedef struct hewn_lane_outline {
    hewn_lane_side *sides;
    double *turns;
    uint32_t side_count, turn_count;
    double size; /* no coordinate is larger */
    bool odd;
} hewn_lane_outline;

typedef struct hewn_lane_tape {
    uint32_t count;
    uint32_t registers;
    uint32_t cuts; /* steps that can be cut */
    bool owns;     /* `others` and `factors` are freed with it */
    uint32_t other_count;
    hewn_node_data *others;
    hewn_lane_factors *factors;
    uint32_t outline_count, side_count; /* sides of all outlines */
    hewn_lane_outline *outlines;        /* its own, in the order of their steps; NULL: none */
    hewn_lane_step steps[];             /* the last one is the field */
} hewn_lane_tape;

/* The whole field. It reads what it needs, so the field may change or go. HEWN_INVALID_ARGUMENT for a node of no field,
 * HEWN_LIMIT where the field keeps more than 65,535 values at a time, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_lane_tape_create(const hewn_field *field, hewn_node root, hewn_lane_tape **out, hewn_error *error);
void hewn_lane_tape_destroy(hewn_lane_tape **tape);

/* How long a tape is: its steps, and the sides of its outlines. */
static inline uint32_t hewn_lane_tape_length(const hewn_lane_tape *tape)
{
    return tape->count + tape->side_count;
}

/* What one thread needs to run a tape and all that are cut from it. Zero is the empty one. */
typedef struct hewn_lane_work {
    float *values;             /* a row of HEWN_LANES a register and derivative or bound */
    int32_t *choices;          /* of the last bounds: a row for each step that can be cut */
    uint32_t *scratch;         /* seven for each step */
    uint16_t *held;            /* one for each register */
    float *places;             /* of the last bounds: four rows for each outline, the lower and upper ends of x and y */
    double *distances;         /* one for each side of an outline */
    hewn_lane_outline *picked; /* what a tape's outlines are cut down to, in the same block as their sides */
} hewn_lane_work;

hewn_result hewn_lane_work_create(const hewn_lane_tape *whole, hewn_lane_work *out, hewn_error *error);
void hewn_lane_work_destroy(hewn_lane_work *work);

/* Boxes or points, a row a side. */
typedef struct hewn_lane_boxes {
    float lo[3][HEWN_LANES], hi[3][HEWN_LANES];
} hewn_lane_boxes;

typedef struct hewn_lane_points {
    float at[3][HEWN_LANES];
} hewn_lane_points;

/* Values at the first `count` points. */
void hewn_lanes_value(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_points *points, uint32_t count,
                      float *values);

/* Values, and derivatives after x, y and z, as hewn_field_gradient() has them; those of operations without a kind of
 * their own are difference quotients in double. */
void hewn_lanes_gradient(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_points *points,
                         uint32_t count, float *values, float gradients[3][HEWN_LANES]);

/* Bounds of what hewn_lanes_value() gives in each of the first `count` boxes: [-inf, inf] where it may overflow or be
 * NaN on its way. What can be cut in each is kept for hewn_lane_tape_cut(). */
void hewn_lanes_bound(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_boxes *boxes, uint32_t count,
                      float *lo, float *hi);

/* The tape cut down to what matters in box `lane` of the last bounds, which must be of this tape and known. `*out` is
 * NULL where that is hardly shorter. Tapes that are cut share what the whole one owns. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_lane_tape_cut(const hewn_lane_tape *tape, hewn_lane_work *work, uint32_t lane, hewn_lane_tape **out,
                               hewn_error *error);

#endif
