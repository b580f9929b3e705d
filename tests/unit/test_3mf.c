/* Writing 3MF: archive, XML and numbers are what the specification wants, and other readers agree. */
#include <libxml/parser.h>
#include <libxml/tree.h>
#include <math.h>
#include <zlib.h>

#include "io_support.h"
#include "lib3mf_read.h"

static char folder[64], path[96];

static int enter_folder(void **state)
{
    (void)state;
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.3mf", folder);
    return 0;
}

static int leave_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder); /* fails where anything else was left behind */
}

/* --- a reader of archives, by the directory at their end ---------------------------------------------------------- */

static uint32_t number_at(const char *bytes, size_t size)
{
    uint32_t number = 0;
    for (size_t i = size; i-- > 0;)
        number = number << 8 | (unsigned char)bytes[i];
    return number;
}

/* Unpacks part `index`, which must have this name and be the last one or not; checks lengths, CRC, local header and
 * descriptor. With a NUL after it, to be freed. */
static char *unpack_part(const char *bytes, size_t length, uint32_t index, const char *name, size_t *part_length)
{
    const char *end = bytes + length - 22, *entry = bytes + number_at(end + 16, 4);
    assert_int_equal(number_at(end, 4), 0x06054b50);
    assert_int_equal(number_at(end + 10, 2), 3);
    for (uint32_t i = 0; i < index; i++)
        entry += 46 + number_at(entry + 28, 2) + number_at(entry + 30, 2) + number_at(entry + 32, 2);
    assert_int_equal(number_at(entry, 4), 0x02014b50);
    uint32_t crc = number_at(entry + 16, 4), packed = number_at(entry + 20, 4), unpacked = number_at(entry + 24, 4);
    assert_int_equal(number_at(entry + 12, 4), 0x00210000); /* the first of January 1980 */
    assert_int_equal(number_at(entry + 28, 2), strlen(name));
    assert_memory_equal(entry + 46, name, strlen(name));
    const char *local = bytes + number_at(entry + 42, 4);
    assert_int_equal(number_at(local, 4), 0x04034b50);
    assert_memory_equal(local + 30, name, strlen(name));
    const char *data = local + 30 + number_at(local + 26, 2) + number_at(local + 28, 2);
    assert_int_equal(number_at(data + packed, 4), 0x08074b50);
    assert_int_equal(number_at(data + packed + 4, 4), crc);
    assert_int_equal(number_at(data + packed + 8, 4), packed);
    assert_int_equal(number_at(data + packed + 12, 4), unpacked);
    char *part = hewn_alloc((size_t)unpacked + 1, 1);
    assert_non_null(part);
    z_stream stream = {.next_in = (Bytef *)(uintptr_t)data, .avail_in = packed};
    stream.next_out = (Bytef *)part;
    stream.avail_out = unpacked + 1;
    assert_int_equal(inflateInit2(&stream, -MAX_WBITS), Z_OK);
    assert_int_equal(inflate(&stream, Z_FINISH), Z_STREAM_END);
    assert_int_equal(stream.total_out, unpacked);
    assert_int_equal(inflateEnd(&stream), Z_OK);
    assert_int_equal(crc32(0, (const Bytef *)part, unpacked), crc);
    part[unpacked] = '\0';
    *part_length = unpacked;
    return part;
}

/* --- a reader of the model ---------------------------------------------------------------------------------------- */

static xmlNodePtr child(xmlNodePtr node, const char *name)
{
    for (xmlNodePtr at = node ? node->children : NULL; at; at = at->next)
        if (at->type == XML_ELEMENT_NODE && strcmp((const char *)at->name, name) == 0)
            return at;
    return NULL;
}

static void get_text(xmlNodePtr node, const char *name, char out[256])
{
    xmlChar *value = node ? xmlGetProp(node, (const xmlChar *)name) : NULL;
    if (!value)
        fail_msg("no attribute \"%s\"", name);
    snprintf(out, 256, "%s", value ? (const char *)value : "");
    xmlFree(value);
}

static double get_number(xmlNodePtr node, const char *name)
{
    char text[256], *end = NULL;
    get_text(node, name, text);
    double number = strtod(text, &end);
    assert_true(*text != '\0' && end && *end == '\0');
    return number;
}

static size_t count_children(xmlNodePtr node)
{
    size_t count = 0;
    for (xmlNodePtr at = node ? node->children : NULL; at; at = at->next)
        count += at->type == XML_ELEMENT_NODE;
    return count;
}

