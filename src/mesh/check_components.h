/* Components of faces joined at shared vertices, and how those that are listed are told apart. */
#ifndef HEWN_SRC_MESH_CHECK_COMPONENTS_H
#define HEWN_SRC_MESH_CHECK_COMPONENTS_H

#include <stdatomic.h>

#include "mesh/star.h"

/* --- trees of vertices ----------------------------------------------------------------------------------------------
 */

/* Trees of vertices joined by faces: the parent of each, its own where it is a root, which has the least number of its
 * tree. A root with a face that has sides stands for one component, and `count` is how many there are. To be freed.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_trees_grow(const hewn_face_view *view, const hewn_stars *stars, _Atomic uint32_t **out,
                            uint64_t *count, hewn_error *error);

/* How many roots there are, with those of vertices without faces; each stands for itself. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_trees_count(const hewn_face_view *view, uint64_t *count, hewn_error *error);
uint32_t hewn_trees_root(_Atomic uint32_t *parent, uint32_t v);
void hewn_trees_join(_Atomic uint32_t *parent, uint32_t a, uint32_t b);

/* --- components -----------------------------------------------------------------------------------------------------
 */

/* Slots 0 to listed - 1 are components, those of most faces first (of as many, that with the lowest vertex); slot
 * `listed` is all the rest, and the vertices of no face. */
typedef struct hewn_components {
    uint64_t count;
    uint32_t listed;
    uint32_t *slots; /* of each vertex */
} hewn_components;

/* How many there are, and the slots of at most most_listed of them. */
hewn_result hewn_components_find(const hewn_face_view *view, const hewn_stars *stars, uint32_t most_listed,
                                 hewn_components *out, hewn_error *error);
void hewn_components_free(hewn_components *components);

#endif
