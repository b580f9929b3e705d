/* What the files of the field room share, and nobody else sees. */
#ifndef HEWN_SRC_FIELD_INTERNAL_H
#define HEWN_SRC_FIELD_INTERNAL_H

#include "field/graph.h"
#include "field/operate.h"

#define HEWN_NO_ID 0xFFFFFFFFu

/* Every field begins with its three variables, so their ids are known. */
enum { HEWN_ID_X = 0, HEWN_ID_Y = 1, HEWN_ID_Z = 2 };

struct hewn_field {
    hewn_node_data *nodes; /* in order of creation; operands come before their users */
    size_t count;
    size_t capacity;
    uint32_t *table; /* open addressing over ids, HEWN_NO_ID where free; size a power of two */
    size_t table_size;
    struct hewn_sampling **samplings; /* that nodes have */
    size_t sampling_count;
    size_t sampling_capacity;
    hewn_error failure; /* the first one; its code is HEWN_OK while there is none */
    uint32_t root;
};

/* Remembers the first failure and gives the node that stands for it. */
hewn_node hewn_field_refuse(hewn_field *field, hewn_result code, const char *format, ...) HEWN_PRINTF(3, 4);

/* NULL when the parameters make sense for the operation, else what is wrong with them. */
const char *hewn_op_complaint(hewn_op op, const double *parameter);

/* Simplifies a node whose operands exist. Either rewrites `data` into the node to add, or, when the value is that of a
 * node already there, returns true with its id. Never adds a node. */
bool hewn_node_fold(const hewn_field *field, hewn_node_data *data, uint32_t *existing);

/* The row (a, b, c, d) of a node that is a x + b y + c z + d; false for any other node. */
bool hewn_node_row(const hewn_field *field, uint32_t id, double row[4]);

/* Noise, which is the same on every device but for the rounding of its sums: noise.c. */
double hewn_noise_point(const hewn_node_data *node, const double in[3]);

/* Value, then the derivatives after the three operands. */
void hewn_noise_slopes(const hewn_node_data *node, const double in[3], double out[4]);
hewn_interval hewn_noise_interval(const hewn_node_data *node, const hewn_interval in[3]);

static inline bool hewn_op_is_noise(hewn_op op)
{
    return op >= HEWN_OP_NOISE_VALUE && op <= HEWN_OP_NOISE_CELLULAR;
}

/* A side of a polygon against a point: square distance and its direction (not of length 1) away from the side, the side
 * the point is on, and whether a ray from it along x crosses. */
typedef struct hewn_side {
    double square, away[2];
    bool crossed;
} hewn_side;

hewn_side hewn_side_of(const double p[4], double x, double y);

/* The nodes under one root, numbered without gaps, so that evaluators need one array and no look-up. */
typedef struct hewn_step {
    const hewn_node_data *node;
    uint32_t in[HEWN_MAX_OPERANDS]; /* positions of the operands' steps, HEWN_NO_ID where unused */
} hewn_step;

typedef struct hewn_tape {
    hewn_step *steps;
    size_t count;
} hewn_tape;

/* Valid until the field is changed. HEWN_INVALID_ARGUMENT for a node of no field. */
hewn_result hewn_tape_create(hewn_tape *tape, const hewn_field *field, hewn_node root, hewn_error *error);
void hewn_tape_destroy(hewn_tape *tape);

/* Bounds of the last step over a box of finite or infinite sides; `scratch` has room for one interval a step. */
hewn_interval hewn_tape_bound(const hewn_tape *tape, const hewn_box *bounds, hewn_interval *scratch);

/* How much a blend takes from min(a, b) at most, where the two are equal. */
double hewn_blend_depth(const hewn_node_data *node);

/* A set of points known to lie in a box (whose sides may be infinite), or to be empty. */
typedef struct hewn_region {
    hewn_box box;
    bool empty;
} hewn_region;

/* A region that contains every point where the last step is below 0, or 0, read off the shapes of the graph alone. */
hewn_result hewn_tape_region(const hewn_tape *tape, const hewn_field *field, hewn_region *out, hewn_error *error);

/* The region that the graph alone tells, whose sides may be infinite; false where it tells that the shape is empty, or
 * nothing for lack of memory. */
bool hewn_field_known_box(const hewn_field *field, hewn_node node, hewn_box *out);

/* hewn_remap without the edges of outlines that lie on x = 0: what turns about that axis has no surface there. */
hewn_node hewn_remap_revolved(hewn_field *field, hewn_node shape, hewn_node x, hewn_node y, hewn_node z);

#endif
