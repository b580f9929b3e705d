/* Looking into .vdb files for tests, by OpenVDB itself. */
#ifndef HEWN_TEST_VDB_LOOK_H
#define HEWN_TEST_VDB_LOOK_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct vdb_facts {
    int grids;
    char name[64], unit[16];
    bool level_set, floats;
    double background, voxel;
    double origin[3]; /* of voxel (0, 0, 0) */
    uint64_t active;
    char complaint[256]; /* of OpenVDB's own check of level sets; empty: none */
} vdb_facts;

/* False where OpenVDB cannot read the file. */
bool vdb_look(const char *path, vdb_facts *out);

/* The values at (i, j, k) triples of the first grid. */
bool vdb_values(const char *path, const int32_t *at, int count, float *out);

#ifdef __cplusplus
}
#endif
#endif
