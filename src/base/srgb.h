/* Colours as screens take them, and the amounts of light that they stand for (IEC 61966-2-1). */
#ifndef HEWN_SRC_BASE_SRGB_H
#define HEWN_SRC_BASE_SRGB_H

/* Both from 0 to 1 to the same. */
double hewn_srgb_to_linear(double share);
double hewn_srgb_from_linear(double share);

#endif
