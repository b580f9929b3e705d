/* Lights, ground, and what they make of a hit. */
#ifndef HEWN_SRC_RENDER_LIGHT_H
#define HEWN_SRC_RENDER_LIGHT_H

#include "render/camera.h"

/* Light from above, in front and to the left of the viewer; how near is on the surface, for this lens and box. */
hewn_stage hewn_stage_of(const hewn_lens *lens, const hewn_render_desc *desc, const hewn_box *box);

/* The linear colour of what a ray met. */
void hewn_met_colour(const hewn_met *met, const hewn_stage *stage, const float surface[3], float out[3]);

#endif