/* The archive at `path`, as XML. */
static xmlDocPtr open_model(void)
{
    char *bytes = NULL;
    size_t length = 0, part_length;
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    char *types = unpack_part(bytes, length, 0, "[Content_Types].xml", &part_length);
    assert_non_null(strstr(types, "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"));
    char *relations = unpack_part(bytes, length, 1, "_rels/.rels", &part_length);
    assert_non_null(strstr(relations, "Target=\"/3D/3dmodel.model\""));
    char *text = unpack_part(bytes, length, 2, "3D/3dmodel.model", &part_length);
    xmlDocPtr document = xmlReadMemory(text, (int)part_length, "model", NULL, XML_PARSE_HUGE);
    assert_non_null(document);
    assert_string_equal(xmlDocGetRootElement(document)->ns->href,
                        "http://schemas.microsoft.com/3dmanufacturing/core/2015/02");
    hewn_free(types);
    hewn_free(relations);
    hewn_free(text);
    hewn_free(bytes);
    return document;
}

static xmlNodePtr find_object(xmlDocPtr document)
{
    return child(child(xmlDocGetRootElement(document), "resources"), "object");
}

static void get_metadata(xmlDocPtr document, const char *name, char out[256])
{
    for (xmlNodePtr at = xmlDocGetRootElement(document)->children; at; at = at->next) {
        char found[256];
        if (at->type != XML_ELEMENT_NODE || strcmp((const char *)at->name, "metadata") != 0)
            continue;
        get_text(at, "name", found);
        if (strcmp(found, name) == 0) {
            xmlChar *content = xmlNodeGetContent(at);
            snprintf(out, 256, "%s", (const char *)content);
            xmlFree(content);
            return;
        }
    }
    fail_msg("no metadata \"%s\"", name);
}

/* --- tests -------------------------------------------------------------------------------------------------------- */

/* Where a vertex must be: +Y is turned to +Z, and unknown axes stay as they are. */
static void expect_place(const hewn_model *model, uint64_t v, double out[3])
{
    const double *p = model->positions + 3 * v;
    out[0] = p[0];
    out[1] = model->up_known ? -p[2] : p[1];
    out[2] = model->up_known ? p[1] : p[2];
}

/* Positions up to the last bit, and all triangles but those that name a vertex twice. */
static void assert_holds(const hewn_model *model, bool float_text)
{
    xmlDocPtr document = open_model();
    xmlNodePtr mesh = child(find_object(document), "mesh");
    uint64_t v = 0, t = 0;
    for (xmlNodePtr at = child(child(mesh, "vertices"), "vertex"); at; at = at->next) {
        if (at->type != XML_ELEMENT_NODE)
            continue;
        double expected[3];
        expect_place(model, v++, expected);
        const double found[] = {get_number(at, "x"), get_number(at, "y"), get_number(at, "z")};
        for (int axis = 0; axis < 3; axis++)
            assert_true(float_text ? (float)found[axis] == (float)expected[axis] : found[axis] == expected[axis]);
    }
    assert_int_equal(v, model->vertex_count);
    for (xmlNodePtr at = child(child(mesh, "triangles"), "triangle"); at; at = at->next) {
        if (at->type != XML_ELEMENT_NODE)
            continue;
        const uint32_t *c = model->corners + 3 * t++;
        for (; c[0] == c[1] || c[1] == c[2] || c[2] == c[0]; c += 3)
            t++;
        assert_true(get_number(at, "v1") == c[0] && get_number(at, "v2") == c[1] && get_number(at, "v3") == c[2]);
    }
    for (const uint32_t *c = model->corners + 3 * t; t < model->face_count; t++, c += 3)
        assert_true(c[0] == c[1] || c[1] == c[2] || c[2] == c[0]);
    xmlFreeDoc(document);
}

static void test_random_models(void **state)
{
    (void)state;
    random_state random = {5};
    int rounds = getenv("HEWN_LONG") ? 1000 : 60;
    for (int round = 0; round < rounds; round++) {
        uint32_t vertices = 1 + random_below(&random, 700), faces = 1 + random_below(&random, 700);
        hewn_model model = make_model(vertices, faces, 3ull * faces, false);
        bool floats = random_below(&random, 2);
        model.up_known = random_below(&random, 2);
        for (uint32_t i = 0; i < 3 * vertices; i++) {
            double value = (double)random_float(&random);
            model.positions[i] = floats ? value : value * (1 + random_unit(&random));
        }
        for (uint32_t c = 0; c < 3 * faces; c++)
            model.corners[c] = random_below(&random, vertices);
        write_model(&model, path, NULL);
        assert_holds(&model, floats);
        hewn_model_destroy(&model);
    }
}

