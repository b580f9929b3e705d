#include "base/error.h"
#include "iso/extractor.h"

hewn_result hewn_workspace_take(hewn_workspace *workspace, const char *what, uint64_t bytes, hewn_buffer_use use,
                                hewn_buffer **out, hewn_error *error)
{
    *out = NULL;
    if (workspace->count == HEWN_WORKSPACE_MOST)
        return hewn_fail(error, HEWN_INTERNAL, "a run needs more than %d buffers", HEWN_WORKSPACE_MOST);
    hewn_buffer *buffer = &workspace->buffers[workspace->count];
    HEWN_TRY(hewn_buffer_create(workspace->device, what, bytes, use, buffer, error));
    workspace->count++;
    *out = buffer;
    return HEWN_OK;
}

void hewn_workspace_clear(hewn_workspace *workspace)
{
    while (workspace->count > 0)
        hewn_buffer_destroy(workspace->device, &workspace->buffers[--workspace->count]);
}

hewn_dispatch_size hewn_groups_for(uint64_t count, uint32_t size)
{
    uint64_t groups = (count + size - 1) / size;
    uint64_t rows = (groups + 32767) / 32768;
    return (hewn_dispatch_size){(uint32_t)(rows > 1 ? 32768 : groups), (uint32_t)(rows ? rows : 1), 1};
}
