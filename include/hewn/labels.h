/* Label volumes (segmentations) to meshes: all labels in one pass, faces between two of them made once, so that
 * neighbours fit without a gap. docs/labels.md says how and what is promised. */
#ifndef HEWN_LABELS_H
#define HEWN_LABELS_H

#include "hewn/model.h"
#include "hewn/simplify.h"
#include "hewn/smooth.h"
#include "hewn/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles between labels. A label has a number in here, from 1 on, in the order of their values; number 0 is the
 * outside: what lies around the volume, and all voxels of labels that were not asked for. Zero is the empty mesh;
 * everything is owned by it, from the heap; move it by assignment and leave it with hewn_label_mesh_destroy().
 *
 * Triangle t is counter-clockwise seen from label sides[2t + 1] (its front), and sides[2t] is behind it; the two
 * differ. So label n's shell is made of the triangles that have n behind them, and those with n in front turned over.
 * Edges and vertices where three or more labels meet belong to the shells of all of them, so that these share positions
 * bit for bit. Each shell by itself is closed, manifold at edges and vertices, and oriented outward; no two vertices of
 * the mesh are in the same place. */
typedef struct hewn_label_mesh {
    hewn_body_counts islands; /* of all labels together, where a choice of them was asked for */
    uint32_t label_count;
    int64_t *labels;       /* the value of label number n is labels[n - 1]; ascending */
    uint64_t *voxel_count; /* how many voxels it has: voxel_count[n - 1], at least 1 */
    uint64_t vertex_count, triangle_count;
    double *positions; /* vertex_count × 3, in the world of the volume */
    uint32_t *indices; /* triangle_count × 3 */
    uint16_t *sides;   /* triangle_count × 2 */
    uint64_t *first;   /* label_count + 2: the triangles of label n are faces[first[n]] to faces[first[n + 1] - 1], */
    uint32_t *faces;   /* as 2 t, or 2 t + 1 where t has to be turned over; ascending */
} hewn_label_mesh;

HEWN_API void hewn_label_mesh_destroy(hewn_label_mesh *mesh);

/* Which labels, and how. Zero is all but 0, not smoothed. */
typedef struct hewn_label_desc {
    uint64_t frame;
    const int64_t *labels; /* those to mesh, 0 too if it is named; NULL: all but 0 */
    size_t label_count;    /* of these; repeated ones count once, and those without voxels are left out */
    uint32_t
        relaxations; /* passes in which each vertex moves half way to the mean of its neighbours, within its cell */
    /* Which islands of each label to mesh, voxels that share faces being of one; volumes are those of the voxels, in
     * the world's unit cubed. What is left out counts as outside. Cavities are hollows of the outside, which is joined
     * over edges too, and one is filled by the label around it where that is the only one. NULL: all as it is. */
    const hewn_body_choice *keep;
    const hewn_progress *progress; /* or NULL; the stages are "label" and "relax" */
} hewn_label_desc;

/* Meshes labels: a vertex in each cell of 2 x 2 x 2 voxels that are not of one label, a polygon between each two
 * neighbouring voxels of unlike labels, cut into triangles (surface nets: Gibson 1998, 'Constrained elastic surface
 * nets'; for many labels Frisken 2022, 'SurfaceNets for multi-label segmentations with preservation of sharp
 * boundaries'), with more vertices in cells where one would make a shell non-manifold. A voxel reaches half way to its
 * neighbours; what touches the volume's border is closed there. The same bytes for any number of threads. Takes 2 bytes
 * a voxel, also of a volume in blocks, and some 200 a vertex.
 *
 * HEWN_INVALID_ARGUMENT for a frame that is not there; HEWN_BAD_INPUT for a value that is no whole number or beyond
 * 2^53, naming the voxel, or if there is no voxel of any label asked for; HEWN_LIMIT for more than 65,535 labels, 2^32
 * corners, or coordinates that are not finite; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. */
HEWN_API hewn_result hewn_labels_mesh(const hewn_volume *volume, const hewn_label_desc *desc, hewn_label_mesh *out,
                                      hewn_error *error);

