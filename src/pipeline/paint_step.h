/* Colours and labels of a scene's field on the triangles that were made of it. */
#ifndef HEWN_SRC_PIPELINE_PAINT_STEP_H
#define HEWN_SRC_PIPELINE_PAINT_STEP_H

#include "hewn/io.h"
#include "hewn/simplify.h"

/* What the mesh's elements carry; NULL where the field has none of it or the format has no place for it. Zero is none.
 */
typedef struct hewn_mesh_paint {
    float *colors;      /* 3 a vertex, linear */
    int32_t *labels;    /* one an element of `domain` */
    hewn_domain domain; /* faces; vertices in GLB, where faces carry nothing */
    uint8_t *srgb;      /* 3 a vertex, for formats that want them so; made by hewn_mesh_paint_channels() */
} hewn_mesh_paint;

/* Whether the field has paint that files of this format can hold. */
bool hewn_mesh_paint_wanted(const hewn_field *field, hewn_mesh_format format);

/* Evaluates the field's paint at vertices, and at the middles of faces (of the quads where `quads`). */
hewn_result hewn_mesh_paint_find(const hewn_field *field, const hewn_triangles *triangles, bool quads,
                                 hewn_mesh_format format, hewn_mesh_paint *out, hewn_error *error);
void hewn_mesh_paint_destroy(hewn_mesh_paint *paint);

/* hewn_triangles_simplify() that takes the paint along. */
hewn_result hewn_mesh_paint_simplify(hewn_triangles *triangles, hewn_mesh_paint *paint, const hewn_simplify_desc *desc,
                                     hewn_simplify_report *report, hewn_error *error);

/* Channels for a writer of this format, 0 to 2 of them, which live as long as the paint. */
hewn_result hewn_mesh_paint_channels(hewn_mesh_paint *paint, hewn_mesh_format format, uint64_t vertex_count,
                                     hewn_channel channels[2], uint32_t *count, hewn_error *error);

#endif
