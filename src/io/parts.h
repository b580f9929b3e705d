/* Mesh files in parts, for meshes that do not fit in memory as a whole. */
#ifndef HEWN_SRC_IO_PARTS_H
#define HEWN_SRC_IO_PARTS_H

#include "io/formats.h"

/* Takes a part of a model: some vertices, or some faces, which name vertices of the whole file, with their channels.
 * Its values may be changed. Vertices are numbered in the order in which they come. */
typedef struct hewn_part_taker {
    hewn_result (*take)(void *user, hewn_model *part, hewn_error *error);
    void *user;
    uint64_t memory; /* bytes of a file's texture coordinates and normals that a reader may keep for faces to come */
    bool no_uvs, no_normals; /* values of these channels are not looked at, and may be zero */
} hewn_part_taker;

/* Whether files of a format can be read in parts. */
bool hewn_mesh_format_has_parts(hewn_mesh_format format);

/* Reads a file in parts of some thousand items. It is mapped to memory and pages are let go again as it is read, so it
 * is a regular file that is not compressed, HEWN_LIMIT for anything else. Unit and axes go to `about`, as far as the
 * file tells. Errors as of hewn_model_read(), but that indices are not compared with the number of vertices, and that a
 * file which cannot be opened is HEWN_BAD_INPUT: HEWN_IO is only what `take` returns. */
hewn_result hewn_model_read_parts(const char *path, const hewn_read_desc *desc, const hewn_part_taker *taker,
                                  hewn_model *about, hewn_error *error);

/* Whether vertices of such a file that have equal positions are the same: each part then has faces with vertices of
 * their own, three each, from 0 on. */
bool hewn_mesh_format_welds(hewn_mesh_format format);

/* The formats' own. */
typedef hewn_result (*hewn_format_read_parts)(const hewn_source *source, const hewn_part_taker *taker,
                                              hewn_model *about, hewn_error *error);
hewn_result hewn_stl_read_parts(const hewn_source *source, const hewn_part_taker *taker, hewn_model *about,
                                hewn_error *error); /* HEWN_LIMIT for text */
hewn_result hewn_obj_read_parts(const hewn_source *source, const hewn_part_taker *taker, hewn_model *about,
                                hewn_error *error); /* HEWN_LIMIT for faces that name values which come after them */
hewn_result hewn_ply_read_parts(const hewn_source *source, const hewn_part_taker *taker, hewn_model *about,
                                hewn_error *error);

#endif
