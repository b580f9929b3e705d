/* Structs that cross from C to the device: every member is where both think it is. The host fills push constants with
 * each word's own number; a shader reads each member and writes back what it saw, which must be the member's offset in
 * C. */
#include "base/text.h"
#include "gpu_test_device.h"
#include "shared/iso.h"
#include "shared/lists.h"
#include "shared/query.h"
#include "shared/render.h"

extern const char hewn_text_iso_head[], hewn_text_render_head[], hewn_text_query_head[];

typedef struct member {
    const char *name;
    size_t offset;
    const char *reader; /* how GLSL turns it into a uint */
} member;

#define NUMBER "uint"
#define REAL "floatBitsToUint"
#define ADDRESS "low"
#define MEMBER(type, name, reader)                                                                                     \
    {                                                                                                                  \
#name, offsetof(struct type, name), reader                                                                     \
    }
#define GRID(type)                                                                                                     \
    MEMBER(type, grid.origin[0], REAL), MEMBER(type, grid.origin[2], REAL), MEMBER(type, grid.far[0], REAL),           \
        MEMBER(type, grid.far[2], REAL), MEMBER(type, grid.cell, REAL), MEMBER(type, grid.cells[0], NUMBER),           \
        MEMBER(type, grid.cells[2], NUMBER), MEMBER(type, grid.open, NUMBER), MEMBER(type, grid.rim, NUMBER)

static void write_shader(hewn_text *glsl, const char *head, const char *type, const member *members, size_t count)
{
    hewn_text_append(glsl, head);
    hewn_text_append(glsl, "#extension GL_EXT_buffer_reference_uvec2 : require\n#define low(address) uvec2(address).x\n"
                           "layout(local_size_x = 1) in;\n");
    hewn_text_print(glsl,
                    "layout(push_constant, scalar) uniform Push { %s s; };\n"
                    "layout(set = 0, binding = 0, scalar) uniform Where { Uints seen; };\nvoid main() {\n",
                    type);
    for (size_t i = 0; i < count; i++)
        hewn_text_print(glsl, "seen.at[%zu] = %s(s.%s);\n", i, members[i].reader, members[i].name);
    hewn_text_append(glsl, "}\n");
}

