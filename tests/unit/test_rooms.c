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

/* A room and what its files may include besides their own room: rooms, and single public headers as hewn/NAME. */
typedef struct room {
    const char *name;
    const char *may_include;
} room;

static const room rooms[] = {
    {"base", ""},
    {"geom", "base"},
    {"volume", "base geom"},
    {"mesh", "base geom"},
    {"smooth", "base geom mesh"},
    {"subdivide", "base geom mesh"},
    {"simplify", "base geom mesh"},
    {"lod", "base geom mesh simplify"},
    {"outcore", "base geom mesh simplify"},
    {"progressive", "base geom mesh"},
    {"clusters", "base geom mesh progressive"},
    {"labels", "base geom volume mesh smooth simplify"},
    {"field", "base geom"},
    {"lanes", "base field"},
    {"voxelize", "base geom mesh field lanes"},
    {"gpu", "base"},
    {"eval", "base geom field gpu"},
    {"iso", "base geom volume field gpu eval"},
    {"render", "base geom field lanes gpu eval"},
    {"query", "base geom field lanes gpu eval render"},
    {"font", "base field"},
    {"atlas", "base field font"},
    {"scene", "base geom field font"},
    {"io", "base geom volume mesh progressive clusters field"},
    {"pipeline",
     "base geom volume mesh smooth labels subdivide simplify lod outcore progressive clusters field lanes voxelize "
     "gpu eval iso render query font atlas scene io"},
    {"app", "base pipeline hewn"}, /* hewn: every public header */
};

/* Each public header and the room that it speaks for: whoever may include the room may include the header. "open"
 * headers hold only plain types and results and are for every room; "hewn" is for what stands outside the house. */
typedef struct header {
    const char *name;
    const char *room;
} header;

static const header headers[] = {
    {"base", "open"},
    {"field", "open"},
    {"triangles", "open"},
    {"device", "gpu"},
    {"check", "mesh"},
    {"units", "open"},
    {"model", "mesh"},
    {"mesh", "mesh"},
    {"repair", "mesh"},
    {"mesh_views", "mesh"},
    {"evaluate", "eval"},
    {"extract", "iso"},
    {"scene", "scene"},
    {"io", "io"},
    {"job", "pipeline"},
    {"file_job", "pipeline"},
    {"hewn", "hewn"},
    {"smooth", "smooth"},
    {"subdivide", "subdivide"},
    {"volume", "volume"},
    {"volume_io", "io"},
    {"simplify", "simplify"},
    {"distance", "mesh"},
    {"lod", "lod"},
    {"progressive", "progressive"},
    {"refinement", "progressive"},
    {"clusters", "clusters"},
    {"lod_job", "pipeline"},
    {"progressive_job", "pipeline"},
    {"clusters_job", "pipeline"},
    {"volume_extract", "iso"},
    {"volume_job", "pipeline"},
    {"labels", "labels"},
    {"picture", "open"},
    {"render", "render"},
    {"render_job", "pipeline"},
    {"font", "font"},
    {"atlas", "atlas"},
    {"atlas_job", "pipeline"},
    {"sampling", "open"},
    {"sampling_io", "io"},
    {"heights", "io"},
    {"voxelize", "voxelize"},
    {"voxelize_job", "pipeline"},
    {"query", "query"},
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

static const room *find_room(const char *name)
{
    for (size_t i = 0; i < sizeof rooms / sizeof rooms[0]; i++)
        if (strcmp(rooms[i].name, name) == 0)
            return &rooms[i];
    return NULL;
}

/* The room of a public header by its file's name, with or without the folder before it; NULL for an unknown one. */
static const char *room_of_header(const char *file)
{
    const char *slash = strrchr(file, '/');
    const char *name = slash != NULL ? slash + 1 : file;
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
        size_t length = strlen(headers[i].name);
        if (strncmp(name, headers[i].name, length) == 0 && strcmp(name + length, ".h") == 0)
            return headers[i].room;
    }
    return NULL;
}

static bool may_use_room(const room *owner, const char *name)
{
    return strcmp(name, owner->name) == 0 || has_word(owner->may_include, name, strlen(name));
}

