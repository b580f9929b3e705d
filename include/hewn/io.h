/* Mesh files in and out. */
#ifndef HEWN_IO_H
#define HEWN_IO_H

#include "hewn/clusters.h"
#include "hewn/model.h"
#include "hewn/progressive.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_mesh_format {
    HEWN_MESH_UNKNOWN,
    HEWN_MESH_GLB,  /* triangles, float, always metres and +Y up */
    HEWN_MESH_GLTF, /* the same as text; read only */
    HEWN_MESH_OBJ,  /* text; polygons, double */
    HEWN_MESH_PLY,  /* written binary little-endian; polygons, float where that holds every position, else double */
    HEWN_MESH_STL,  /* written binary; triangles, float, no shared vertices */
    HEWN_MESH_OFF,  /* text; polygons, double */
    HEWN_MESH_3MF,  /* triangles, with a unit, always +Z up; written only */
    HEWN_MESH_HPM   /* a progressive mesh, read with all its splits; hewn_progressive_write() writes it */
} hewn_mesh_format;

/* The format that a file's extension names (any case; one ".gz" after it is passed over), or HEWN_MESH_UNKNOWN. */
HEWN_API hewn_mesh_format hewn_mesh_format_of(const char *path_or_extension);

/* Its extension in lower case, without a dot; NULL for HEWN_MESH_UNKNOWN. */
HEWN_API const char *hewn_mesh_format_name(hewn_mesh_format format);

/* Whether a file of this format can be written with faces of more than three corners. */
HEWN_API bool hewn_mesh_format_has_polygons(hewn_mesh_format format);

/* Whether hewn_model_write() in this format writes a channel of a model, all components of it. Numbers may be rounded
 * to what the format has, and values of vertices and corners may lose their names. */
HEWN_API bool hewn_mesh_format_keeps(hewn_mesh_format format, const hewn_model *model, const hewn_channel *channel);

typedef struct hewn_read_desc {
    hewn_mesh_format format;       /* HEWN_MESH_UNKNOWN: from the path; needed for "-", standard input */
    uint64_t memory_limit;         /* bytes that a compressed file may grow to; 0 is 16 GiB */
    const hewn_progress *progress; /* or NULL; the stage is "load" */
    bool base_colors; /* of glTF: the materials' base colours too, as a face channel "color" of 4 FLOAT, linear, unless
                         all are white */
} hewn_read_desc;

/* Reads a mesh file, compressed with gzip or not, as it is: polygons uncut, vertices in the file's order, attributes,
 * double precision. Vertices that a format cannot share (STL, glTF's seams) are shared where their positions are equal.
 * `desc` may be NULL. HEWN_INVALID_ARGUMENT for an unknown extension; HEWN_IO; HEWN_BAD_INPUT says where and why;
 * HEWN_LIMIT for more than indices can name; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. Memory stays in proportion to the
 * file. */
HEWN_API hewn_result hewn_model_read(const char *path, const hewn_read_desc *desc, hewn_model *out, hewn_error *error);

/* The same, cut into float triangles. */
HEWN_API hewn_result hewn_triangles_read(const char *path, hewn_triangles *out, hewn_error *error);

typedef struct hewn_write_desc {
    hewn_mesh_format format; /* HEWN_MESH_UNKNOWN: from the path */
    const char *name;        /* of the object; NULL: the file's name without its extension */
    /* Of the positions; what a model knows itself goes before them. Without a unit triangle buffers are taken to be in
     * metres. The file of a model of unknown unit says nothing (GLB takes metres, 3MF millimetres), nor does it of axes
     * where the model knows none and no unit is given (GLB and 3MF then take them to be their own). */
    const hewn_unit *unit;
    hewn_axis up;
    bool unsure; /* of triangle buffers: nobody knows their axes nor, where `unit` is NULL, their unit */
    /* Which space of a patient positions are in: "RAS" or "LPS" (towards which sides the axes point). STL, OBJ, PLY and
     * OFF say SPACE=RAS in their header or first comments, which 3D Slicer reads; GLB in its asset's extras, 3MF in its
     * description. NULL: nothing is said. Static or the caller's. */
    const char *space;
    const hewn_channel *channels; /* of triangle buffers: what vertices and faces (as they are written) carry besides */
    uint32_t channel_count;       /* positions and normals; at most 4 */
    bool quads;                   /* of triangles that are paired: write the quads, where the format has polygons */
    const hewn_progress *progress; /* or NULL; the stage is "write" */
} hewn_write_desc;

