#include "iso/extractor.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/device.h"
#include "iso/fixed_kernel.h"
#include "iso/marching_cubes.h"
#include "shared/lists.h"

extern const char hewn_text_iso_head[], hewn_text_cull[], hewn_text_signs[], hewn_text_suspects[], hewn_text_vertices[],
    hewn_text_choose[], hewn_text_keep_lists[], hewn_text_vertices_listed[];

HEWN_SHADER(clip);
HEWN_SHADER(compact);
HEWN_SHADER(cuts);
HEWN_SHADER(link);
HEWN_SHADER(classify);
HEWN_SHADER(remote);
HEWN_SHADER(spread);
HEWN_SHADER(triangles);
HEWN_SHADER(gather);

static hewn_result create_field_programs(hewn_extractor *extractor, hewn_error *error)
{
    enum { STRAIGHT = 1, LISTED = 2 };
    const bool host = extractor->on_host;
    const int wanted = hewn_code_is_listed(extractor->code) ? LISTED : STRAIGHT;
    /* Those of vertices first: their machine code takes longest. */
    const struct {
        hewn_kernel_desc desc;
        hewn_program **place;
        int made_for; /* straight code, lists or both */
    } kernels[] = {
        {{"vertices", hewn_text_iso_head, hewn_text_vertices, HEWN_FLAVOUR_ALONG, sizeof(struct hewn_vertex_push),
          true},
         &extractor->vertices,
         STRAIGHT},
        {{"vertices_listed", hewn_text_iso_head, hewn_text_vertices_listed, HEWN_FLAVOUR_FOUR | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_listed_vertex_push), true},
         &extractor->vertices,
         LISTED},
        {{"cull", hewn_text_iso_head, hewn_text_cull, HEWN_FLAVOUR_INTERVAL, sizeof(struct hewn_cull_push), true},
         &extractor->cull,
         STRAIGHT},
        {{"choose", hewn_text_iso_head, hewn_text_choose, HEWN_FLAVOUR_CHOICES | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_choose_push), true},
         &extractor->choose,
         LISTED},
        {{"keep_lists", hewn_text_iso_head, hewn_text_keep_lists, HEWN_FLAVOUR_CHOICES, sizeof(struct hewn_keep_push),
          !host},
         &extractor->keep_lists,
         LISTED},
        {{"signs", hewn_text_iso_head, hewn_text_signs, HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_sign_push), true},
         &extractor->signs,
         STRAIGHT | LISTED},
        {{"suspects", hewn_text_iso_head, hewn_text_suspects, HEWN_FLAVOUR_INTERVAL | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_suspect_push), true},
         &extractor->suspects.find,
         STRAIGHT | LISTED},
    };
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
        hewn_kernel_desc desc = kernels[i].desc;
        desc.flavours |= hewn_extractor_flavour(extractor);
        if (kernels[i].made_for & wanted)
            HEWN_TRY(hewn_code_program(extractor->device, extractor->code, &desc, kernels[i].place, error));
    }
    return HEWN_OK;
}

static void clear_field_programs(hewn_extractor *extractor)
{
    hewn_program **programs[] = {&extractor->cull,   &extractor->signs,      &extractor->vertices,
                                 &extractor->choose, &extractor->keep_lists, &extractor->suspects.find};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        hewn_program_destroy(extractor->device, programs[i]);
    hewn_mc33_clear(extractor);
    hewn_dual_clear(extractor);
}

uint32_t hewn_extractor_flavour(const hewn_extractor *extractor)
{
    return extractor->far ? 0 : HEWN_FLAVOUR_NEAR;
}

hewn_result hewn_extractor_reach(hewn_extractor *extractor, const struct hewn_grid *grid, hewn_error *error)
{
    double most = 0;
    for (int axis = 0; axis < 3; axis++)
        most = fmax(most, fmax(fabs((double)grid->origin[axis]), fabs((double)grid->far[axis])));
    bool far = extractor->far || most > HEWN_REACH;
    bool there = extractor->suspects.find; /* the last one: all were made */
    if (far == extractor->far && there)
        return HEWN_OK;
    extractor->far = far;
    clear_field_programs(extractor);
    return create_field_programs(extractor, error);
}

