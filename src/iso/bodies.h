/* Bodies and cavities of a surface that was extracted from a lattice. */
#ifndef HEWN_SRC_ISO_BODIES_H
#define HEWN_SRC_ISO_BODIES_H

#include "iso/lattice.h"

/* Takes the shells out of a mesh that `choice` does not want, and counts them; lattice->cap_vertices follows. The
 * lattice is closed and has emitted all of `mesh`. HEWN_BAD_INPUT where no body would be left, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_lattice_choose_bodies(hewn_lattice *lattice, const hewn_body_choice *choice, hewn_triangles *mesh,
                                       hewn_body_counts *counts, hewn_error *error);

#endif
