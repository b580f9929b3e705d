/* The parts of the certificate and of the check, one step each. */
#ifndef HEWN_SRC_MESH_CHECK_PARTS_H
#define HEWN_SRC_MESH_CHECK_PARTS_H

#include "mesh/check_components.h"
#include "mesh/check_measure.h"

/* --- certificate.c ------------------------------------------------------------------------------------------------ */

/* Examines all stars, slot by slot where there are slots; progress from 0.6 to 1 of `stage`. HEWN_OUT_OF_MEMORY,
 * HEWN_CANCELLED. */
hewn_result hewn_certify_stars(const hewn_face_view *view, const hewn_stars *stars, const uint32_t *slots,
                               hewn_star_counts *counts, const char *stage, const hewn_progress *progress,
                               hewn_error *error);

/* What counts mean for a mesh of so many faces with sides; out->components must be known. */
void hewn_certify_counts(const hewn_star_counts *counts, uint64_t faces, hewn_certificate *out);

/* --- check_sheets.c ----------------------------------------------------------------------------------------------- */

/* Loops of boundary edges, and whether faces can be turned to agree; both for each slot. */
typedef struct hewn_sheet_counts {
    uint64_t boundary_loops;
    bool one_sided;
} hewn_sheet_counts;

/* Adds to sheets[slots[v]]. `total` are the counts of all stars together: where they show neither boundary nor edges at
 * which two faces disagree there is nothing to do. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_sheets_find(const hewn_face_view *view, const hewn_stars *stars, const uint32_t *slots,
                             const hewn_star_counts *total, hewn_sheet_counts *sheets, hewn_error *error);

/* --- check_same.c ------------------------------------------------------------------------------------------------- */

/* Counts the faces around the same corners, in the same cyclic order or reversed, as an earlier face.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_count_duplicate_faces(const hewn_face_view *view, const hewn_stars *stars, uint64_t *count,
                                       hewn_error *error);

#endif
