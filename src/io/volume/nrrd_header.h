/* The header of an NRRD file (Kindlmann's "Definition of NRRD File Format", versions 1 to 5). */
#ifndef HEWN_SRC_IO_VOLUME_NRRD_HEADER_H
#define HEWN_SRC_IO_VOLUME_NRRD_HEADER_H

#include "io/scan.h"
#include "io/volume/source.h"

enum { HEWN_NRRD_AXES = 16, HEWN_NRRD_SPACE = 4 };

/* The key that says of a file that its samples are distances, negative inside. The format has no field for that. */
#define HEWN_NRRD_LEVEL_SET "level set"

typedef enum hewn_nrrd_encoding {
    HEWN_NRRD_RAW,
    HEWN_NRRD_TEXT,
    HEWN_NRRD_HEX,
    HEWN_NRRD_GZIP,
    HEWN_NRRD_BZIP2
} hewn_nrrd_encoding;

typedef struct hewn_nrrd_axis {
    uint64_t size;
    double spacing, min, max;          /* NaN: not told */
    double direction[HEWN_NRRD_SPACE]; /* in the space */
    bool has_direction;                /* it is of space; else, where there is a space, it is not */
    bool not_domain;                   /* its kind says that it is not one of space: "vector", "time", ... */
    bool has_kind;                     /* a kind that says anything */
    bool cell;                         /* samples stand for cells, so the first is half a spacing past `min` */
} hewn_nrrd_axis;

/* Words are parts of the source's text. */
typedef struct hewn_nrrd_header {
    hewn_voxel type;
    uint32_t dimension;
    hewn_nrrd_axis axes[HEWN_NRRD_AXES];
    uint32_t space; /* dimensions of the space; 0: none */
    bool anatomical, left, posterior;
    double origin[HEWN_NRRD_SPACE];
    hewn_word unit; /* of all spatial axes */
    bool level_set; /* by HEWN_NRRD_LEVEL_SET */
    bool has_type, has_encoding, has_endian, big_endian;
    hewn_nrrd_encoding encoding;
    int64_t line_skip, byte_skip; /* byte_skip -1: samples end with the file */
    hewn_word content;
    hewn_word data_file;   /* empty: the samples follow the header */
    const char *data_list; /* "data file: LIST": the names are the lines from here; else NULL */
    size_t samples_at;     /* where the header ends */
} hewn_nrrd_header;

/* HEWN_BAD_INPUT, with a line. */
hewn_result hewn_nrrd_header_read(const hewn_volume_source *source, hewn_nrrd_header *out, hewn_error *error);

#endif
