/* hewn check and hewn info of mesh files: what is found, as text and JSON, and what --require makes of it. */
#include <math.h>

#include "mesh_files.h"

static const char tetrahedron[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

static char *check_json(const char *folder, const char *name)
{
    run_result result = run_in(0, folder, (run_desc){.arguments = {"check", name, "--json"}});
    assert_true(json_is_valid(result.out));
    assert_string_equal(result.err, "");
    char *text = strdup(result.out);
    run_result_destroy(&result);
    return text;
}

static void test_good_mesh(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.obj"), tetrahedron);
    run_result text = run_in(0, folder, (run_desc){.arguments = {"check", "a.obj"}});
    assert_has(text.out, "a.obj: 4 vertices, 4 faces\n");
    static const char *const lines[] = {"closed                 yes\n",
                                        "manifold               yes\n",
                                        "oriented               yes\n",
                                        "components             1\n",
                                        "genus                  0\n",
                                        "Euler characteristic   2\n",
                                        "volume                 0.166666667\n",
                                        "bounds                 0,0,0 to 1,1,1\n",
                                        "boundary edges         0\n",
                                        "non-manifold edges     0\n",
                                        "non-manifold vertices  0\n",
                                        "degenerate faces       0\n",
                                        "duplicate faces        0\n",
                                        "isolated vertices      0\n",
                                        "self-intersections     0\n"};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        assert_has(text.out, lines[i]);
    run_result_destroy(&text);
    char *json = check_json(folder, "a.obj");
    assert_string_equal(json_string(json, "format"), "obj");
    assert_true(json_bool(json, "certificate.closed"));
    assert_true(json_number(json, "certificate.genus") == 0);
    assert_true(json_number(json, "certificate.self_intersections") == 0);
    assert_true(json_is_null(json, "certificate.max_residual"));
    assert_int_equal(json_count(json, "certificate.component_list"), 1);
    assert_true(json_number(json, "certificate.component_list.0.edges") == 6);
    assert_int_equal(json_count(json, "unmet"), 0);
    free(json);
    static const char all[] = "closed, manifold,oriented,no-self-intersections,no-degenerate-faces,no-duplicate-faces,"
                              "no-isolated-vertices,one-component,positive-volume";
    run_result met = run_in(0, folder, (run_desc){.arguments = {"check", "a.obj", "-q", "--require", all}});
    assert_string_equal(met.out, "");
    assert_string_equal(met.err, "");
    run_result_destroy(&met);
    run_folder_destroy(folder);
}

/* Each fault, and the requirement that it breaks, alone among the faults that it is not. */
static void test_requirements(void **state)
{
    (void)state;
    static const struct {
        const char *more; /* added to the tetrahedron */
        const char *require, *says;
        const char *count; /* in the certificate */
        double is;
    } cases[] = {
        {"v 5 5 5\nv 6 5 5\nv 5 6 5\nf 5 6 7\n", "closed", "closed (3 boundary edges)", "boundary_edges", 3},
        {"v 5 5 5\nv 6 5 5\nv 5 6 5\nf 5 6 7\n", "one-component", "one-component (2 components)", "components", 2},
        {"v 5 5 5\nf 1 3 5\n", "manifold", "manifold (1 non-manifold edges, 2 non-manifold vertices)",
         "non_manifold_edges", 1},
        {"v 0 5 5\nv 1 5 5\nv 0 6 5\nv 1 6 5\nf 5 6 7\nf 6 7 8\n", "oriented", "oriented (1 unoriented edges)",
         "unoriented_edges", 1},
        {"f 1 3 2\n", "no-duplicate-faces", "no-duplicate-faces (1 duplicate faces)", "duplicate_faces", 1},
        {"f 1 3 1\n", "no-degenerate-faces", "no-degenerate-faces (1 degenerate faces)", "degenerate_faces", 1},
        {"v 5 5 5\n", "no-isolated-vertices", "no-isolated-vertices (1 isolated vertices)", "isolated_vertices", 1},
        {"v 0.1 0.1 -1\nv 0.2 0.1 1\nv 0.1 0.2 1\nf 5 6 7\n", "no-self-intersections", "no-self-intersections (", NULL,
         0},
    };
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", tetrahedron, cases[i].more);
        run_write_file(run_path(folder, "a.obj"), text);
        run_desc desc = {.arguments = {"check", "a.obj", "--json", "--require", cases[i].require}};
        run_result result = run_in(1, folder, desc);
        assert_has(result.err, "hewn: a.obj: not met: ");
        assert_has(result.err, cases[i].says);
        assert_true(json_is_valid(result.out));
        assert_string_equal(json_string(result.out, "unmet.0"), cases[i].require);
        assert_int_equal(json_count(result.out, "unmet"), 1);
        char path[64];
        snprintf(path, sizeof path, "certificate.%s", cases[i].count ? cases[i].count : "self_intersections");
        assert_true(cases[i].count ? json_number(result.out, path) == cases[i].is : json_number(result.out, path) > 0);
        run_result_destroy(&result);
        /* Without the requirement it is no failure. */
        result = run_in(0, folder, (run_desc){.arguments = {"check", "a.obj"}});
        run_result_destroy(&result);
    }
    run_write_file(run_path(folder, "a.obj"),
                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 2 3 1\nf 4 2 1\nf 4 3 2\nf 3 4 1\n");
    run_desc desc = {.arguments = {"check", "a.obj", "-q", "--require", "positive-volume,closed"}};
    run_result result = run_in(1, folder, desc);
    assert_string_equal(result.err, "hewn: a.obj: not met: positive-volume (a volume of -0.166667)\n");
    assert_string_equal(result.out, "");
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"check", "a.obj"}});
    assert_has(result.out, "volume                 -0.166666667 (inside out)\n");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

