/* What the tests of the commands for mesh files share: small files, and runs as on a machine without Vulkan. */
#ifndef HEWN_TESTS_CLI_MESH_FILES_H
#define HEWN_TESTS_CLI_MESH_FILES_H

#include <unistd.h>

#include "json_read.h"
#include "run.h"

#define NO_LOADER "HEWN_VULKAN_LOADER=/nonexistent/libvulkan.so"

/* A box from 0,0,0 to 1,2,3 of quadrilaterals, with groups and texture coordinates. */
static const char box_obj[] = "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\nv 0 2 3\n"
                              "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                              "g ends\nf 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\n"
                              "g sides\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";

static inline void assert_has(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("'%s' is missing in: %s", part, text);
}

static inline void assert_lacks(const char *text, const char *part)
{
    if (strstr(text, part))
        fail_msg("'%s' is in: %s", part, text);
}

/* Runs in a folder and expects this exit code. */
static inline run_result run_in(int code, const char *folder, run_desc desc)
{
    desc.folder = folder;
    desc.changes[0] = NO_LOADER;
    return run_expecting(code, &desc);
}

/* Runs what must fail: it says so, prints nothing else, and leaves as many files as there were. */
static inline void fail_in(int code, const char *folder, const char *says, run_desc desc)
{
    int before = run_folder_count(folder);
    run_result result = run_in(code, folder, desc);
    assert_has(result.err, says);
    assert_int_equal(run_folder_count(folder), before);
    run_result_destroy(&result);
}

/* `hewn info FILE --json`; the caller frees the text. */
static inline char *info_of(const char *folder, const char *name)
{
    run_result result = run_in(0, folder, (run_desc){.arguments = {"info", name, "--json"}});
    assert_true(json_is_valid(result.out));
    char *text = strdup(result.out);
    run_result_destroy(&result);
    return text;
}

static inline void assert_same_files(const char *folder, const char *a, const char *b)
{
    size_t a_length, b_length;
    char *a_bytes = run_read_file(run_path(folder, a), &a_length);
    char *b_bytes = run_read_file(run_path(folder, b), &b_length);
    assert_int_equal(a_length, b_length);
    assert_memory_equal(a_bytes, b_bytes, a_length);
    free(a_bytes);
    free(b_bytes);
}

static inline char *read_text(const char *folder, const char *name)
{
    return run_read_file(run_path(folder, name), NULL);
}

/* Runs what must succeed, and returns its report; the caller frees the text. */
static inline char *report_of(const char *folder, run_desc desc)
{
    int count = 0;
    while (desc.arguments[count])
        count++;
    desc.arguments[count] = "--report";
    desc.arguments[count + 1] = "report.json";
    run_result result = run_in(0, folder, desc);
    run_result_destroy(&result);
    char *report = read_text(folder, "report.json");
    assert_true(json_is_valid(report));
    assert_int_equal(unlink(run_path(folder, "report.json")), 0);
    return report;
}

#endif
