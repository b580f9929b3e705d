/* What a single mesh and one in parts have in common on their way. */
#ifndef HEWN_SRC_ISO_EXTRACTION_H
#define HEWN_SRC_ISO_EXTRACTION_H

#include "iso/extractor.h"

typedef struct hewn_extraction {
    const hewn_extractor *extractor;
    const hewn_extract_desc *desc;
    hewn_method method;
    struct hewn_grid grid;
    hewn_workspace workspace;
    hewn_extract_stats *stats;
    double begin;
} hewn_extraction;

/* Checks the description, lays the grid and makes what the method needs. */
hewn_result hewn_extraction_begin(hewn_extractor *extractor, const hewn_extract_desc *desc, hewn_extract_stats *stats,
                                  hewn_extraction *out, hewn_error *error);

/* Notes a stage, by clock times, and asks whether to go on. */
hewn_result hewn_extraction_stage(hewn_extraction *run, const char *name, double begin, double end, double share,
                                  hewn_error *error);

void hewn_extraction_note_suspects(const hewn_extraction *run, const hewn_suspects *suspects);

/* Fails, and says why there is no surface. */
hewn_result hewn_extraction_explain_empty(hewn_extraction *run, hewn_error *error);

#endif