static void test_several_components(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    char text[512];
    snprintf(text, sizeof text, "%sv 5 5 5\nv 6 5 5\nv 5 6 5\nf 5 6 7\n", tetrahedron);
    run_write_file(run_path(folder, "a.obj"), text);
    run_result result = run_in(0, folder, (run_desc){.arguments = {"check", "a.obj"}});
    assert_has(result.out, "components             2\n");
    assert_has(result.out, "boundary edges         3 in 1 loop\n");
    assert_has(result.out, "     faces   vertices  closed");
    assert_has(result.out, "\n         4          4     yes       yes       yes      0      0      0.166667");
    assert_has(result.out, "\n         1          3      no       yes       yes      0      1             -");
    run_result_destroy(&result);
    char *json = check_json(folder, "a.obj");
    assert_int_equal(json_count(json, "certificate.component_list"), 2);
    assert_true(json_number(json, "certificate.component_list.1.boundary_loops") == 1);
    assert_true(json_number(json, "certificate.genus") == -1);
    free(json);
    run_folder_destroy(folder);
}

static void test_self_intersections(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.off"), "OFF\n6 2 0\n0 0 0\n2 0 0\n0 2 0\n0.5 0.5 -1\n0.5 0.5 1\n3 3 1\n"
                                              "3 0 1 2\n3 3 4 5\n");
    run_result result = run_in(0, folder, (run_desc){.arguments = {"check", "a.off"}});
    assert_has(result.out, "self-intersections     1 (faces 0 and 1)\n");
    run_result_destroy(&result);
    char *json = check_json(folder, "a.off");
    assert_true(json_number(json, "certificate.self_intersections") == 1);
    assert_true(json_number(json, "certificate.intersecting_faces.0.1") == 1);
    free(json);
    result = run_in(0, folder, (run_desc){.arguments = {"check", "a.off", "--no-self-intersections", "--json"}});
    assert_true(json_is_null(result.out, "certificate.self_intersections"));
    run_result_destroy(&result);
    result = run_in(0, folder, (run_desc){.arguments = {"check", "a.off", "--no-self-intersections"}});
    assert_has(result.out, "self-intersections     not counted\n");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- info -------------------------------------------------------------------------------------------------------- */

static void test_info(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "a.obj"),
                   "v 0 0 0 1 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\nv 2 0.5 0 1 0 0\nv 9 9 9 0 0 0\n"
                   "vt 0 0\nvt 1 0.25\ng left\nf 1/1 2/2 3/1 4/1\ng right\nf 2/1 5/1 3/2\n");
    run_result text = run_in(0, folder, (run_desc){.arguments = {"info", "a.obj"}});
    assert_has(text.out, "a.obj: mesh (obj)\n");
    assert_has(text.out, "vertices               6\n");
    assert_has(text.out, "faces                  2: 1 triangles, 1 quads, 0 polygons\n");
    assert_has(text.out, "unit                   unknown\n");
    assert_has(text.out, "up                     unknown\n");
    assert_has(text.out, "corner uv: 2 ");
    assert_has(text.out, ", 0 to 1; 0 to 0.25\n");
    assert_has(text.out, "face group: 1 int32, 2 names\n");
    assert_has(text.out, "         1  left\n");
    assert_has(text.out, "isolated vertices      1\n");
    run_result_destroy(&text);
    char *json = info_of(folder, "a.obj");
    assert_true(json_number(json, "counts.corners") == 7);
    assert_true(json_number(json, "counts.quads") == 1);
    assert_true(json_number(json, "counts.most_corners") == 4);
    assert_true(json_is_null(json, "unit"));
    assert_true(json_number(json, "bounds.hi.0") == 9);
    assert_true(json_number(json, "certificate.bounds.hi.0") == 2);
    assert_true(json_is_null(json, "certificate.self_intersections"));
    assert_int_equal(json_count(json, "attributes"), 3);
    for (size_t i = 0; i < 3; i++) {
        char path[64];
        snprintf(path, sizeof path, "attributes.%zu.name", i);
        bool color = strcmp(json_string(json, path), "color") == 0;
        snprintf(path, sizeof path, "attributes.%zu.hi.1", i);
        if (color)
            assert_true(json_number(json, path) == 0.5);
    }
    free(json);
    run_folder_destroy(folder);
}

