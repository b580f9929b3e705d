/* What a volume's mesh at once and one in parts have in common on their way. */
#ifndef HEWN_SRC_ISO_VOLUME_EXTRACTION_H
#define HEWN_SRC_ISO_VOLUME_EXTRACTION_H

#include "hewn/volume_extract.h"

#include "iso/lattice.h"
#include "iso/mc33.h"

typedef struct hewn_volume_extraction {
    const hewn_volume_extract_desc *desc;
    hewn_lattice lattice;
    hewn_mc33_table table;
    hewn_volume_extract_stats stats;
    double begin, stage;
    bool in_parts;
} hewn_volume_extraction;

/* Checks the description, and lays the lattice without room for signs and rows. Clear it also after an error. */
hewn_result hewn_volume_extraction_begin(const hewn_volume *volume, const hewn_volume_extract_desc *desc,
                                         hewn_volume_extraction *out, hewn_error *error);
void hewn_volume_extraction_clear(hewn_volume_extraction *run);

/* Bytes that the signs and rows of a slab take. */
uint64_t hewn_volume_extraction_bytes(const hewn_volume_extraction *run, uint32_t begin, uint32_t end);

/* Makes room for those in place of what was there. */
hewn_result hewn_volume_extraction_lay(hewn_volume_extraction *run, uint32_t begin, uint32_t end, hewn_error *error);

void hewn_volume_extraction_free_slab(hewn_volume_extraction *run);

/* Ends the stage at hand. */
hewn_result hewn_volume_extraction_stage(hewn_volume_extraction *run, const char *name, double share,
                                         hewn_error *error);

/* Makes the mesh of the slab whose rows were counted, without what other slabs have: vertices on edges, with those of
 * the slice after it, then vertices in cells. Of dual meshes there are vertices in cells alone, and six indices a
 * crossing; those of crossings from number `first` of the whole on are triangles. `out` is to be destroyed also after
 * an error. HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_volume_extraction_emit(hewn_volume_extraction *run, uint64_t first, hewn_triangles *out,
                                        hewn_error *error);

/* Fails, since no cell has surface. */
hewn_result hewn_volume_extraction_explain_empty(const hewn_volume_extraction *run, hewn_error *error);

#endif
