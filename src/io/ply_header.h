/* A PLY file's header: which elements follow, and of which properties. */
#ifndef HEWN_SRC_IO_PLY_HEADER_H
#define HEWN_SRC_IO_PLY_HEADER_H

#include "io/scan.h"

typedef enum hewn_ply_form { HEWN_PLY_TEXT, HEWN_PLY_LITTLE, HEWN_PLY_BIG } hewn_ply_form;

typedef enum hewn_ply_type {
    HEWN_PLY_NONE,
    HEWN_PLY_INT8,
    HEWN_PLY_UINT8,
    HEWN_PLY_INT16,
    HEWN_PLY_UINT16,
    HEWN_PLY_INT32,
    HEWN_PLY_UINT32,
    HEWN_PLY_FLOAT,
    HEWN_PLY_DOUBLE
} hewn_ply_type;

/* Bytes of one value in a binary file; 0 for none. */
static inline size_t hewn_ply_type_size(hewn_ply_type type)
{
    static const unsigned char sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

/* Properties without which there is no mesh; each is there once at most. */
typedef enum hewn_ply_role {
    HEWN_PLY_OTHER,
    HEWN_PLY_X,
    HEWN_PLY_Y,
    HEWN_PLY_Z,
    HEWN_PLY_CORNERS /* the list of a face's or strip's vertices */
} hewn_ply_role;

typedef struct hewn_ply_property {
    hewn_ply_type type;
    hewn_ply_type count_type; /* of a list; HEWN_PLY_NONE: a single value */
    hewn_ply_role role;
    hewn_word name; /* in the file's bytes */
} hewn_ply_property;

typedef enum hewn_ply_kind { HEWN_PLY_UNKNOWN, HEWN_PLY_VERTICES, HEWN_PLY_FACES, HEWN_PLY_STRIPS } hewn_ply_kind;

enum { HEWN_PLY_MOST = 1000 }; /* elements in a header; properties too */

typedef struct hewn_ply_element {
    hewn_ply_kind kind;
    uint64_t count; /* as promised: not yet compared with the file's length */
    size_t first, property_count;
} hewn_ply_element;

typedef struct hewn_ply_header {
    hewn_ply_form form;
    hewn_ply_element *elements;
    size_t element_count, element_room;
    hewn_ply_property *properties; /* of all elements */
    size_t property_count, property_room;
    hewn_word *comments; /* what follows the word "comment" or "obj_info" and one blank, to the line's end */
    size_t comment_count, comment_room;
} hewn_ply_header;

/* Reads from "ply" to the line after "end_header", where it leaves `scan`. Zero after an error. */
hewn_result hewn_ply_header_read(hewn_scan *scan, hewn_ply_header *out, hewn_error *error);
void hewn_ply_header_free(hewn_ply_header *header);

/* The fewest bytes that one item of an element can take; `*fixed` (or NULL): whether each takes just so many. */
uint64_t hewn_ply_least_size(const hewn_ply_header *header, const hewn_ply_element *element, bool *fixed);

/* The place of a single value of a name among an element's properties, or HEWN_PLY_MOST. */
size_t hewn_ply_find(const hewn_ply_header *header, const hewn_ply_element *element, const char *name);

#endif
