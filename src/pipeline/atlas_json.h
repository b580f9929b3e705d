/* An atlas in words. */
#ifndef HEWN_SRC_PIPELINE_ATLAS_JSON_H
#define HEWN_SRC_PIPELINE_ATLAS_JSON_H

#include "base/text.h"
#include "hewn/atlas.h"

/* Writes JSON in the layout of msdf-atlas-gen (docs/atlas.md); with `y_down` y counts from the image's top and below
 * the baseline. */
void hewn_atlas_write_json(const hewn_atlas *atlas, bool y_down, hewn_text *text);

#endif