/* Standard input, a format said aloud, and names that would steer a terminal. */
static void test_info_of_odd_files(void **state)
{
    (void)state;
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "odd"), "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\x1b[31mb\nf 1 2 3\n");
    run_result result = run_in(0, folder, (run_desc){.arguments = {"info", "odd", "--from", "obj"}});
    assert_has(result.out, "[31mb\n");
    assert_lacks(result.out, "\x1b");
    run_result_destroy(&result);
    run_desc desc = {.arguments = {"info", "-", "--from", "obj", "--json"}, .input = run_path(folder, "odd")};
    result = run_in(0, folder, desc);
    assert_string_equal(json_string(result.out, "input"), "-");
    assert_true(json_number(result.out, "counts.faces") == 1);
    run_result_destroy(&result);
    run_write_file(run_path(folder, "empty.obj"), "# nothing\n");
    result = run_in(0, folder, (run_desc){.arguments = {"info", "empty.obj"}});
    assert_has(result.out, "faces                  0\n");
    run_result_destroy(&result);
    run_folder_destroy(folder);
}

/* --- failures ---------------------------------------------------------------------------------------------------- */

static void test_failures(void **state)
{
    (void)state;
    static const struct {
        const char *arguments[8];
        int code;
        const char *says;
    } cases[] = {
        {{"check"}, 2, "which file?"},
        {{"check", "a.obj", "b.obj"}, 2, "one file at a time"},
        {{"check", "a.lua"}, 2, "ends in no mesh format that Hewn reads"},
        {{"check", "-"}, 2, "--from"},
        {{"check", "a.3mf"}, 2, "3MF can be written, but not read"},
        {{"check", "a.obj", "--require", "beautiful"}, 2, "--require: \"beautiful\" is no requirement"},
        {{"check", "a.obj", "--require", ""}, 2, "--require: an empty word"},
        {{"check", "a.obj", "--require", "no-self-intersections", "--no-self-intersections"}, 2, "does not look"},
        {{"check", "a.obj", "--fix"}, 2, "unknown option '--fix'"},
        {{"check", "missing.obj"}, 3, "missing.obj: cannot open"},
        {{"check", "bad.obj"}, 3, "bad.obj"},
        {{"info", "bad.obj"}, 3, "bad.obj"},
        {{"info", "missing.ply.gz"}, 3, "missing.ply.gz: cannot open"},
        {{"info", "a.obj", "--from", "gif"}, 2, "not 'gif'"},
    };
    char *folder = run_folder_create();
    run_write_file(run_path(folder, "bad.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_desc desc = {0};
        memcpy(desc.arguments, cases[i].arguments, sizeof cases[i].arguments);
        fail_in(cases[i].code, folder, cases[i].says, desc);
    }
    run_write_file(run_path(folder, "a.obj"), tetrahedron);
    fail_in(1, folder, "No space left on device", (run_desc){.arguments = {"check", "a.obj"}, .output = "/dev/full"});
    fail_in(1, folder, "No space left on device",
            (run_desc){.arguments = {"check", "a.obj", "--json"}, .output = "/dev/full"});
    run_folder_destroy(folder);
}

static void test_real_files(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        bool closed, manifold, oriented;
    } files[] = {{"mesh-scan/bones.off", true, true, true},          {"mesh-open/cat_head.obj", false, true, true},
                 {"mesh-open/moebius.obj", false, true, false},      {"mesh-misc/torus.off", true, true, true},
                 {"mesh-misc/stl_box_binary.stl", true, true, true}, {"gltf/cube.glb", true, true, true}};
    char *folder = run_folder_create();
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char *json = check_json(folder, run_data_file(files[i].name));
        if (json_bool(json, "certificate.closed") != files[i].closed ||
            json_bool(json, "certificate.manifold") != files[i].manifold ||
            json_bool(json, "certificate.oriented") != files[i].oriented)
            fail_msg("%s: %s", files[i].name, json);
        free(json);
    }
    run_folder_destroy(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_mesh),
        cmocka_unit_test(test_requirements),
        cmocka_unit_test(test_several_components),
        cmocka_unit_test(test_self_intersections),
        cmocka_unit_test(test_info),
        cmocka_unit_test(test_info_of_odd_files),
        cmocka_unit_test(test_failures),
        cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests_name("check", tests, NULL, NULL);
}
