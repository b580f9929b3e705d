/* The 3MF Consortium's own reader, where Debian's lib3mf-dev is installed. */
#ifndef HEWN_TEST_LIB3MF_READ_H
#define HEWN_TEST_LIB3MF_READ_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lib3mf_facts {
    uint32_t objects, vertices, triangles; /* of the last object */
    uint32_t unit;                         /* 0 micron, millimeter, centimeter, inch, foot, 5 meter */
    uint32_t warnings;
    bool manifold;     /* closed and oriented */
    float corner[3];   /* the last vertex */
    float *positions;  /* vertices × 3, of the last object; from malloc() */
    uint32_t *corners; /* triangles × 3 */
} lib3mf_facts;

/* False where the library cannot read the file, or there is none. What `out` owns goes with lib3mf_forget(). */
bool lib3mf_is_there(void);
bool lib3mf_read(const char *path, lib3mf_facts *out);
void lib3mf_forget(lib3mf_facts *facts);

#ifdef __cplusplus
}
#endif
#endif
