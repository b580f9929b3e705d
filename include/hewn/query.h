/* Questions about where a field's surface is: the nearest point, what a ray or a moving ball meets, how far two solids
 * are apart. Any field will do, not only distances: answers are found by interval bounds, and each comes with the two
 * numbers between which the true one lies.
 *
 * `low` is proven: nothing of the surface is nearer. `high` is that of a place where the field was seen to change its
 * sign. The two differ by at most the tolerance, but for fields whose bounds are poor and questions with very many
 * answers that are alike (the middle of a ball without a known slope), which may need more boxes than are allowed. The
 * field is that of single precision, as devices compute it; numbers are widened by its rounding. */
#ifndef HEWN_QUERY_H
#define HEWN_QUERY_H

#include "hewn/device.h"
#include "hewn/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A field made ready to be asked. */
typedef struct hewn_query hewn_query;

/* Asks about what of the field lies in a box; sides on which the box cuts the solid are no surface. The field may be
 * changed or destroyed afterwards. With a device, questions are answered there, many at once, but for fields of so many
 * operations that devices would walk over lists of them; then, and where `device` is NULL, by all threads of the host,
 * which is also the faster way for a few. The device must outlive the query. Serves one thread at a time.
 * HEWN_INVALID_ARGUMENT for a box without inside or a node of no field; HEWN_LIMIT, HEWN_OUT_OF_MEMORY, device errors.
 */
HEWN_API hewn_result hewn_query_create(hewn_device *device, const hewn_field *field, hewn_node root,
                                       const hewn_box *box, hewn_query **out, hewn_error *error);
HEWN_API void hewn_query_destroy(hewn_query **query);

/* Whether the host answers. */
HEWN_API bool hewn_query_is_on_host(const hewn_query *query);

/* Zero is a sensible default; a NULL pointer to it too. */
typedef struct hewn_query_desc {
    double tolerance;    /* how far `low` and `high` may be apart, in scene units; 0: 1e-4 of the box's diagonal. Less
                            than 4e-6 of it is taken for that */
    uint32_t most_boxes; /* that are divided for one answer; 0: 65,536. Devices look into fewer; what they do not
                            complete is asked again on the host, which has all of them */
    const hewn_progress *progress; /* the stage is "query" */
} hewn_query_desc;

/* What was found. Lengths in scene units. Nothing in the box: `found` is false, `high` infinite, and `low` too, unless
 * there may be something after all that is too small to be seen: then `low` is how near that may be. */
typedef struct hewn_answer {
    double low, high;
    double point[3];  /* on the surface, where `high` was found */
    double normal[3]; /* unit, outward, there; 0 where the field has no gradient */
    bool found;
    bool inside;   /* the point, or where the ray begins, lies where the field is 0 or below */
    bool complete; /* `low` and `high` are within the tolerance, or nothing is there */
} hewn_answer;

/* Coordinates of points, and lengths at which rays begin, are at most this. */
#define HEWN_QUERY_FAR 1073741824.0 /* 2^30 */

/* The point of the surface that is nearest to each of `count` points (x, y, z triples; anywhere, also outside of the
 * box); `high` is its distance, never below 0. `inside` is only told of points in the box. HEWN_INVALID_ARGUMENT for
 * a point that is not finite or beyond HEWN_QUERY_FAR, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED, device errors. */
HEWN_API hewn_result hewn_query_nearest(hewn_query *query, const double *points, size_t count,
                                        const hewn_query_desc *desc, hewn_answer *answers, hewn_error *error);

/* A ray, or a ball whose centre moves along it. */
typedef struct hewn_ray_desc {
    double from[3], along[3]; /* any finite length but 0 */
    double begin, end;        /* lengths along it from `from`, 0 or more; an `end` of 0 is as far as the box */
    double radius;            /* 0: a ray */
} hewn_ray_desc;

/* How far each ray goes, from `from`, until it enters the solid, or until the ball touches it; `point` is where. Where
 * it begins inside, or the ball touches at once, that is `begin`. HEWN_INVALID_ARGUMENT for a number that is not
 * finite, a place, beginning or radius beyond HEWN_QUERY_FAR, a direction of length 0, begin > end or a radius below 0.
 */
HEWN_API hewn_result hewn_query_rays(hewn_query *query, const hewn_ray_desc *rays, size_t count,
                                     const hewn_query_desc *desc, hewn_answer *answers, hewn_error *error);

/* How far two solids are apart. */
typedef struct hewn_clearance {
    double low, high;
    double points[2][3]; /* one in each solid, `high` apart */
    bool found;          /* both were found in their boxes; else `high` is infinite */
    bool overlap;        /* they share points[0], which equals points[1]; then low and high are 0 */
    bool complete;
} hewn_clearance;

/* Between what of two fields lies in the boxes of their queries, on the host. The boxes' cuts count as surface. Where
 * bounds on the fields' slopes are known these are used too, which helps distances most. `desc` as above, its default
 * tolerance 1e-3 of the larger diagonal. */
HEWN_API hewn_result hewn_query_clearance(hewn_query *a, hewn_query *b, const hewn_query_desc *desc,
                                          hewn_clearance *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
