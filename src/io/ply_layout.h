/* Which channels the properties of a PLY element make. */
#ifndef HEWN_SRC_IO_PLY_LAYOUT_H
#define HEWN_SRC_IO_PLY_LAYOUT_H

#include "hewn/model.h"
#include "io/ply_header.h"

/* The values of a channel to be, as far as they are read. */
typedef struct hewn_ply_column {
    char *name; /* NULL: the positions */
    hewn_domain domain;
    hewn_scalar scalar;
    size_t size;         /* bytes of a scalar */
    uint32_t components; /* 0: a list of which no length is known yet */
    bool is_unsigned;    /* 32 bits, read as double */
    char *values;
    size_t value_count, value_room; /* scalars; used for lists */
    size_t value_mark;              /* of lists: where the item being read begins */
} hewn_ply_column;

/* Where a property goes; HEWN_NONE: it is passed over. */
typedef struct hewn_ply_slot {
    uint32_t column, component;
} hewn_ply_slot;

typedef struct hewn_ply_layout {
    hewn_ply_column *columns;
    uint32_t column_count;
    hewn_ply_slot *slots;              /* one a property */
    uint64_t item_count, corner_count; /* that have values */
} hewn_ply_layout;

/* Vertices: x, y and z are the positions. Vertices and faces: nx, ny, nz make "normal"; red, green, blue and alpha
 * (diffuse_red and so on; r, g, b, a) make "color"; for vertices s and t, u and v, or texture_u and texture_v make
 * "uv". NAME_0, NAME_1 and so on, up to 16 that follow each other, make NAME. All these only where they are of one type
 * that fits; any other property makes a channel of its own name. Of faces the list "texcoord" makes "uv" of the
 * corners, and "corner_NAME" makes NAME of the corners; other lists, and second properties of a name, are passed over.
 * Zero after an error, which is HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ply_layout_make(const hewn_ply_header *header, const hewn_ply_element *element, hewn_ply_layout *out,
                                 hewn_error *error);
void hewn_ply_layout_free(hewn_ply_layout *layout);

#endif