/* Writes a model under a temporary name and renames it over `path` ("-" is standard output, not for GLB and 3MF). Same
 * bytes for the same input. What the format cannot hold is left out, and polygons are cut where it has triangles only.
 * `desc` may be NULL. HEWN_LIMIT where the format cannot hold that many or that far, before anything is written;
 * HEWN_BAD_INPUT for an index out of range or a number that is not finite; HEWN_IO; HEWN_CANCELLED;
 * HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_model_write(const hewn_model *model, const char *path, const hewn_write_desc *desc,
                                      hewn_error *error);

/* The same for triangle buffers, without a copy of them. */
HEWN_API hewn_result hewn_triangles_write(const hewn_triangles *triangles, const char *path,
                                          const hewn_write_desc *desc, hewn_error *error);

/* One of several objects in a file: a model of triangles with a name and a colour. */
typedef struct hewn_object {
    const hewn_model *model; /* in metres, +Y up; channels are not looked at */
    const char *name;        /* UTF-8 */
    uint8_t color[4];        /* red, green, blue as on a screen (sRGB), opacity */
} hewn_object;

/* Writes objects as a GLB file, each a node with a mesh, normals and a material of its colour. `numbers`, one an object
 * or NULL, go to the nodes' extras as "label"; `space` or NULL, as in
 * hewn_write_desc, to the asset's. Vertices are those of the models, so that what is shared by closed
 * models has the same bits. HEWN_LIMIT for more than 4 GiB or a position that a float cannot hold, before anything is
 * written; HEWN_INVALID_ARGUMENT for faces that are no triangles; HEWN_IO; HEWN_CANCELLED; HEWN_OUT_OF_MEMORY.
 * `progress` may be NULL, its stage is "write". */
HEWN_API hewn_result hewn_objects_write_glb(const hewn_object *objects, size_t count, const int64_t *numbers,
                                            const char *space, const char *path, const hewn_progress *progress,
                                            hewn_error *error);

/* A progressive mesh from a file (.hpm, docs/hpm.md), compressed with gzip or not, and to one; "-" is standard input
 * and output. `partial` takes a file that ends early with what is whole of it, but for a compressed one. The errors of
 * hewn_progressive_decode() and HEWN_IO. */
HEWN_API hewn_result hewn_progressive_read(const char *path, bool partial, const hewn_progress *progress,
                                           hewn_progressive **out, hewn_error *error);
HEWN_API hewn_result hewn_progressive_write(const hewn_progressive *progressive, const char *path, hewn_error *error);

/* Writes clusters of a model as a GLB file: the mesh is that of the finest level, so that any reader shows it, and what
 * is needed for the others stands in its extras (docs/lod.md). Positions of the model are rounded to floats, attributes
 * kept as hewn_model_write() keeps them. The model is in metres, +Y up. Errors as of hewn_model_write(). `desc` may be
 * NULL; its format is not looked at. */
HEWN_API hewn_result hewn_clusters_write_glb(const hewn_clusters *clusters, const hewn_model *model, const char *path,
                                             const hewn_write_desc *desc, hewn_error *error);

/* Writes levels of detail, from fine to coarse, as one GLB file: the first is the scene's, and names the others as its
 * levels (extension MSFT_lod). `coverages`, as many as levels, are the least share of the picture's height that each is
 * meant for, falling (MSFT_screencoverage in the first node's extras). Each level keeps what hewn_model_write() keeps.
 * `desc` may be NULL; its format is not looked at. Errors as of hewn_model_write(), HEWN_INVALID_ARGUMENT for none. */
HEWN_API hewn_result hewn_levels_write_glb(const hewn_model *const *levels, const double *coverages, uint32_t count,
                                           const char *path, const hewn_write_desc *desc, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