static void check_struct(const char *head, const char *type, size_t bytes, const member *members, size_t count)
{
    hewn_error error = {0};
    hewn_text glsl = {0};
    write_shader(&glsl, head, type, members, count);
    assert_true(bytes <= 128 && bytes % 4 == 0);
    hewn_program_desc desc = {.name = type, .glsl = glsl.bytes, .push_bytes = (uint32_t)bytes, .uniforms = true};
    hewn_program *program;
    if (hewn_program_create(device, &desc, &program, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    hewn_buffer where, seen;
    assert_int_equal(hewn_buffer_create(device, "where", 8, HEWN_BUFFER_UPLOAD, &where, NULL), HEWN_OK);
    assert_int_equal(hewn_buffer_create(device, "seen", 4 * count, HEWN_BUFFER_READBACK, &seen, NULL), HEWN_OK);
    memcpy(where.mapped, &seen.address, 8);
    uint32_t words[32];
    for (uint32_t i = 0; i < 32; i++)
        words[i] = i;
    hewn_commands *commands;
    assert_int_equal(hewn_commands_begin(device, &commands, NULL), HEWN_OK);
    hewn_commands_dispatch(commands, program, words, &where, (hewn_dispatch_size){1, 1, 1});
    assert_int_equal(hewn_commands_submit(&commands, NULL, NULL), HEWN_OK);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(((const uint32_t *)seen.mapped)[i] * 4, members[i].offset);
    hewn_buffer_destroy(device, &where);
    hewn_buffer_destroy(device, &seen);
    hewn_program_destroy(device, &program);
    hewn_text_clear(&glsl);
}

#define CHECK(type, ...) CHECK_IN(hewn_text_iso_head, type, __VA_ARGS__)
#define CHECK_IN(head, type, ...)                                                                                      \
    do {                                                                                                               \
        const member members[] = {__VA_ARGS__};                                                                        \
        check_struct(head, #type, sizeof(struct type), members, sizeof members / sizeof *members);                     \
    } while (0)

static void test_field_kernels(void **state)
{
    (void)state;
    CHECK(hewn_cull_push, GRID(hewn_cull_push), MEMBER(hewn_cull_push, size, NUMBER),
          MEMBER(hewn_cull_push, dense[0], NUMBER), MEMBER(hewn_cull_push, dense[2], NUMBER),
          MEMBER(hewn_cull_push, parents, ADDRESS), MEMBER(hewn_cull_push, tested, ADDRESS),
          MEMBER(hewn_cull_push, states, ADDRESS), MEMBER(hewn_cull_push, flags, ADDRESS));
    CHECK(hewn_sign_push, GRID(hewn_sign_push), MEMBER(hewn_sign_push, count, NUMBER),
          MEMBER(hewn_sign_push, bricks, ADDRESS), MEMBER(hewn_sign_push, signs, ADDRESS));
    CHECK(hewn_vertex_push, GRID(hewn_vertex_push), MEMBER(hewn_vertex_push, count, NUMBER),
          MEMBER(hewn_vertex_push, dual, NUMBER), MEMBER(hewn_vertex_push, positions, ADDRESS),
          MEMBER(hewn_vertex_push, normals, ADDRESS), MEMBER(hewn_vertex_push, summary, ADDRESS));
}

static void test_fixed_kernels(void **state)
{
    (void)state;
    CHECK(hewn_compact_push, MEMBER(hewn_compact_push, dense[0], NUMBER), MEMBER(hewn_compact_push, dense[2], NUMBER),
          MEMBER(hewn_compact_push, parents, ADDRESS), MEMBER(hewn_compact_push, states, ADDRESS),
          MEMBER(hewn_compact_push, ranks, ADDRESS), MEMBER(hewn_compact_push, control, ADDRESS),
          MEMBER(hewn_compact_push, kept, ADDRESS));
    CHECK(hewn_clip_push, MEMBER(hewn_clip_push, dense[0], NUMBER), MEMBER(hewn_clip_push, tested, NUMBER),
          MEMBER(hewn_clip_push, top[0], NUMBER), MEMBER(hewn_clip_push, level, NUMBER),
          MEMBER(hewn_clip_push, below, NUMBER), MEMBER(hewn_clip_push, begin, NUMBER),
          MEMBER(hewn_clip_push, end, NUMBER), MEMBER(hewn_clip_push, parents, ADDRESS),
          MEMBER(hewn_clip_push, states, ADDRESS), MEMBER(hewn_clip_push, flags, ADDRESS));
    CHECK(hewn_link_push, MEMBER(hewn_link_push, top[0], NUMBER), MEMBER(hewn_link_push, levels, NUMBER),
          MEMBER(hewn_link_push, count, NUMBER), MEMBER(hewn_link_push, bricks, ADDRESS),
          MEMBER(hewn_link_push, links, ADDRESS), MEMBER(hewn_link_push, states[0], ADDRESS),
          MEMBER(hewn_link_push, states[4], ADDRESS));
    CHECK(hewn_classify_push, MEMBER(hewn_classify_push, cells[0], NUMBER), MEMBER(hewn_classify_push, count, NUMBER),
          MEMBER(hewn_classify_push, bricks, ADDRESS), MEMBER(hewn_classify_push, links, ADDRESS),
          MEMBER(hewn_classify_push, signs, ADDRESS), MEMBER(hewn_classify_push, edges, ADDRESS),
          MEMBER(hewn_classify_push, vertex_counts, ADDRESS), MEMBER(hewn_classify_push, triangle_counts, ADDRESS));
    CHECK(hewn_spread_push, MEMBER(hewn_spread_push, cells[0], NUMBER), MEMBER(hewn_spread_push, count, NUMBER),
          MEMBER(hewn_spread_push, bricks, ADDRESS), MEMBER(hewn_spread_push, vertex_bases, ADDRESS),
          MEMBER(hewn_spread_push, triangle_bases, ADDRESS), MEMBER(hewn_spread_push, vertices, ADDRESS),
          MEMBER(hewn_spread_push, indices, ADDRESS));
    CHECK(hewn_triangle_push, MEMBER(hewn_triangle_push, count, NUMBER), MEMBER(hewn_triangle_push, links, ADDRESS),
          MEMBER(hewn_triangle_push, edges, ADDRESS), MEMBER(hewn_triangle_push, indices, ADDRESS));
}

#define ASKED(type)                                                                                                    \
    MEMBER(type, cells[0], NUMBER), MEMBER(type, cells[2], NUMBER), MEMBER(type, count, NUMBER),                       \
        MEMBER(type, bricks, ADDRESS), MEMBER(type, links, ADDRESS), MEMBER(type, signs, ADDRESS),                     \
        MEMBER(type, table, ADDRESS), MEMBER(type, ranks, ADDRESS), MEMBER(type, asked, ADDRESS)

static void test_trilinear_kernels(void **state)
{
    (void)state;
    CHECK(hewn_mc33_ask_push, ASKED(hewn_mc33_ask_push), MEMBER(hewn_mc33_ask_push, lists, NUMBER));
    CHECK(hewn_mc33_decide_push, GRID(hewn_mc33_decide_push), MEMBER(hewn_mc33_decide_push, count, NUMBER),
          MEMBER(hewn_mc33_decide_push, bricks, ADDRESS), MEMBER(hewn_mc33_decide_push, table, ADDRESS),
          MEMBER(hewn_mc33_decide_push, asked, ADDRESS));
    CHECK(hewn_mc33_count_push, ASKED(hewn_mc33_count_push), MEMBER(hewn_mc33_count_push, triangle_counts, ADDRESS),
          MEMBER(hewn_mc33_count_push, centre_counts, ADDRESS));
    CHECK(hewn_mc33_spread_push, ASKED(hewn_mc33_spread_push), MEMBER(hewn_mc33_spread_push, edges, ADDRESS),
          MEMBER(hewn_mc33_spread_push, vertex_bases, ADDRESS), MEMBER(hewn_mc33_spread_push, triangle_bases, ADDRESS),
          MEMBER(hewn_mc33_spread_push, centre_bases, ADDRESS), MEMBER(hewn_mc33_spread_push, vertices, ADDRESS),
          MEMBER(hewn_mc33_spread_push, indices, ADDRESS), MEMBER(hewn_mc33_spread_push, first, NUMBER));
    CHECK(hewn_mc33_centre_push, GRID(hewn_mc33_centre_push), MEMBER(hewn_mc33_centre_push, count, NUMBER),
          MEMBER(hewn_mc33_centre_push, first, NUMBER), MEMBER(hewn_mc33_centre_push, bricks, ADDRESS),
          MEMBER(hewn_mc33_centre_push, links, ADDRESS), MEMBER(hewn_mc33_centre_push, edges, ADDRESS),
          MEMBER(hewn_mc33_centre_push, positions, ADDRESS), MEMBER(hewn_mc33_centre_push, normals, ADDRESS),
          MEMBER(hewn_mc33_centre_push, summary, ADDRESS));
}

static void test_suspect_kernels(void **state)
{
    (void)state;
    CHECK(hewn_cut_push, MEMBER(hewn_cut_push, cells[0], NUMBER), MEMBER(hewn_cut_push, count, NUMBER),
          MEMBER(hewn_cut_push, bricks, ADDRESS), MEMBER(hewn_cut_push, links, ADDRESS),
          MEMBER(hewn_cut_push, signs, ADDRESS), MEMBER(hewn_cut_push, cuts, ADDRESS));
    CHECK(hewn_remote_push, MEMBER(hewn_remote_push, top[0], NUMBER), MEMBER(hewn_remote_push, levels, NUMBER),
          MEMBER(hewn_remote_push, count, NUMBER), MEMBER(hewn_remote_push, bricks, ADDRESS),
          MEMBER(hewn_remote_push, cuts, ADDRESS), MEMBER(hewn_remote_push, remote, ADDRESS),
          MEMBER(hewn_remote_push, states[0], ADDRESS), MEMBER(hewn_remote_push, states[4], ADDRESS));
    CHECK(hewn_suspect_push, GRID(hewn_suspect_push), MEMBER(hewn_suspect_push, count, NUMBER),
          MEMBER(hewn_suspect_push, bricks, ADDRESS), MEMBER(hewn_suspect_push, signs, ADDRESS),
          MEMBER(hewn_suspect_push, remote, ADDRESS), MEMBER(hewn_suspect_push, marks, ADDRESS),
          MEMBER(hewn_suspect_push, counts, ADDRESS));
}

static void test_list_kernels(void **state)
{
    (void)state;
    CHECK(hewn_choose_push, GRID(hewn_choose_push), MEMBER(hewn_choose_push, size, NUMBER),
          MEMBER(hewn_choose_push, dense[0], NUMBER), MEMBER(hewn_choose_push, dense[2], NUMBER),
          MEMBER(hewn_choose_push, tested, NUMBER), MEMBER(hewn_choose_push, beyond, NUMBER),
          MEMBER(hewn_choose_push, parents, ADDRESS), MEMBER(hewn_choose_push, parent_ranges, ADDRESS),
          MEMBER(hewn_choose_push, states, ADDRESS), MEMBER(hewn_choose_push, flags, ADDRESS),
          MEMBER(hewn_choose_push, choices, ADDRESS));
    CHECK(hewn_gather_push, MEMBER(hewn_gather_push, dense[0], NUMBER), MEMBER(hewn_gather_push, tested, NUMBER),
          MEMBER(hewn_gather_push, parents, ADDRESS), MEMBER(hewn_gather_push, states, ADDRESS),
          MEMBER(hewn_gather_push, ranks, ADDRESS), MEMBER(hewn_gather_push, kept, ADDRESS),
          MEMBER(hewn_gather_push, origins, ADDRESS));
    CHECK(hewn_keep_push, MEMBER(hewn_keep_push, dense, NUMBER), MEMBER(hewn_keep_push, write, NUMBER),
          MEMBER(hewn_keep_push, kept, ADDRESS), MEMBER(hewn_keep_push, parent_ranges, ADDRESS),
          MEMBER(hewn_keep_push, origins, ADDRESS), MEMBER(hewn_keep_push, places, ADDRESS),
          MEMBER(hewn_keep_push, choices, ADDRESS), MEMBER(hewn_keep_push, lists, ADDRESS),
          MEMBER(hewn_keep_push, ranges, ADDRESS));
    CHECK(hewn_listed_vertex_push, GRID(hewn_listed_vertex_push), MEMBER(hewn_listed_vertex_push, count, NUMBER),
          MEMBER(hewn_listed_vertex_push, vertex_count, NUMBER), MEMBER(hewn_listed_vertex_push, first_turn, NUMBER),
          MEMBER(hewn_listed_vertex_push, turns, NUMBER), MEMBER(hewn_listed_vertex_push, bricks, ADDRESS),
          MEMBER(hewn_listed_vertex_push, vertex_bases, ADDRESS), MEMBER(hewn_listed_vertex_push, positions, ADDRESS),
          MEMBER(hewn_listed_vertex_push, normals, ADDRESS), MEMBER(hewn_listed_vertex_push, summary, ADDRESS));
}

#define A(type, name) MEMBER(type, name, ADDRESS)
#define N(type, name) MEMBER(type, name, NUMBER)

static void test_dual_kernels(void **state)
{
    (void)state;
    CHECK(hewn_dual_link_push, N(hewn_dual_link_push, count), A(hewn_dual_link_push, links),
          A(hewn_dual_link_push, lower));
    CHECK(hewn_dual_classify_push, N(hewn_dual_classify_push, cells[0]), N(hewn_dual_classify_push, cells[2]),
          N(hewn_dual_classify_push, count), A(hewn_dual_classify_push, bricks), A(hewn_dual_classify_push, links),
          A(hewn_dual_classify_push, lower), A(hewn_dual_classify_push, signs), A(hewn_dual_classify_push, edges),
          A(hewn_dual_classify_push, loops), A(hewn_dual_classify_push, crossing_counts),
          A(hewn_dual_classify_push, vertex_counts), A(hewn_dual_classify_push, quad_counts));
    CHECK(hewn_dual_spread_push, N(hewn_dual_spread_push, cells[0]), N(hewn_dual_spread_push, cells[2]),
          N(hewn_dual_spread_push, count), A(hewn_dual_spread_push, bricks), A(hewn_dual_spread_push, links),
          A(hewn_dual_spread_push, signs), A(hewn_dual_spread_push, edges), A(hewn_dual_spread_push, loops),
          A(hewn_dual_spread_push, crossing_bases), A(hewn_dual_spread_push, vertex_bases),
          A(hewn_dual_spread_push, quad_bases), A(hewn_dual_spread_push, points), A(hewn_dual_spread_push, positions),
          A(hewn_dual_spread_push, passed), A(hewn_dual_spread_push, indices));
    CHECK(hewn_dual_vertex_push, GRID(hewn_dual_vertex_push), N(hewn_dual_vertex_push, count),
          N(hewn_dual_vertex_push, beyond), A(hewn_dual_vertex_push, bricks), A(hewn_dual_vertex_push, links),
          A(hewn_dual_vertex_push, edges), A(hewn_dual_vertex_push, points), A(hewn_dual_vertex_push, point_normals),
          A(hewn_dual_vertex_push, positions), A(hewn_dual_vertex_push, normals), A(hewn_dual_vertex_push, summary));
    CHECK(hewn_dual_quad_push, GRID(hewn_dual_quad_push), N(hewn_dual_quad_push, count), N(hewn_dual_quad_push, keep),
          A(hewn_dual_quad_push, bricks), A(hewn_dual_quad_push, links), A(hewn_dual_quad_push, passed),
          A(hewn_dual_quad_push, edges), A(hewn_dual_quad_push, loops), A(hewn_dual_quad_push, points),
          A(hewn_dual_quad_push, positions), A(hewn_dual_quad_push, indices), A(hewn_dual_quad_push, crossings));
    CHECK(hewn_dual_fan_push, N(hewn_dual_fan_push, count), N(hewn_dual_fan_push, makes),
          N(hewn_dual_fan_push, vertices), A(hewn_dual_fan_push, crossings), A(hewn_dual_fan_push, ranks),
          A(hewn_dual_fan_push, points), A(hewn_dual_fan_push, point_normals), A(hewn_dual_fan_push, positions),
          A(hewn_dual_fan_push, normals), A(hewn_dual_fan_push, indices));
}

static void test_rays_and_questions(void **state)
{
    (void)state;
    CHECK_IN(hewn_text_render_head, hewn_trace_push, MEMBER(hewn_trace_push, rays, ADDRESS),
             MEMBER(hewn_trace_push, hits, ADDRESS), MEMBER(hewn_trace_push, cells, ADDRESS),
             MEMBER(hewn_trace_push, lo[0], REAL), MEMBER(hewn_trace_push, hi[2], REAL),
             MEMBER(hewn_trace_push, light[1], REAL), MEMBER(hewn_trace_push, softness, REAL),
             MEMBER(hewn_trace_push, reach, REAL), MEMBER(hewn_trace_push, ground, REAL),
             MEMBER(hewn_trace_push, steepness, REAL), MEMBER(hewn_trace_push, slope, REAL),
             MEMBER(hewn_trace_push, slack, REAL), MEMBER(hewn_trace_push, nearness, REAL),
             MEMBER(hewn_trace_push, spread, REAL), MEMBER(hewn_trace_push, count, NUMBER),
             MEMBER(hewn_trace_push, cells_across, NUMBER), MEMBER(hewn_trace_push, up, NUMBER),
             MEMBER(hewn_trace_push, flags, NUMBER));
    CHECK_IN(hewn_text_query_head, hewn_query_push, MEMBER(hewn_query_push, questions, ADDRESS),
             MEMBER(hewn_query_push, answers, ADDRESS), MEMBER(hewn_query_push, lo[0], REAL),
             MEMBER(hewn_query_push, hi[2], REAL), MEMBER(hewn_query_push, tolerance, REAL),
             MEMBER(hewn_query_push, fine, REAL), MEMBER(hewn_query_push, steepness, REAL),
             MEMBER(hewn_query_push, wide_steepness, REAL), MEMBER(hewn_query_push, wide_lo[0], REAL),
             MEMBER(hewn_query_push, wide_hi[2], REAL), MEMBER(hewn_query_push, count, NUMBER),
             MEMBER(hewn_query_push, levels, NUMBER), MEMBER(hewn_query_push, most_steps, NUMBER));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays_and_questions), cmocka_unit_test(test_field_kernels),
        cmocka_unit_test(test_fixed_kernels),      cmocka_unit_test(test_trilinear_kernels),
        cmocka_unit_test(test_dual_kernels),       cmocka_unit_test(test_suspect_kernels),
        cmocka_unit_test(test_list_kernels),
    };
    return cmocka_run_group_tests_name("layout", tests, open_device, close_device);
}
