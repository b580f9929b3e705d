/* What lets one header declare a struct for C and for GLSL: scalars, arrays of them, and addresses of device memory. */
#ifndef HEWN_SHADERS_SHARED_TYPES_H
#define HEWN_SHADERS_SHARED_TYPES_H

#ifdef GL_core_profile
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Uints
{
    uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats
{
    float at[];
};
#define HEWN_UINTS Uints
#define HEWN_FLOATS Floats
#define HEWN_UINT uint
#else
#include <stdint.h>
#define HEWN_UINTS uint64_t
#define HEWN_FLOATS uint64_t
#define HEWN_UINT uint32_t
#endif

#endif
