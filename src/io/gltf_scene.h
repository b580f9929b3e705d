/* A glTF scene while it becomes a model. */
#ifndef HEWN_SRC_IO_GLTF_SCENE_H
#define HEWN_SRC_IO_GLTF_SCENE_H

#include "io/builder.h"
#include "io/gltf_data.h"

/* A mesh at its place: what a node shows. */
typedef struct hewn_gltf_instance {
    const char *name;
    int mesh;
    double matrix[16]; /* column-major, to the scene's coordinates */
    size_t first_part, part_count;
    size_t first_set, set_count;
} hewn_gltf_instance;

/* The vertices of those primitives of an instance that share their accessors: numbered through the whole scene, and
 * called wedges until it is known which of them are one vertex of the model. */
typedef struct hewn_gltf_set {
    size_t primitive; /* the first of them */
    uint64_t first_wedge, count;
} hewn_gltf_set;

/* A primitive of an instance. */
typedef struct hewn_gltf_part {
    size_t primitive, set;
    uint64_t first_face, face_count;
} hewn_gltf_part;

typedef struct hewn_gltf_scene {
    hewn_gltf_data data;
    hewn_builder builder;
    const hewn_progress *progress;
    bool base_colors; /* are wanted */
    hewn_gltf_instance *instances;
    hewn_gltf_set *sets;
    hewn_gltf_part *parts;
    size_t instance_count, instance_room, set_count, set_room, part_count, part_room;
    uint64_t wedge_count;
    uint32_t *wedge_vertices; /* the model's vertex of each wedge */
    uint64_t steps;           /* done, of `most_steps`, for progress */
    uint64_t most_steps;
} hewn_gltf_scene;

/* The corners of a part as its primitive has them. */
typedef struct hewn_gltf_corners {
    hewn_gltf_items indices;
    bool has_indices;
    int mode;
    bool mirrored;      /* the instance turns triangles over */
    uint64_t triangles; /* before those of strips that only turn are dropped */
    uint64_t vertex_count;
} hewn_gltf_corners;

hewn_result hewn_gltf_fail(const hewn_gltf_scene *scene, const char *what, hewn_error *error);

/* Counts one item of work, and now and then asks whether to go on. */
hewn_result hewn_gltf_step(hewn_gltf_scene *scene, hewn_error *error);

/* Whether a matrix leaves everything where it is. */
bool hewn_gltf_is_straight(const double matrix[16]);

/* The cofactors of a matrix's linear part, which turn normals (up to length and, where the result is true, sign). */
bool hewn_gltf_cofactors(const double matrix[16], double out[9]);

hewn_result hewn_gltf_positions_of(hewn_gltf_scene *scene, int accessor, hewn_gltf_items *out, hewn_error *error);
hewn_result hewn_gltf_corners_of(hewn_gltf_scene *scene, const hewn_gltf_instance *instance, size_t primitive,
                                 hewn_gltf_corners *out, hewn_error *error);

/* Triangle `index`, as places in its set, which must be checked; false where there is none. */
bool hewn_gltf_triangle(const hewn_gltf_corners *corners, uint64_t index, uint64_t out[3]);

/* Adds the vertices and triangles of all instances. */
hewn_result hewn_gltf_add_surfaces(hewn_gltf_scene *scene, hewn_error *error);

/* Adds channels to the finished model. */
hewn_result hewn_gltf_add_channels(hewn_gltf_scene *scene, hewn_error *error);

#endif