static void test_units(void **state)
{
    (void)state;
    static const struct {
        const char *unit, *in_3mf;
        double scale;
    } cases[] = {{"m", "meter", 1},     {"cm", "centimeter", 1}, {"mm", "millimeter", 1}, {"um", "micron", 1},
                 {"km", "meter", 1000}, {"in", "inch", 1},       {"ft", "foot", 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_model model = make_ring_model(4, 4, 0);
        model.unit = hewn_unit_find(cases[i].unit);
        model.up = HEWN_AXIS_PLUS_Z;
        model.up_known = true;
        write_model(&model, path, NULL);
        xmlDocPtr document = open_model();
        char text[256];
        get_text(xmlDocGetRootElement(document), "unit", text);
        assert_string_equal(text, cases[i].in_3mf);
        xmlNodePtr mesh = child(find_object(document), "mesh");
        assert_true(get_number(child(child(mesh, "vertices"), "vertex"), "x") == 1.3 * cases[i].scale);
        assert_int_equal(count_children(child(mesh, "vertices")), 16);
        assert_int_equal(count_children(child(mesh, "triangles")), 32);
        if (cases[i].scale != 1) {
            get_metadata(document, "Description", text);
            assert_non_null(strstr(text, "\"scale\":[1000,1]"));
        }
        xmlFreeDoc(document);
        hewn_model_destroy(&model);
    }
}

static void test_names(void **state)
{
    (void)state;
    static const struct {
        const char *given, *written;
    } cases[] = {
        {"<a> & \"b\" 'c' ]]>", "<a> & \"b\" 'c' ]]>"},
        {"g\xc3\xbcn \xf0\x9f\xa7\x8a", "g\xc3\xbcn \xf0\x9f\xa7\x8a"},
        {"\xff \xc3 \xef\xbf\xbf \xed\xa0\x80.", "\xef\xbf\xbd \xef\xbf\xbd \xef\xbf\xbd "},
        {"a\tb\x7f", "a b "},
        {NULL, "a"},
    };
    hewn_model model = make_ring_model(3, 3, 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_model(&model, path, &(hewn_write_desc){.name = cases[i].given});
        xmlDocPtr document = open_model();
        char text[256];
        get_text(find_object(document), "name", text);
        assert_memory_equal(text, cases[i].written, strlen(cases[i].written));
        get_metadata(document, "Title", text);
        assert_memory_equal(text, cases[i].written, strlen(cases[i].written));
        get_metadata(document, "Application", text);
        assert_memory_equal(text, "Hewn ", 5);
        xmlFreeDoc(document);
    }
    hewn_model_destroy(&model);
}

static void test_empty_model(void **state)
{
    (void)state;
    hewn_model model = {0};
    write_model(&model, path, NULL);
    xmlDocPtr document = open_model();
    assert_non_null(child(xmlDocGetRootElement(document), "resources"));
    assert_null(find_object(document));
    assert_int_equal(count_children(child(xmlDocGetRootElement(document), "build")), 0);
    xmlFreeDoc(document);
}

static void test_same_bytes(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(50, 50, 3);
    char *first = NULL, *second = NULL;
    size_t first_length = 0, second_length = 0;
    write_model(&model, path, NULL);
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &first, &first_length, NULL), HEWN_OK);
    write_model(&model, path, NULL);
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &second, &second_length, NULL), HEWN_OK);
    assert_int_equal(first_length, second_length);
    assert_memory_equal(first, second, first_length);
    hewn_free(first);
    hewn_free(second);
    hewn_model_destroy(&model);
}

static void test_limits(void **state)
{
    (void)state;
    float position[3] = {0};
    uint32_t index[3] = {0};
    hewn_triangles huge = {.vertex_count = 3, .triangle_count = 0x80000000u, .positions = position, .indices = index};
    assert_int_equal(hewn_triangles_write(&huge, path, NULL, NULL), HEWN_LIMIT);
    hewn_model model = make_ring_model(3, 3, 0);
    model.positions[4] = 1e306;
    model.unit = hewn_unit_find("km");
    assert_int_equal(hewn_model_write(&model, path, NULL, NULL), HEWN_LIMIT);
    assert_int_equal(hewn_model_write(&model, "-", &(hewn_write_desc){.format = HEWN_MESH_3MF}, NULL),
                     HEWN_INVALID_ARGUMENT);
    assert_int_not_equal(access(path, F_OK), 0);
    hewn_model_destroy(&model);
}

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_true(strcmp(stage, "write") == 0 || strcmp(stage, "triangulate") == 0);
    assert_true(fraction >= 0 && fraction <= 1);
    return (*(int *)user)-- > 0;
}

