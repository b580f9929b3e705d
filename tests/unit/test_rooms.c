/* The rule of the house: data moves one way, so a room includes only the rooms below it. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

/* A room and what its files may include besides their own room: rooms of src, and public headers as hewn/NAME. Public
 * headers that hold only plain types and results (base, field's nodes and boxes, triangles) are open to every room. */
typedef struct room {
    const char *name;
    const char *may_include;
} room;

static const room rooms[] = {
    {"base", ""},
    {"geom", "base"},
    {"mesh", "base geom hewn/mesh"},
    {"field", "base geom"},
    {"gpu", "base hewn/device"},
    {"eval", "base geom field gpu hewn/device"},
    {"iso", "base geom field gpu eval hewn/device hewn/extract"},
    {"render", "base geom field gpu eval hewn/device hewn/render"},
    {"scene", "base geom field hewn/scene"},
    {"io", "base geom mesh field hewn/io hewn/mesh hewn/scene"},
    {"pipeline", "base geom mesh field gpu eval iso render scene io hewn/mesh hewn/device hewn/extract hewn/scene "
                 "hewn/io hewn/job"},
    {"app", "base pipeline hewn/mesh hewn/device hewn/extract hewn/scene hewn/io hewn/job hewn/hewn"},
};
static const char open_headers[] = "hewn/base hewn/field hewn/triangles";

/* The same order for the public headers among themselves. */
static const room headers[] = {
    {"base", ""},
    {"field", "hewn/base"},
    {"triangles", "hewn/base hewn/field"},
    {"mesh", "hewn/base hewn/field hewn/triangles"},
    {"device", "hewn/base"},
    {"extract", "hewn/base hewn/field hewn/triangles hewn/device"},
    {"scene", "hewn/base hewn/field"},
    {"io", "hewn/base hewn/field hewn/triangles hewn/mesh hewn/scene"},
    {"job", "hewn/base hewn/field hewn/triangles hewn/mesh hewn/device hewn/extract hewn/scene hewn/io"},
    {"hewn", "hewn/base hewn/field hewn/triangles hewn/mesh hewn/device hewn/extract hewn/scene hewn/io hewn/job"},
};

static bool has_word(const char *words, const char *word, size_t length)
{
    for (const char *at = words; (at = strstr(at, word)) != NULL; at += length) {
        bool begins = at == words || at[-1] == ' ';
        bool ends = at[length] == ' ' || at[length] == '\0';
        if (begins && ends)
            return true;
    }
    return false;
}

/* Whether `target`, the text between the quotes of an #include, is allowed by `owner`. */
static bool allowed(const room *owner, const char *target, bool is_public)
{
    char name[128] = "";
    const char *slash = strchr(target, '/');
    if (strncmp(target, "../", 3) == 0 || strlen(target) >= sizeof name)
        return false;
    if (slash == NULL)
        return !is_public; /* a neighbour in the same folder */
    if (strncmp(target, "hewn/", 5) == 0)
        snprintf(name, sizeof name, "%.*s", (int)strcspn(target, "."), target);
    else
        snprintf(name, sizeof name, "%.*s", (int)(slash - target), target);
    if (!is_public && (strcmp(name, owner->name) == 0 || strcmp(name, "shared") == 0))
        return true;
    if (has_word(owner->may_include, name, strlen(name)))
        return true;
    return !is_public && has_word(open_headers, name, strlen(name));
}

/* Reads the name between quotes if a line is an #include of such a name. */
static bool read_include(const char *line, char target[256])
{
    line += strspn(line, " \t");
    if (*line != '#')
        return false;
    line += 1 + strspn(line + 1, " \t");
    return sscanf(line, "include \"%255[^\"\n]\"", target) == 1;
}

/* How many lines of `text` include what `owner` may not; each is printed. */
static int count_wrong_includes(const room *owner, const char *path, const char *text, bool is_public)
{
    int wrong = 0, line = 1;
    for (const char *at = text; at != NULL && *at != '\0'; line++) {
        char target[256];
        if (read_include(at, target) && !allowed(owner, target, is_public)) {
            print_message("# %s:%d includes %s\n", path, line, target);
            wrong++;
        }
        at = strchr(at, '\n');
        at = at != NULL ? at + 1 : NULL;
    }
    return wrong;
}

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    struct stat status;
    assert_int_equal(fstat(fileno(file), &status), 0);
    char *text = calloc((size_t)status.st_size + 1, 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)status.st_size, file), (size_t)status.st_size);
    fclose(file);
    return text;
}

