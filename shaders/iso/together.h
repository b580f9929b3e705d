/* GLSL only: in kernels whose subgroups read the field's lists together, all stay until the last one is done. */
#ifndef HEWN_SHADERS_ISO_TOGETHER_H
#define HEWN_SHADERS_ISO_TOGETHER_H

#ifdef FIELD_TOGETHER
#define somebody(condition) subgroupAny(condition)
#define everybody(condition) subgroupAll(condition)
#else
#define somebody(condition) (condition)
#define everybody(condition) (condition)
#endif

#endif