static hewn_result create_fixed_programs(hewn_extractor *extractor, hewn_error *error)
{
    const bool host = extractor->on_host, listed = hewn_code_is_listed(extractor->code);
    const hewn_fixed_kernel kernels[] = {
        HEWN_FIXED_KERNEL(clip, clip_push, false, false, &extractor->clip),
        HEWN_FIXED_KERNEL(compact, compact_push, false, !listed, &extractor->compact),
        HEWN_FIXED_KERNEL(gather, gather_push, false, false, &extractor->gather),
        HEWN_FIXED_KERNEL(link, link_push, false, true, &extractor->link),
        HEWN_FIXED_KERNEL(classify, classify_push, true, !host, &extractor->classify),
        HEWN_FIXED_KERNEL(cuts, cut_push, false, !host, &extractor->suspects.cuts),
        HEWN_FIXED_KERNEL(remote, remote_push, false, !host, &extractor->suspects.remote),
        HEWN_FIXED_KERNEL(spread, spread_push, true, !host, &extractor->spread),
        HEWN_FIXED_KERNEL(triangles, triangle_push, true, !host, &extractor->triangles),
    };
    return hewn_fixed_kernels_create(extractor->device, kernels, sizeof kernels / sizeof *kernels, error);
}

static hewn_result create_table(hewn_extractor *extractor, hewn_error *error)
{
    hewn_mc_table table;
    hewn_mc_table_derive(&table);
    HEWN_TRY(hewn_buffer_create(extractor->device, "marching cubes table", sizeof table, HEWN_BUFFER_UPLOAD,
                                &extractor->table, error));
    memcpy(extractor->table.mapped, &table, sizeof table);
    return HEWN_OK;
}

static hewn_result create_parts(hewn_extractor *extractor, const hewn_field *field, hewn_node root,
                                const hewn_code_desc *desc, hewn_error *error)
{
    HEWN_TRY(hewn_code_create_as(extractor->device, field, root, desc, &extractor->code, error));
    HEWN_TRY(hewn_scan_create(extractor->device, !hewn_code_is_listed(extractor->code), &extractor->scan, error));
    HEWN_TRY(create_table(extractor, error));
    HEWN_TRY(create_fixed_programs(extractor, error));
    return create_field_programs(extractor, error);
}

hewn_result hewn_extractor_create_as(hewn_device *device, const hewn_field *field, hewn_node root,
                                     const hewn_code_desc *desc, hewn_extractor **out, hewn_error *error)
{
    *out = NULL;
    hewn_extractor *extractor = hewn_alloc_zero(1, sizeof *extractor);
    if (!extractor)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an extractor");
    extractor->device = device;
    extractor->on_host = device->info.kind == HEWN_DEVICE_CPU;
    hewn_result result = create_parts(extractor, field, root, desc, error);
    if (result != HEWN_OK) {
        hewn_extractor_destroy(&extractor);
        return result;
    }
    *out = extractor;
    return HEWN_OK;
}

hewn_result hewn_extractor_create_with(hewn_device *device, const hewn_field *field, hewn_node root,
                                       hewn_numbers numbers, hewn_extractor **out, hewn_error *error)
{
    return hewn_extractor_create_as(device, field, root, &(hewn_code_desc){.numbers = numbers}, out, error);
}

hewn_result hewn_extractor_create(hewn_device *device, const hewn_field *field, hewn_node root, hewn_extractor **out,
                                  hewn_error *error)
{
    return hewn_extractor_create_with(device, field, root, HEWN_NUMBERS_AUTO, out, error);
}

hewn_result hewn_extractor_renumber(hewn_extractor *extractor, const hewn_field *field, hewn_node root, bool *taken,
                                    hewn_error *error)
{
    return hewn_code_renumber(extractor->code, field, root, taken, error);
}

void hewn_extractor_destroy(hewn_extractor **extractor_place)
{
    hewn_extractor *extractor = *extractor_place;
    if (!extractor)
        return;
    hewn_device *device = extractor->device;
    hewn_program **programs[] = {&extractor->clip,     &extractor->compact,       &extractor->link,
                                 &extractor->classify, &extractor->spread,        &extractor->triangles,
                                 &extractor->gather,   &extractor->suspects.cuts, &extractor->suspects.remote};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        hewn_program_destroy(device, programs[i]);
    clear_field_programs(extractor);
    hewn_buffer_destroy(device, &extractor->table);
    hewn_scan_destroy(device, &extractor->scan);
    hewn_code_destroy(device, &extractor->code);
    hewn_free(extractor);
    *extractor_place = NULL;
}
