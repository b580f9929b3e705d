/* Fans in the place of quads that two triangles cannot cut without leaving the quad's envelope: counted when all
 * vertices have their places, and only then are the buffers made longer. */
#include <string.h>

#include "base/error.h"
#include "iso/extractor.h"

typedef struct fanning {
    const hewn_extractor *extractor;
    const hewn_dual_hermite *kept;
    hewn_surface *surface;
    hewn_buffer *buffers; /* positions, normals, indices */
    hewn_buffer *ranks;
    uint64_t first, quads; /* that may become fans: a part's own */
    uint32_t count;
} fanning;

static void record_fans(const fanning *run, bool makes, hewn_commands *commands)
{
    struct hewn_dual_fan_push push = {.count = (uint32_t)run->quads,
                                      .makes = makes,
                                      .vertices = (uint32_t)run->surface->vertex_count,
                                      .crossings = run->kept->crossings->address + 4 * run->first,
                                      .ranks = run->ranks->address,
                                      .points = run->kept->points->address,
                                      .point_normals = run->kept->normals->address,
                                      .positions = run->buffers[0].address,
                                      .normals = run->buffers[1].address,
                                      .indices = run->buffers[2].address + 24 * run->first};
    hewn_commands_dispatch(commands, run->extractor->dual.fans, &push, NULL, hewn_groups_for(run->quads, 64));
}

static hewn_result count_fans(fanning *run, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t quads = run->quads;
    hewn_buffer *total, *result, *scratch;
    HEWN_TRY(hewn_workspace_take(workspace, "fans", 4 * quads, HEWN_BUFFER_DEVICE, &run->ranks, error));
    HEWN_TRY(hewn_workspace_take(workspace, "fans in all", 8, HEWN_BUFFER_DEVICE, &total, error));
    HEWN_TRY(hewn_workspace_take(workspace, "fans in all", 8, HEWN_BUFFER_READBACK, &result, error));
    HEWN_TRY(hewn_workspace_take(workspace, "scratch of sums", hewn_scan_scratch_bytes(quads), HEWN_BUFFER_DEVICE,
                                 &scratch, error));
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
    record_fans(run, false, commands);
    hewn_scan_record(run->extractor->scan, commands, run->ranks->address, quads, total->address, scratch->address);
    hewn_commands_copy(commands, total, 0, result, 0, 8);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    const uint32_t *sum = result->mapped;
    uint64_t most = run->surface->triangle_count + 2 * (uint64_t)sum[0];
    HEWN_TRY(hewn_scan_check((const uint32_t[2]){(uint32_t)most, (uint32_t)(most >> 32)}, "triangles", error));
    run->count = sum[0];
    return HEWN_OK;
}

/* Longer buffers that begin as the old ones do. */
static hewn_result lengthen(fanning *run, hewn_error *error)
{
    static const char *const what[3] = {"positions", "normals", "indices"};
    const uint64_t items[3] = {1, 1, 2};
    hewn_device *device = run->extractor->device;
    for (int i = 0; i < 3; i++) {
        hewn_buffer longer;
        uint64_t size = run->buffers[i].size;
        HEWN_TRY(
            hewn_buffer_create(device, what[i], size + 12 * items[i] * run->count, HEWN_BUFFER_DEVICE, &longer, error));
        hewn_commands *commands;
        hewn_result result = hewn_commands_begin(device, &commands, error);
        if (result == HEWN_OK) {
            hewn_commands_copy(commands, &run->buffers[i], 0, &longer, 0, size);
            result = hewn_commands_submit(&commands, NULL, error);
        }
        hewn_buffer_destroy(device, result == HEWN_OK ? &run->buffers[i] : &longer);
        HEWN_TRY(result);
        run->buffers[i] = longer;
    }
    return HEWN_OK;
}

hewn_result hewn_dual_add_fans(const hewn_extractor *extractor, const hewn_dual_hermite *kept, hewn_surface *surface,
                               hewn_buffer buffers[3], hewn_workspace *workspace, hewn_error *error)
{
    fanning run = {.extractor = extractor, .kept = kept, .surface = surface, .buffers = buffers};
    hewn_commands *commands;
    hewn_own own = hewn_surface_own(surface);
    run.first = own.triangles[0] / 2;
    run.quads = own.triangles[1] / 2 - run.first;
    if (run.quads == 0)
        return HEWN_OK;
    HEWN_TRY(count_fans(&run, workspace, error));
    if (run.count == 0)
        return HEWN_OK;
    HEWN_TRY(lengthen(&run, error));
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    record_fans(&run, true, commands);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    surface->vertex_count += run.count;
    surface->triangle_count += 2 * (uint64_t)run.count;
    surface->fan_count = run.count;
    return HEWN_OK;
}