/* Whether a file of `owner` may include `target`, the text between the quotes. */
static bool allowed(const room *owner, const char *target)
{
    char name[128];
    const char *slash = strchr(target, '/');
    if (strncmp(target, "../", 3) == 0 || strlen(target) >= sizeof name)
        return false;
    if (slash == NULL)
        return true; /* a neighbour in the same folder */
    bool is_public = strncmp(target, "hewn/", 5) == 0;
    size_t length = is_public ? strcspn(target, ".") : (size_t)(slash - target);
    snprintf(name, sizeof name, "%.*s", (int)length, target);
    if (!is_public)
        return strcmp(name, "shared") == 0 || may_use_room(owner, name);
    const char *speaks_for = room_of_header(target);
    return has_word(owner->may_include, name, length) || has_word(owner->may_include, "hewn", 4) ||
           (speaks_for != NULL && (strcmp(speaks_for, "open") == 0 || may_use_room(owner, speaks_for)));
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
static int count_wrong_includes(const room *owner, const char *path, const char *text)
{
    int wrong = 0, line = 1;
    for (const char *at = text; at != NULL && *at != '\0'; line++) {
        char target[256];
        if (read_include(at, target) && !allowed(owner, target)) {
            print_message("# %s:%d includes %s\n", path, line, target);
            wrong++;
        }
        at = strchr(at, '\n');
        at = at != NULL ? at + 1 : NULL;
    }
    return wrong;
}

/* How many lines of a public header include something that is not installed with it. */
static int count_private_includes(const char *path, const char *text)
{
    int wrong = 0;
    for (const char *at = text; at != NULL && *at != '\0';) {
        char target[256];
        if (read_include(at, target) && strncmp(target, "hewn/", 5) != 0) {
            print_message("# %s includes %s\n", path, target);
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
            sum->wrong += count_wrong_includes(owner, path, text);
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

/* A public header stands where its room does, and includes only public headers. */
static void test_public_headers_keep_their_order(void **state)
{
    (void)state;
    static const room lowest = {"open", ""}, outside = {"app", "hewn"};
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/include/hewn", source_root());
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    int wrong = 0;
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char path[4096 + 300];
        if (!ends_with(entry->d_name, ".h"))
            continue;
        const char *name = room_of_header(entry->d_name);
        if (name == NULL) {
            print_error("include/hewn/%s is not in the table of headers\n", entry->d_name);
            wrong++;
            continue;
        }
        const room *owner = strcmp(name, "open") == 0   ? &lowest
                            : strcmp(name, "hewn") == 0 ? &outside
                                                        : find_room(name);
        assert_non_null(owner);
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        char *text = read_text(path);
        wrong += count_wrong_includes(owner, path, text) + count_private_includes(path, text);
        free(text);
    }
    closedir(directory);
    assert_int_equal(wrong, 0);
}

/* The checker itself: what it must let through and what it must catch. */
static void test_checker_catches_upward_includes(void **state)
{
    (void)state;
    static const room open = {"open", ""};
    const struct {
        const room *owner;
        int wrong;
        const char *text;
    } cases[] = {
        {find_room("field"), 0, "#include <stdio.h>\n#include \"base/alloc.h\"\n#include \"graph.h\"\n"},
        {find_room("field"), 0, "#include \"field/graph.h\"\n#include \"hewn/field.h\"\n#include \"hewn/triangles.h\""},
        {find_room("field"), 2, "#include \"iso/cube.h\"\n\n  #  include \"gpu/gpu.h\"\n"},
        {find_room("field"), 2, "#include \"hewn/extract.h\"\n#include \"hewn/hewn.h\"\n"},
        {find_room("field"), 2, "#include \"../base/alloc.h\"\n#include \"nowhere/x.h\"\n"},
        {find_room("iso"), 0, "#include \"eval/code.h\"\n#include \"shared/iso.h\"\n#include \"hewn/device.h\""},
        {find_room("iso"), 2, "\n#include \"mesh/star.h\"\n#include \"hewn/mesh.h\""},
        {find_room("io"), 0, "#include \"hewn/units.h\"\n#include \"hewn/mesh.h\""},
        {find_room("io"), 1, "#include \"scene/scene.h\""},
        {find_room("app"), 0, "#include \"hewn/hewn.h\"\n#include \"pipeline/report.h\""},
        {find_room("app"), 1, "#include \"iso/cube.h\""},
        {&open, 1, "#include \"hewn/base.h\"\n#include \"hewn/device.h\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_int_equal(count_wrong_includes(cases[i].owner, "made up", cases[i].text), cases[i].wrong);
    assert_int_equal(count_private_includes("made up", "#include \"hewn/base.h\"\n#include \"base/text.h\""), 1);
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
