/* `hewn info` of a mesh file. */
#ifndef HEWN_SRC_APP_MESH_INFO_H
#define HEWN_SRC_APP_MESH_INFO_H

#include "hewn/io.h"

/* Reads a mesh, `-` from standard input, and prints what is in it to standard output. */
hewn_result hewn_mesh_tell(const char *path, hewn_mesh_format format, bool json, hewn_error *error);

#endif
