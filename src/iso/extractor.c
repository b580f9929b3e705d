#include "iso/extractor.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/marching_cubes.h"
#include "shared/lists.h"

extern const char hewn_text_iso_head[], hewn_text_cull[], hewn_text_signs[], hewn_text_suspects[], hewn_text_vertices[],
    hewn_text_choose[], hewn_text_keep_lists[], hewn_text_vertices_listed[];

#define HEWN_SHADER(name)                                                                                              \
    extern const unsigned char hewn_shader_##name[];                                                                   \
    extern const size_t hewn_shader_##name##_size;
HEWN_SHADER(compact)
HEWN_SHADER(cuts)
HEWN_SHADER(link)
HEWN_SHADER(classify)
HEWN_SHADER(remote)
HEWN_SHADER(spread)
HEWN_SHADER(triangles)
HEWN_SHADER(gather)
#undef HEWN_SHADER

static hewn_result create_field_programs(hewn_extractor *extractor, hewn_error *error)
{
    const bool listed = hewn_code_is_listed(extractor->code);
    const struct {
        hewn_kernel_desc desc;
        hewn_program **place;
        int only; /* 1: straight code, 2: lists */
    } kernels[] = {
        {{"cull", hewn_text_iso_head, hewn_text_cull, HEWN_FLAVOUR_INTERVAL, sizeof(struct hewn_cull_push)},
         &extractor->cull,
         1},
        {{"choose", hewn_text_iso_head, hewn_text_choose, HEWN_FLAVOUR_CHOICES | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_choose_push)},
         &extractor->choose,
         2},
        {{"keep_lists", hewn_text_iso_head, hewn_text_keep_lists, HEWN_FLAVOUR_CHOICES, sizeof(struct hewn_keep_push)},
         &extractor->keep_lists,
         2},
        {{"signs", hewn_text_iso_head, hewn_text_signs, HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_sign_push)},
         &extractor->signs,
         0},
        {{"vertices", hewn_text_iso_head, hewn_text_vertices, HEWN_FLAVOUR_POINT | HEWN_FLAVOUR_GRADIENT,
          sizeof(struct hewn_vertex_push)},
         &extractor->vertices,
         1},
        {{"vertices_listed", hewn_text_iso_head, hewn_text_vertices_listed, HEWN_FLAVOUR_FOUR | HEWN_FLAVOUR_TOGETHER,
          sizeof(struct hewn_listed_vertex_push)},
         &extractor->vertices,
         2},
        {{"suspects", hewn_text_iso_head, hewn_text_suspects, HEWN_FLAVOUR_INTERVAL, sizeof(struct hewn_suspect_push)},
         &extractor->suspects.find,
         0},
    };
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
        if (kernels[i].only != (listed ? 1 : 2))
            HEWN_TRY(hewn_code_program(extractor->device, extractor->code, &kernels[i].desc, kernels[i].place, error));
    return HEWN_OK;
}

static hewn_result create_fixed_programs(hewn_extractor *extractor, hewn_error *error)
{
    const struct {
        const char *name;
        const unsigned char *spirv;
        size_t bytes;
        size_t push;
        bool table; /* reads the marching cubes table as uniforms */
        hewn_program **place;
    } kernels[] = {
        {"compact", hewn_shader_compact, hewn_shader_compact_size, sizeof(struct hewn_compact_push), false,
         &extractor->compact},
        {"gather", hewn_shader_gather, hewn_shader_gather_size, sizeof(struct hewn_gather_push), false,
         &extractor->gather},
        {"link", hewn_shader_link, hewn_shader_link_size, sizeof(struct hewn_link_push), false, &extractor->link},
        {"classify", hewn_shader_classify, hewn_shader_classify_size, sizeof(struct hewn_classify_push), true,
         &extractor->classify},
        {"cuts", hewn_shader_cuts, hewn_shader_cuts_size, sizeof(struct hewn_cut_push), false,
         &extractor->suspects.cuts},
        {"remote", hewn_shader_remote, hewn_shader_remote_size, sizeof(struct hewn_remote_push), false,
         &extractor->suspects.remote},
        {"spread", hewn_shader_spread, hewn_shader_spread_size, sizeof(struct hewn_spread_push), true,
         &extractor->spread},
        {"triangles", hewn_shader_triangles, hewn_shader_triangles_size, sizeof(struct hewn_triangle_push), true,
         &extractor->triangles},
    };
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
        hewn_program_desc desc = {.name = kernels[i].name,
                                  .spirv = (const uint32_t *)(const void *)kernels[i].spirv,
                                  .spirv_bytes = kernels[i].bytes,
                                  .push_bytes = (uint32_t)kernels[i].push,
                                  .uniforms = kernels[i].table};
        HEWN_TRY(hewn_program_create(extractor->device, &desc, kernels[i].place, error));
    }
    return HEWN_OK;
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
    HEWN_TRY(hewn_scan_create(extractor->device, &extractor->scan, error));
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
    hewn_program **programs[] = {&extractor->cull,
                                 &extractor->signs,
                                 &extractor->vertices,
                                 &extractor->compact,
                                 &extractor->link,
                                 &extractor->classify,
                                 &extractor->spread,
                                 &extractor->triangles,
                                 &extractor->choose,
                                 &extractor->keep_lists,
                                 &extractor->gather,
                                 &extractor->suspects.cuts,
                                 &extractor->suspects.remote,
                                 &extractor->suspects.find};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        hewn_program_destroy(device, programs[i]);
    hewn_mc33_clear(extractor);
    hewn_dual_clear(extractor);
    hewn_buffer_destroy(device, &extractor->table);
    hewn_scan_destroy(device, &extractor->scan);
    hewn_code_destroy(device, &extractor->code);
    hewn_free(extractor);
    *extractor_place = NULL;
}
