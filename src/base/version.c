#include "hewn/base.h"

const char *hewn_version(void)
{
    return HEWN_VERSION; /* defined by meson.build from the project's version */
}
