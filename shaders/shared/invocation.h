/* GLSL only: which of a dispatch's invocations this is, when its workgroups are laid out in two dimensions to pass the
 * limit of 65,535 in one. A macro, since the workgroup's size means nothing above the kernel's own layout. */
#ifndef HEWN_SHADERS_SHARED_INVOCATION_H
#define HEWN_SHADERS_SHARED_INVOCATION_H

#define invocation()                                                                                                   \
    ((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

#endif
