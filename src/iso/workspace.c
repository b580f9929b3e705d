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

hewn_result hewn_workspace_read(hewn_workspace *workspace, const hewn_buffer *buffer, uint64_t offset, uint64_t bytes,
                                const void **out, hewn_error *error)
{
    hewn_buffer *home;
    hewn_commands *commands;
    *out = buffer->mapped ? (const char *)buffer->mapped + offset : NULL;
    if (buffer->mapped)
        return HEWN_OK;
    HEWN_TRY(hewn_workspace_take(workspace, "a copy on the host", bytes, HEWN_BUFFER_READBACK, &home, error));
    *out = home->mapped;
    if (bytes == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_commands_begin(workspace->device, &commands, error));
    hewn_commands_copy(commands, buffer, offset, home, 0, bytes);
    return hewn_commands_submit(&commands, NULL, error);
}

hewn_result hewn_buffer_bring_home(hewn_device *device, const char *what, hewn_buffer *buffer, hewn_error *error)
{
    hewn_buffer home;
    hewn_commands *commands;
    if (buffer->mapped)
        return HEWN_OK;
    HEWN_TRY(hewn_buffer_create(device, what, buffer->size, HEWN_BUFFER_READBACK, &home, error));
    hewn_result result = hewn_commands_begin(device, &commands, error);
    if (result == HEWN_OK) {
        hewn_commands_copy(commands, buffer, 0, &home, 0, buffer->size);
        result = hewn_commands_submit(&commands, NULL, error);
    }
    hewn_buffer_destroy(device, result == HEWN_OK ? buffer : &home);
    if (result == HEWN_OK)
        *buffer = home;
    return result;
}

hewn_dispatch_size hewn_groups_for(uint64_t count, uint32_t size)
{
    uint64_t groups = (count + size - 1) / size;
    uint64_t rows = (groups + 32767) / 32768;
    return (hewn_dispatch_size){(uint32_t)(rows > 1 ? 32768 : groups), (uint32_t)(rows ? rows : 1), 1};
}
