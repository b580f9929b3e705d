/* What the files of this room share. */
#ifndef HEWN_SRC_QUERY_INTERNAL_H
#define HEWN_SRC_QUERY_INTERNAL_H

#include "eval/code.h"
#include "hewn/query.h"
#include "render/octree.h"
#include "shared/query.h"

typedef struct hewn_query_device {
    hewn_device *device; /* NULL: the host answers */
    hewn_code *code;
    hewn_program *program;
    hewn_buffer in, out;
} hewn_query_device;

struct hewn_query {
    hewn_box box;
    double diagonal;
    double steepness; /* no slope in the box is more; infinite where none is known */
    hewn_box wide;    /* the same for a box with much room around, of numbers of single precision */
    double wide_steepness;
    float fine; /* shorter than this nothing is told apart, because coordinates are rounded */
    hewn_octree octree;
    hewn_query_device on;
};

/* A desc with its defaults in place. */
typedef struct hewn_query_limits {
    float tolerance;
    uint32_t most_boxes;
} hewn_query_limits;

/* Finds them; the tolerance is `otherwise` where none is given, and between four times `fine` and `most`.
 * HEWN_INVALID_ARGUMENT. */
hewn_result hewn_query_find_limits(const hewn_query_desc *desc, double otherwise, float fine, double most,
                                   hewn_query_limits *out, hewn_error *error);

/* --- ask.c: values at points ---------------------------------------------------------------------------------------
 */

/* What one thread has. */
typedef struct hewn_asker {
    const hewn_query *query;
    hewn_lane_work work;
} hewn_asker;

hewn_result hewn_asker_create(const hewn_query *query, hewn_asker *out, hewn_error *error);
void hewn_asker_destroy(hewn_asker *asker);

/* The tape that is enough at a point: the whole one outside of the box. */
const hewn_lane_tape *hewn_query_tape_at(const hewn_query *query, const float p[3]);

float hewn_ask_value(hewn_asker *asker, const float p[3]);
float hewn_ask_gradient(hewn_asker *asker, const float p[3], float gradient[3]);

/* The first of HEWN_LANE_BLOCK points between two, evenly, both ends among them, where the field is 0 or below, then
 * halved to `fine`: true where there is one. `*outside` and `*inside` are shares of the way, `*outside` < 0 where the
 * first point is inside already. */
bool hewn_ask_entry(hewn_asker *asker, const float a[3], const float b[3], float *outside, float *inside);

/* Moves a point onto the surface, by Newton's steps together no longer than `most`; true where the field changes its
 * sign there, within `fine`. The normal is unit. */
bool hewn_ask_project(hewn_asker *asker, float p[3], float most, float normal[3]);

/* Moves a point of the surface along it towards `to` as long as it gets nearer. */
void hewn_ask_approach(hewn_asker *asker, const float to[3], float p[3], float normal[3]);

static inline float hewn_apart(const float a[3], const float b[3])
{
    float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return __builtin_sqrtf(x * x + y * y + z * z);
}

/* A bound on the slope in a box, infinite where none is known. */
double hewn_query_slope(const hewn_query *query, const hewn_box *box);

bool hewn_query_holds(const hewn_query *query, const float p[3]); /* in the box */

/* --- boxes.c: boxes to search, the most promising first -------------------------------------------------------------
 */

typedef struct hewn_search_box {
    float lower; /* no answer in it is less */
    float lo[3], hi[3];
    uint32_t cell; /* of the octree; HEWN_NO_CELL below its leaves */
    bool full;     /* all of it is inside */
    const hewn_lane_tape *tape;
} hewn_search_box;

#define HEWN_NO_CELL 0xFFFFFFFFu

hewn_search_box hewn_search_root(const hewn_query *query);

/* The parts of a box that may hold surface, at most eight; with `solid` also those that are all inside. `lower` is that
 * of the whole. */
uint32_t hewn_search_divide(hewn_asker *asker, const hewn_search_box *box, bool solid, hewn_search_box parts[8]);

/* --- search.c, device.c, host.c
 * ---------------------------------------------------------------------------------------------
 */

/* One question: HEWN_QUERY_NEAREST has only `from`. `along` is unit, no component 0. */
typedef struct hewn_question {
    uint32_t kind;
    float from[3], along[3];
    float begin, end, radius;
} hewn_question;

/* Answers one; what is still unknown of the answer is left 0. */
hewn_result hewn_query_search(hewn_asker *asker, const hewn_question *question, const hewn_query_limits *limits,
                              hewn_answer *out, hewn_error *error);

hewn_result hewn_query_open_device(hewn_query *query, hewn_device *device, const hewn_field *field, hewn_node root,
                                   hewn_error *error);
void hewn_query_close_device(hewn_query *query);

/* What the device has no steps left for is not complete, and what rays met has no normals: hewn_query_finish() sees to
 * both. */
hewn_result hewn_query_ask_device(hewn_query *query, const hewn_question *questions, size_t count,
                                  const hewn_query_limits *limits, hewn_answer *answers, hewn_error *error);

/* By all threads: every question, or those that `which` has the indices of; of these, complete ones get normals. */
hewn_result hewn_query_ask_host(const hewn_query *query, const hewn_question *questions, const uint32_t *which,
                                size_t count, const hewn_query_limits *limits, hewn_answer *answers, hewn_error *error);

/* Which part of the progress the questions of a block are. */
typedef struct hewn_query_part {
    const hewn_progress *progress;
    double begin, share;
} hewn_query_part;

/* Does on the host what the device left; between blocks the caller hears how far it is and may cancel. */
hewn_result hewn_query_finish(const hewn_query *query, const hewn_question *questions, size_t count,
                              const hewn_query_limits *limits, const hewn_query_part *part, hewn_answer *answers,
                              hewn_error *error);

/* How many questions to take next, when the last `size` of them took so long. */
size_t hewn_query_next_block(size_t size, size_t least, size_t most, double seconds);

/* --- lengths.c ------------------------------------------------------------------------------------------------------
 */

/* How far a point is from a box, at most what it is. */
float hewn_length_to_box(const float p[3], const float lo[3], const float hi[3]);

/* The same between boxes. */
float hewn_length_between(const float alo[3], const float ahi[3], const float blo[3], const float bhi[3]);

/* Where a ray enters a box that is `more` larger on each side, not before `begin`; *leave is where it leaves.
 * Infinite where it misses or that is past `end`. */
float hewn_ray_enters(const hewn_question *ray, const float lo[3], const float hi[3], float more, float *leave);

/* Where it enters a ball, the same. */
float hewn_ray_meets_ball(const hewn_question *ray, const float middle[3], float radius);

/* The least answer to a question that a box can hold. */
float hewn_question_lower(const hewn_question *question, const float lo[3], const float hi[3]);

#endif