static void test_cancelling_leaves_nothing(void **state)
{
    (void)state;
    hewn_model model = make_ring_model(100, 100, 2);
    for (int allowed = 0;; allowed++) {
        int left = allowed;
        hewn_progress progress = {count_down, &left};
        hewn_result result = hewn_model_write(&model, path, &(hewn_write_desc){.progress = &progress}, NULL);
        if (result == HEWN_OK) {
            assert_true(allowed > 6);
            break;
        }
        assert_int_equal(result, HEWN_CANCELLED);
        assert_int_not_equal(access(path, F_OK), 0);
    }
    hewn_model_destroy(&model);
}

static void test_full_disk(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    hewn_model model = make_ring_model(60, 60, 2);
    hewn_error error = {0};
    assert_int_equal(hewn_model_write(&model, "/dev/full", &(hewn_write_desc){.format = HEWN_MESH_3MF}, &error),
                     HEWN_IO);
    assert_string_equal(error.file, "/dev/full");
    hewn_model_destroy(&model);
}

/* --- other readers ------------------------------------------------------------------------------------------------ */

/* The number after "LABEL:" in what `assimp info` says of the file. */
static long assimp_says(const char *label)
{
    char command[256], line[512];
    snprintf(command, sizeof command, "assimp info %s -r 2>&1", path); /* -r: as the file has it */
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    long number = -1;
    while (fgets(line, sizeof line, pipe))
        if (number < 0 && strncmp(line, label, strlen(label)) == 0)
            number = strtol(line + strlen(label), NULL, 10);
    pclose(pipe);
    return number;
}

static void test_assimp_reads_it(void **state)
{
    (void)state;
    if (system("command -v assimp >/dev/null 2>&1") != 0)
        skip(); /* Debian's assimp-utils is not installed */
    hewn_model model = make_ring_model(40, 30, 3);
    write_model(&model, path, NULL);
    assert_int_equal(assimp_says("Vertices:"), 1200);
    assert_int_equal(assimp_says("Faces:"), 2400);
    assert_int_equal(assimp_says("Meshes:"), 1);
    hewn_model_destroy(&model);
}

/* The Consortium's reader has no warnings, and calls a closed surface one. */
static void test_lib3mf_reads_it(void **state)
{
    (void)state;
    if (!lib3mf_is_there())
        skip(); /* Debian's lib3mf-dev is not installed */
    static const char *const units[] = {"um", "mm", "cm", "in", "ft", "m"};
    for (uint32_t i = 0; i < 6; i++) {
        hewn_model model = make_ring_model(40, 30, 3);
        model.unit = hewn_unit_find(units[i]);
        model.up_known = i % 2;
        write_model(&model, path, NULL);
        lib3mf_facts facts;
        assert_true(lib3mf_read(path, &facts));
        assert_int_equal(facts.objects, 1);
        assert_int_equal(facts.vertices, 1200);
        assert_int_equal(facts.triangles, 2400);
        assert_int_equal(facts.warnings, 0);
        assert_int_equal(facts.unit, i);
        assert_true(facts.manifold);
        double expected[3];
        expect_place(&model, 1199, expected);
        for (int axis = 0; axis < 3; axis++)
            assert_true(fabs((double)facts.corner[axis] - expected[axis]) <= 1e-6);
        lib3mf_forget(&facts);
        hewn_model_destroy(&model);
    }
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_folder, leave_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_random_models),
        IN_FOLDER(test_units),
        IN_FOLDER(test_names),
        IN_FOLDER(test_empty_model),
        IN_FOLDER(test_same_bytes),
        IN_FOLDER(test_limits),
        IN_FOLDER(test_cancelling_leaves_nothing),
        cmocka_unit_test(test_full_disk),
        IN_FOLDER(test_assimp_reads_it),
        IN_FOLDER(test_lib3mf_reads_it),
    };
    return cmocka_run_group_tests_name("3mf", tests, NULL, NULL);
}
