/* OpenVDB behind a C face: a module (io/shim/module.h) with one table of functions. No exception leaves it. */
#ifndef HEWN_SRC_IO_SHIM_VDB_H
#define HEWN_SRC_IO_SHIM_VDB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_vdb_type {
    HEWN_VDB_FLOAT,
    HEWN_VDB_DOUBLE,
    HEWN_VDB_INT32,
    HEWN_VDB_INT64,
    HEWN_VDB_BOOL
} hewn_vdb_type;

typedef enum hewn_vdb_result { HEWN_VDB_OK, HEWN_VDB_BAD, HEWN_VDB_OUT_OF_MEMORY } hewn_vdb_result;

enum { HEWN_VDB_LEAF = 512 }; /* samples of a leaf, 8 x 8 x 8 */

/* What is known of a grid. Its lattice has a sample at every (i, j, k) of whole numbers; all but a few are background.
 */
typedef struct hewn_vdb_facts {
    char name[256];
    hewn_vdb_type type;
    bool level_set;       /* signed distances, negative inside */
    int32_t lo[3], hi[3]; /* the box of its active samples, both ends included */
    double to_world[16];  /* of (i, j, k, 1), row-major */
    uint64_t leaf_count;
    uint64_t tile_count; /* constant cubes that are not background */
} hewn_vdb_facts;

/* One grid of a file, in memory. May be read by several threads at once. */
typedef struct hewn_vdb hewn_vdb;

/* A level set to be written: where it is, and functions that give leaves and take the file's bytes. */
typedef struct hewn_vdb_level_set {
    const char *name;
    const char *unit; /* NULL: not told */
    double origin[3]; /* of sample (0, 0, 0) */
    double cell;
    double background; /* the value far outside; far inside it is less than 0 */

    /* The next leaf: where its first sample is, multiples of 8, its samples in the order of leaf() below, and which of
     * them are active. False after the last. */
    bool (*next)(void *user, int32_t origin[3], float values[HEWN_VDB_LEAF], uint8_t active[HEWN_VDB_LEAF]);

    /* Bytes of the file, in order; false to give up. */
    bool (*take)(void *user, const char *bytes, size_t length);
    void *user;
} hewn_vdb_level_set;

typedef struct hewn_vdb_module {
    /* Reads a file from memory, which may go away afterwards, and keeps one grid of scalars: the one of this name, or
     * the first where it is NULL. A message of at most `room` bytes says why that failed. */
    hewn_vdb_result (*open)(const char *bytes, size_t length, const char *name, hewn_vdb **out, hewn_vdb_facts *facts,
                            char *message, size_t room);
    void (*close)(hewn_vdb **grid);

    /* Writes the samples of a box, both ends included, i fastest, in the grid's type (a bool is a byte of 0 or 1). */
    hewn_vdb_result (*copy_box)(const hewn_vdb *grid, const int32_t lo[3], const int32_t hi[3], void *out);

    /* Leaf `index` of `leaf_count`, in OpenVDB's order, which depends on the file alone: where its first sample is, and
     * (unless NULL) its samples in the grid's type (a bool is a byte of 0 or 1), i fastest, active or not. */
    void (*leaf)(const hewn_vdb *grid, uint64_t index, int32_t origin[3], void *samples);

    /* Tile `index` of `tile_count`, larger ones first: a cube of 8, 128 or 4096 samples along its side that all have
     * one value, of the grid's type, which is not the background's. What is in no leaf and no tile is background. */
    void (*tile)(const hewn_vdb *grid, uint64_t index, int32_t origin[3], uint32_t *side, void *sample);

    /* The background as a sample. */
    void (*background)(const hewn_vdb *grid, void *sample);

    /* Writes a file of one grid of floats. A message of at most `room` bytes says why that failed. */
    hewn_vdb_result (*write)(const hewn_vdb_level_set *what, char *message, size_t room);
} hewn_vdb_module;

#ifdef __cplusplus
}
#endif
#endif