/* The number of a label in the mesh, 0 where it has none. */
HEWN_API uint32_t hewn_label_mesh_find(const hewn_label_mesh *mesh, int64_t label);

/* Smooths all shells as one (hewn/smooth.h): where three or more labels meet, vertices move along the curve or stay. */
HEWN_API hewn_result hewn_label_mesh_smooth(hewn_label_mesh *mesh, const hewn_smooth_desc *desc,
                                            hewn_smooth_report *report, hewn_error *error);

/* Simplifies all shells as one (hewn/simplify.h): what two labels share stays shared. Curves along which three or more
 * labels meet become coarser as curves, in their place as well as may be; with lock_boundary they stay as they are.
 * Where they end or cross, vertices stay. Every shell stays closed, manifold, oriented and of its topology. Numbers of
 * triangles are those of the mesh, where what two labels share counts once; the distance is that of the mesh, all
 * labels together. Of `desc`, labels, lock_labels, frozen and preserve are not looked at. The same bytes for any number
 * of threads. On failure the mesh is as it was.
 *
 * HEWN_INVALID_ARGUMENT for a bad `desc`, and for no_self_intersections, which is not done here; the rest as
 * hewn_polygons_simplify(). */
HEWN_API hewn_result hewn_label_mesh_simplify(hewn_label_mesh *mesh, const hewn_simplify_desc *desc,
                                              hewn_simplify_report *report, hewn_error *error);

/* The shell of label `number` (1 to label_count) as a model of its own: its triangles and vertices in the mesh's order,
 * of unknown unit and axes. HEWN_INVALID_ARGUMENT, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_label_mesh_shell(const hewn_label_mesh *mesh, uint32_t number, hewn_model *out,
                                           hewn_error *error);

/* All shells side by side, with a channel "object" of faces that has the value n - 1 on label n's. `names`
 * (label_count) are its names. HEWN_INVALID_ARGUMENT where two names are the same; HEWN_LIMIT for 2^32 corners;
 * HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_label_mesh_shells(const hewn_label_mesh *mesh, const char *const *names, hewn_model *out,
                                            hewn_error *error);

/* The mesh itself as a model: shared vertices, each face once, with the labels' values as channels "back" and "front"
 * of faces (INT32; the outside is `outside`). HEWN_LIMIT for a label that INT32 cannot hold; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_label_mesh_model(const hewn_label_mesh *mesh, int32_t outside, hewn_model *out,
                                           hewn_error *error);

/* --- names and colours ---------------------------------------------------------------------------------------------
 */

typedef struct hewn_label_name {
    int64_t label;
    char *name;
    bool has_color;
    uint8_t color[4]; /* red, green, blue, opacity */
} hewn_label_name;

/* What labels are called, in the order of their values. Zero is the empty table; leave it with
 * hewn_label_table_destroy(). */
typedef struct hewn_label_table {
    hewn_label_name *entries;
    size_t count;
} hewn_label_table;

/* Reads a table, one label a line: what ITK-SNAP calls label descriptions (number, red, green, blue, opacity from 0 to
 * 1, two flags, name in quotes); FreeSurfer's and 3D Slicer's colour tables (number, name, red, green, blue, and
 * opacity, which FreeSurfer counts from 255 down); and a number, a name and perhaps a colour, with spaces, tabs, commas
 * or semicolons between. Names may be in quotes. Which one it is each file shows itself. `#` begins a comment.
 * HEWN_BAD_INPUT names the line that cannot be read, or that has a label a second time; HEWN_IO; HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_label_table_read(const char *path, hewn_label_table *out, hewn_error *error);

/* The same of text in memory; `name` is for messages. */
HEWN_API hewn_result hewn_label_table_parse(const char *text, size_t length, const char *name, hewn_label_table *out,
                                            hewn_error *error);

HEWN_API void hewn_label_table_destroy(hewn_label_table *table);

/* The entry of a label, or NULL. */
HEWN_API const hewn_label_name *hewn_label_table_find(const hewn_label_table *table, int64_t label);

#ifdef __cplusplus
}
#endif
#endif
