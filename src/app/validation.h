/* What the environment says about devices. */
#ifndef HEWN_SRC_APP_VALIDATION_H
#define HEWN_SRC_APP_VALIDATION_H

#include <stdbool.h>

/* Whether HEWN_VALIDATION asks for Vulkan's validation layer: it is set, and neither empty nor "0". */
bool hewn_validation_wanted(void);

#endif
