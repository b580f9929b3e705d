/* GLSL only: which of a dispatch's invocations this is, when its workgroups are laid out in two dimensions to pass the
 * limit of 65,535 in one. A macro, since the workgroup's size means nothing above the kernel's own layout. */
#ifndef HEWN_SHADERS_SHARED_INVOCATION_H
#define HEWN_SHADERS_SHARED_INVOCATION_H

#define invocation()                                                                                                   \
    ((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

/* The same for kernels whose workgroups differ in what they cost, as those do that walk over lists. A driver on a CPU
 * gives each thread a run of workgroups, and those of a dear region stand together; here what was neighbours stands in
 * 16 places, so that each run has its share. */
#define SHARES 16u

uint spread_group(uint group, uint groups)
{
    uint share = groups / SHARES;
    return group < share * SHARES ? group % share * SHARES + group / share : group;
}

#define spread_invocation()                                                                                            \
    (spread_group(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, gl_NumWorkGroups.x * gl_NumWorkGroups.y) * \
         gl_WorkGroupSize.x +                                                                                          \
     gl_LocalInvocationID.x)

#endif
