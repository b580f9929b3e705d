#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
/* What comes before the field in kernels that are completed at run time. */
#include "iso/block.h"
#include "shared/invocation.h"
#include "shared/lists.h"

/* For kernels that ask the field about rows of samples: where sample i of the row is. */
float sample_x(uint i);