static bool ends_with(const char *string, const char *end)
{
    size_t length = strlen(string), tail = strlen(end);
    return length >= tail && strcmp(string + length - tail, end) == 0;
}

typedef struct tally {
    int files, wrong;
} tally;

/* Looks at every source in a folder of a room and in the folders inside it. */
static void walk(const room *owner, const char *folder, tally *sum)
{
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char path[4096];
        struct stat status;
        if (entry->d_name[0] == '.')
            continue;
        assert_true(snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) < (int)sizeof path);
        assert_int_equal(stat(path, &status), 0);
        if (S_ISDIR(status.st_mode)) {
            walk(owner, path, sum);
        } else if (ends_with(path, ".c") || ends_with(path, ".h") || ends_with(path, ".cpp") ||
                   ends_with(path, ".hpp")) {
            char *text = read_text(path);
            sum->wrong += count_wrong_includes(owner, path, text, false);
            sum->files++;
            free(text);
        }
    }
    closedir(directory);
}

static const char *source_root(void)
{
    const char *root = getenv("HEWN_SOURCE");
    assert_non_null(root);
    return root;
}

static const room *find_room(const char *name)
{
    for (size_t i = 0; i < sizeof rooms / sizeof rooms[0]; i++)
        if (strcmp(rooms[i].name, name) == 0)
            return &rooms[i];
    return NULL;
}

static void test_no_room_reaches_up(void **state)
{
    (void)state;
    char path[4096];
    snprintf(path, sizeof path, "%s/src", source_root());
    DIR *directory = opendir(path);
    assert_non_null(directory);
    tally sum = {0};
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        struct stat status;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/src/%s", source_root(), entry->d_name);
        assert_int_equal(stat(path, &status), 0);
        if (!S_ISDIR(status.st_mode))
            continue;
        const room *owner = find_room(entry->d_name);
        if (owner == NULL)
            fail_msg("src/%s is not in the table of rooms", entry->d_name);
        walk(owner, path, &sum);
    }
    closedir(directory);
    assert_true(sum.files > 10);
    assert_int_equal(sum.wrong, 0);
}

static void test_public_headers_keep_their_order(void **state)
{
    (void)state;
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/include/hewn", source_root());
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    int wrong = 0;
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char path[4096 + 300];
        const room *owner = NULL;
        if (!ends_with(entry->d_name, ".h"))
            continue;
        for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
            if (strlen(headers[i].name) + 2 == strlen(entry->d_name) &&
                strncmp(headers[i].name, entry->d_name, strlen(headers[i].name)) == 0)
                owner = &headers[i];
        if (owner == NULL)
            fail_msg("include/hewn/%s is not in the table of headers", entry->d_name);
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        char *text = read_text(path);
        wrong += count_wrong_includes(owner, path, text, true);
        free(text);
    }
    closedir(directory);
    assert_int_equal(wrong, 0);
}

/* The checker itself: what it must let through and what it must catch. */
static void test_checker_catches_upward_includes(void **state)
{
    (void)state;
    const room *field = find_room("field"), *iso = find_room("iso"), *app = find_room("app");
    assert_int_equal(count_wrong_includes(field, "good",
                                          "#include <stdio.h>\n#include \"base/alloc.h\"\n#include \"field/graph.h\"\n"
                                          "#include \"graph.h\"\n#include \"hewn/field.h\"\n",
                                          false),
                     0);
    assert_int_equal(count_wrong_includes(field, "bad",
                                          "#include \"iso/cube.h\"\n  #  include \"gpu/gpu.h\"\n"
                                          "#include \"hewn/extract.h\"\n#include \"../base/alloc.h\"\n"
                                          "#include \"hewn/hewn.h\"\n#include \"nowhere/x.h\"\n",
                                          false),
                     6);
    assert_int_equal(count_wrong_includes(iso, "good", "#include \"eval/code.h\"\n#include \"shared/brick.h\"", false),
                     0);
    assert_int_equal(count_wrong_includes(iso, "bad", "\n#include \"mesh/certify.h\"", false), 1);
    assert_int_equal(count_wrong_includes(app, "good", "#include \"hewn/hewn.h\"\n#include \"pipeline/job.h\"", false),
                     0);
    assert_int_equal(count_wrong_includes(app, "bad", "#include \"iso/cube.h\"", false), 1);
    assert_int_equal(count_wrong_includes(&headers[0], "bad", "#include \"hewn/field.h\"", true), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_room_reaches_up),
        cmocka_unit_test(test_public_headers_keep_their_order),
        cmocka_unit_test(test_checker_catches_upward_includes),
    };
    return cmocka_run_group_tests_name("rooms", tests, NULL, NULL);
}
