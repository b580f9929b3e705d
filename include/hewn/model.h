/* A model: what a mesh file holds. Polygons over shared vertices as they were written, of which nothing is promised but
 * that indices are in range and positions finite; attributes; unit and axes. Readers make models, writers take them,
 * and hewn_mesh_from_model() makes a half-edge mesh of one. */
#ifndef HEWN_MODEL_H
#define HEWN_MODEL_H

#include "hewn/repair.h"
#include "hewn/units.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One attribute: `components` scalars for each vertex, corner (in the order of hewn_model.corners) or face. Names that
 * formats know are those of hewn_attribute_info, and for faces "object", "group" and "material" (1 INT32 with names).
 * Values of INT32 may have names: value i is called names[i]; other values have none. */
typedef struct hewn_channel {
    hewn_attribute_info info; /* its name is the model's */
    void *values;
    char **names;
    uint32_t *slots; /* hewn_channel_value()'s table of names; NULL where it was not called */
    uint32_t name_count, slot_count;
} hewn_channel;

/* Zero is the empty model. Everything is owned by it, from the heap; move it by assignment and leave it with
 * hewn_model_destroy(). Face f has the corners corners[first[f]] to corners[first[f + 1] - 1], counter-clockwise seen
 * from outside; where `first` is NULL all faces are triangles. */
typedef struct hewn_model {
    uint64_t vertex_count, face_count;
    double *positions; /* vertex_count × 3, in the model's unit */
    uint64_t *first;   /* face_count + 1, or NULL */
    uint32_t *corners;
    hewn_channel *channels;
    uint32_t channel_count;
    const hewn_unit *unit; /* NULL: the file says none */
    hewn_axis up;
    bool up_known; /* whether the file says so */
} hewn_model;

HEWN_API void hewn_model_destroy(hewn_model *model);

/* A model of its own with the same bits. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_model_copy(const hewn_model *model, hewn_model *out, hewn_error *error);

/* The entries of `corners`. */
HEWN_API uint64_t hewn_model_corner_count(const hewn_model *model);

/* How many elements a domain has. */
HEWN_API uint64_t hewn_model_domain_count(const hewn_model *model, hewn_domain domain);

/* The polygons alone; a view that lives as long as the model is unchanged. */
HEWN_API hewn_polygons hewn_model_polygons(const hewn_model *model);

/* Adds a channel of zeroes; vertices and faces must be there already. Its name is copied. HEWN_INVALID_ARGUMENT for a
 * name taken in that domain or empty, or bad components; HEWN_OUT_OF_MEMORY. `*out` stays the model's; it is valid
 * until the next one is added. */
HEWN_API hewn_result hewn_model_add_channel(hewn_model *model, const hewn_attribute_info *info, hewn_channel **out,
                                            hewn_error *error);

/* The channel of a name, or NULL. */
HEWN_API hewn_channel *hewn_model_find_channel(const hewn_model *model, hewn_domain domain, const char *name);

/* The value that has this name in an INT32 channel; the name is added where it is new. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_channel_value(hewn_channel *channel, const char *name, int32_t *out, hewn_error *error);

/* Checks what every model promises: arrays there, `first` rising, indices in range, positions finite. HEWN_BAD_INPUT
 * names the first offender; HEWN_INVALID_ARGUMENT for a missing array. */
HEWN_API hewn_result hewn_model_check(const hewn_model *model, hewn_error *error);

/* What hewn_model_convert() did: p' = (scale_numerator / scale_denominator) R p, where R turns one up axis to the other
 * (rows of +1, -1 and 0). Positions are multiplied, then divided, each rounded once. */
typedef struct hewn_conversion {
    const hewn_unit *unit_before, *unit_after; /* before: NULL where it was assumed to be the same */
    hewn_axis up_before, up_after;
    bool unit_assumed, up_assumed; /* neither the file nor the caller said so: taken for the target's own */
    uint64_t scale_numerator, scale_denominator; /* without common factors */
    int8_t rotation[9];                          /* row-major */
} hewn_conversion;

/* Brings a model to a unit (NULL: stays) and an up axis (NULL: stays), directions ("normal", and "tangent" of 3 or 4
 * components) with it; the bits of a model that is there already stay as they are. Who knows better than the file what
 * it is in sets `unit`, `up` and `up_known` first. `record` may be NULL. HEWN_LIMIT where a position would not stay
 * finite, HEWN_INVALID_ARGUMENT for an unknown unit or axis; the model is then unchanged. */
HEWN_API hewn_result hewn_model_convert(hewn_model *model, const hewn_unit *unit, const hewn_axis *up,
                                        hewn_conversion *record, hewn_error *error);

/* A half-edge mesh of a model: vertices and faces keep their numbers and all channels become attributes, with the names
 * of their values. `repair` NULL: built strictly, HEWN_BAD_INPUT where the polygons are no manifold, as
 * hewn_mesh_from_polygons() says; else repaired first, as hewn_mesh_from_soup() does, with each new element taking the
 * values of the one it comes from, and `report` (or NULL) filled in. What filling makes takes values from around it:
 * blends, the next face's labels, and normals of its own faces. Where faces are turned over, normals that then point
 * inside are turned with them. The errors of both, and those of hewn_model_check(). */
HEWN_API hewn_result hewn_mesh_from_model(const hewn_model *model, const hewn_repair_desc *repair, hewn_mesh **out,
                                          hewn_repair_report *report, hewn_error *error);

/* Back again: live elements in order, attributes as channels with the names of their values; unit and axes unknown.
 * HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_model_from_mesh(const hewn_mesh *mesh, hewn_model *out, hewn_error *error);

/* A model with the polygons cut into triangles (concave ones right, hewn/mesh.h), as float buffers: positions rounded
 * to the nearest float, a vertex channel "normal" made the normals. HEWN_LIMIT for a position that a float cannot hold;
 * HEWN_OUT_OF_MEMORY; the errors of hewn_model_check(). */
HEWN_API hewn_result hewn_triangles_from_model(const hewn_model *model, hewn_triangles *out, hewn_error *error);

/* Float buffers as a model, normals as its vertex channel "normal"; unit and axes unknown. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_model_from_triangles(const hewn_triangles *triangles, hewn_model *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
