/* JSON and files. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "base/file.h"
#include "base/json.h"
#include "base/srgb.h"
#include "base/utf8.h"
#include "test_mesh_support.h"

/* --- JSON
 * -------------------------------------------------------------------------------------------------------------- */

static void test_json_document(void **state)
{
    (void)state;
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "name", "a\"b\\c\n\t\x01\x7f");
    hewn_json_string(&json, "none", NULL);
    hewn_json_bool(&json, "yes", true);
    hewn_json_array(&json, "list");
    hewn_json_integer(&json, NULL, INT64_MIN);
    hewn_json_unsigned(&json, NULL, UINT64_MAX);
    hewn_json_number(&json, NULL, 0.1);
    hewn_json_end_array(&json);
    hewn_json_array(&json, "empty");
    hewn_json_end_array(&json);
    hewn_json_array(&json, "objects");
    for (int i = 0; i < 2; i++) {
        hewn_json_object(&json, NULL);
        if (i == 1)
            hewn_json_number(&json, "x", NAN);
        hewn_json_end_object(&json);
    }
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    assert_int_equal(hewn_text_status(&text, NULL), HEWN_OK);
    assert_string_equal(text.bytes, "{\n"
                                    "  \"name\": \"a\\\"b\\\\c\\n\\t\\u0001\\u007f\",\n"
                                    "  \"none\": null,\n"
                                    "  \"yes\": true,\n"
                                    "  \"list\": [-9223372036854775808, 18446744073709551615, 0.1],\n"
                                    "  \"empty\": [],\n"
                                    "  \"objects\": [\n"
                                    "    {},\n"
                                    "    {\n"
                                    "      \"x\": null\n"
                                    "    }\n"
                                    "  ]\n"
                                    "}\n");
    hewn_text_clear(&text);
}

static void assert_quoted(const char *given, const char *expected)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_string(&json, NULL, given);
    assert_string_equal(text.bytes, expected);
    hewn_text_clear(&text);
}

static void test_json_repairs_utf8(void **state)
{
    (void)state;
    assert_quoted("\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80", "\"\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\"");
    assert_quoted("a\x80z", "\"a\xef\xbf\xbdz\"");
    assert_quoted("\xc3", "\"\xef\xbf\xbd\"");
    assert_quoted("\xc0\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\"");
    assert_quoted("\xed\xa0\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\"");
    assert_quoted("\xf4\x90\x80\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\"");
    assert_quoted("\xf0\x9f\x98", "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\"");
}

static void print_number(double value, char *to, size_t room)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_number(&json, NULL, value);
    snprintf(to, room, "%s", text.bytes);
    hewn_text_clear(&text);
}

static void test_json_numbers_read_back(void **state)
{
    (void)state;
    char digits[64];
    print_number(-0.0, digits, sizeof digits);
    assert_string_equal(digits, "-0");
    print_number(INFINITY, digits, sizeof digits);
    assert_string_equal(digits, "null");
    print_number(1e300, digits, sizeof digits);
    assert_string_equal(digits, "1e+300");
    random_state random = {5};
    for (int i = 0; i < 20000; i++) {
        uint64_t bits = random_bits(&random);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        print_number(value, digits, sizeof digits);
        double again = strtod(digits, NULL);
        assert_memory_equal(&again, &value, sizeof value);
        assert_true(strlen(digits) <= 24);
    }
}

static void test_json_ignores_the_locale(void **state)
{
    (void)state;
    const char *name = setlocale(LC_NUMERIC, "de_DE.UTF-8");
    char digits[64], comma[16];
    print_number(1.5, digits, sizeof digits);
    snprintf(comma, sizeof comma, "%.1f", 1.5);
    setlocale(LC_NUMERIC, "C");
    assert_string_equal(digits, "1.5");
    if (!name || strcmp(comma, "1,5") != 0)
        skip(); /* that locale is not installed, so nothing was put to the test */
}

/* --- files
 * ------------------------------------------------------------------------------------------------------------- */

static char folder[64];

static int enter_folder(void **state)
{
    (void)state;
    make_folder(folder);
    return chdir(folder);
}

static int leave_folder(void **state)
{
    (void)state;
    DIR *open = opendir(".");
    for (struct dirent *entry; open && (entry = readdir(open));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 && unlink(entry->d_name) != 0)
            rmdir(entry->d_name);
    if (open)
        closedir(open);
    return chdir("/") != 0 || rmdir(folder) != 0;
}

static size_t count_entries(void)
{
    size_t count = 0;
    DIR *open = opendir(".");
    assert_non_null(open);
    for (struct dirent *entry; (entry = readdir(open));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(open);
    return count;
}

static void put_file(const char *path, const char *bytes)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(bytes, file);
    assert_int_equal(fclose(file), 0);
}

static void assert_content(const char *path, const char *bytes, size_t size)
{
    char *read;
    size_t length;
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &read, &length, NULL), HEWN_OK);
    assert_int_equal(length, size);
    assert_memory_equal(read, bytes, size);
    assert_int_equal(read[length], 0);
    hewn_free(read);
}

static void test_output_appears_when_finished(void **state)
{
    (void)state;
    hewn_output *output;
    put_file("old", "old content");
    assert_int_equal(hewn_output_create("old", &output, NULL), HEWN_OK);
    assert_int_equal(hewn_output_write(output, "new", 3, NULL), HEWN_OK);
    assert_content("old", "old content", 11);
    assert_int_equal(hewn_output_finish(&output, NULL), HEWN_OK);
    assert_null(output);
    assert_content("old", "new", 3);
    assert_int_equal(count_entries(), 1);
}

static void test_output_given_up_leaves_nothing(void **state)
{
    (void)state;
    hewn_output *output;
    assert_int_equal(hewn_output_create("gone", &output, NULL), HEWN_OK);
    assert_int_equal(hewn_output_write(output, "new", 3, NULL), HEWN_OK);
    hewn_output_destroy(&output);
    hewn_output_destroy(&output);
    assert_int_equal(count_entries(), 0);
}

static void test_output_of_any_pieces(void **state)
{
    (void)state;
    random_state random = {11};
    size_t total = 5u << 20, put = 0;
    char *bytes = hewn_alloc(total, 1);
    assert_non_null(bytes);
    for (size_t i = 0; i < total; i++)
        bytes[i] = (char)random_bits(&random);
    hewn_output *output;
    assert_int_equal(hewn_output_create("pieces", &output, NULL), HEWN_OK);
    while (put < total) {
        size_t piece = random_below(&random, random_below(&random, 3) ? 3000 : 3 << 20);
        piece = piece < total - put ? piece : total - put;
        assert_int_equal(hewn_output_write(output, bytes + put, piece, NULL), HEWN_OK);
        put += piece;
    }
    assert_int_equal(hewn_output_finish(&output, NULL), HEWN_OK);
    assert_content("pieces", bytes, total);
    hewn_free(bytes);
}

static void test_output_mode(void **state)
{
    (void)state;
    hewn_output *output;
    struct stat status;
    mode_t usual = umask(027);
    assert_int_equal(hewn_output_create("fresh", &output, NULL), HEWN_OK);
    assert_int_equal(hewn_output_finish(&output, NULL), HEWN_OK);
    assert_int_equal(stat("fresh", &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    assert_int_equal(chmod("fresh", 0604), 0);
    assert_int_equal(hewn_output_create("fresh", &output, NULL), HEWN_OK);
    assert_int_equal(hewn_output_finish(&output, NULL), HEWN_OK);
    assert_int_equal(stat("fresh", &status), 0);
    assert_int_equal(status.st_mode & 0777, 0604);
    umask(usual);
}

static void test_output_through_a_link(void **state)
{
    (void)state;
    hewn_output *output;
    struct stat status;
    put_file("real", "1");
    assert_int_equal(symlink("real", "link"), 0);
    assert_int_equal(hewn_output_create("link", &output, NULL), HEWN_OK);
    assert_int_equal(hewn_output_write(output, "22", 2, NULL), HEWN_OK);
    assert_int_equal(hewn_output_finish(&output, NULL), HEWN_OK);
    assert_int_equal(lstat("link", &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_content("real", "22", 2);
}

static void assert_refused(const char *path, const char *reason)
{
    hewn_output *output = (hewn_output *)folder;
    hewn_error error = {0};
    assert_int_equal(hewn_output_create(path, &output, &error), HEWN_IO);
    assert_null(output);
    if (!strstr(error.message, reason))
        fail_msg("\"%s\" does not say \"%s\"", error.message, reason);
    if (*path)
        assert_string_equal(error.file, path);
    assert_int_equal(hewn_output_create(path, &output, NULL), HEWN_IO);
}

static void test_output_refused_early(void **state)
{
    (void)state;
    assert_int_equal(mkdir("folder", 0777), 0);
    put_file("plain", "");
    assert_refused("folder", "folder");
    assert_refused("missing/file", strerror(ENOENT));
    assert_refused("plain/file", strerror(ENOTDIR));
    assert_refused("newfolder/", "folder");
    assert_refused("", "empty name");
    assert_int_equal(count_entries(), 2);
}

/* Root may write anywhere, so a child becomes somebody else. */
static void test_output_without_permission(void **state)
{
    (void)state;
    put_file("locked", "x");
    assert_int_equal(chmod("locked", 0444), 0);
    assert_int_equal(chmod(".", 0555), 0);
    pid_t child = fork();
    if (child == 0) {
        if (getuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0))
            _exit(77);
        hewn_output *output;
        hewn_error error = {0};
        bool refused =
            hewn_output_create("locked", &output, &error) == HEWN_IO && strstr(error.message, strerror(EACCES)) &&
            hewn_output_create("fresh", &output, &error) == HEWN_IO && strstr(error.message, strerror(EACCES));
        _exit(refused ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(chmod(".", 0755), 0);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77)
        skip();
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void test_output_past_the_size_limit(void **state)
{
    (void)state;
    struct rlimit usual, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &usual), 0);
    small = usual;
    small.rlim_cur = 1 << 16;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    char *bytes = hewn_alloc_zero(1 << 18, 1);
    hewn_output *output;
    hewn_error error = {0}, again = {0};
    put_file("kept", "as it was");
    assert_int_equal(hewn_output_create("kept", &output, NULL), HEWN_OK);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    hewn_result result = HEWN_OK;
    for (int i = 0; i < 100 && result == HEWN_OK; i++)
        result = hewn_output_write(output, bytes, 1 << 18, &error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &usual), 0);
    assert_int_equal(result, HEWN_IO);
    assert_string_equal(error.file, "kept");
    assert_non_null(strstr(error.message, strerror(EFBIG)));
    assert_int_equal(hewn_output_write(output, "x", 1, &again), HEWN_IO); /* for good */
    assert_string_equal(again.message, error.message);
    assert_int_equal(hewn_output_finish(&output, &again), HEWN_IO);
    assert_content("kept", "as it was", 9);
    assert_int_equal(count_entries(), 1);
    signal(SIGXFSZ, handler);
    hewn_free(bytes);
}

static void test_output_to_devices(void **state)
{
    (void)state;
    struct stat status;
    if (stat("/dev/full", &status) != 0 || !S_ISCHR(status.st_mode))
        skip();
    hewn_output *output;
    hewn_error error = {0};
    assert_int_equal(hewn_output_create("/dev/full", &output, NULL), HEWN_OK);
    assert_int_equal(hewn_output_write(output, "x", 1, NULL), HEWN_OK);
    assert_int_equal(hewn_output_finish(&output, &error), HEWN_IO);
    assert_string_equal(error.file, "/dev/full");
    assert_non_null(strstr(error.message, strerror(ENOSPC)));
    assert_int_equal(stat("/dev/full", &status), 0);
    assert_true(S_ISCHR(status.st_mode));
}

/* In a child with its own standard output: a file, then one that is always full. */
static void test_output_to_standard_output(void **state)
{
    (void)state;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        int file = open("out", O_WRONLY | O_CREAT, 0666);
        dup2(file, STDOUT_FILENO);
        printf("before "); /* must come first */
        hewn_output *output;
        hewn_error error = {0};
        bool good = hewn_output_create("-", &output, NULL) == HEWN_OK &&
                    hewn_output_write(output, "bytes", 5, NULL) == HEWN_OK &&
                    hewn_output_finish(&output, NULL) == HEWN_OK;
        dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO);
        good = good && hewn_output_create("-", &output, NULL) == HEWN_OK &&
               hewn_output_write(output, "bytes", 5, NULL) == HEWN_OK &&
               hewn_output_finish(&output, &error) == HEWN_IO && strstr(error.message, strerror(ENOSPC)) &&
               strcmp(error.file, "standard output") == 0;
        _exit(good ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_content("out", "before bytes", 12);
}

static void test_read_failures(void **state)
{
    (void)state;
    char *bytes = folder;
    size_t length = 7;
    hewn_error error = {0};
    assert_int_equal(hewn_file_read("absent", 100, &bytes, &length, &error), HEWN_IO);
    assert_null(bytes);
    assert_int_equal(length, 0);
    assert_string_equal(error.file, "absent");
    assert_non_null(strstr(error.message, strerror(ENOENT)));
    assert_int_equal(hewn_file_read(".", 100, &bytes, &length, &error), HEWN_BAD_INPUT);
    put_file("eleven", "eleven byte");
    assert_int_equal(hewn_file_read("eleven", 10, &bytes, &length, &error), HEWN_BAD_INPUT);
    assert_null(bytes);
    assert_int_equal(hewn_file_read("eleven", 11, &bytes, &length, &error), HEWN_OK);
    assert_string_equal(bytes, "eleven byte");
    hewn_free(bytes);
}

static void test_read_pipe(void **state)
{
    (void)state;
    size_t total = 300000;
    assert_int_equal(mkfifo("pipe", 0666), 0);
    pid_t child = fork();
    if (child == 0) {
        FILE *file = fopen("pipe", "wb");
        for (size_t i = 0; file && i < total; i++)
            putc((int)(i % 251), file);
        _exit(!file || fclose(file) != 0);
    }
    char *bytes;
    size_t length;
    assert_int_equal(hewn_file_read("pipe", total, &bytes, &length, NULL), HEWN_OK);
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_int_equal(length, total);
    for (size_t i = 0; i < total; i++)
        assert_int_equal((unsigned char)bytes[i], i % 251);
    hewn_free(bytes);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_folder, leave_folder)

/* Of three bytes all that there are, of four those that begin and end the ranges: UTF-8 is what writing a code point
 * gives, and nothing else. */
static size_t write_utf8(uint32_t value, unsigned char out[4])
{
    if (value < 0x80) {
        out[0] = (unsigned char)value;
        return 1;
    }
    size_t length = value < 0x800 ? 2 : value < 0x10000 ? 3 : 4;
    for (size_t i = length; i-- > 1; value >>= 6)
        out[i] = (unsigned char)(0x80 | (value & 0x3F));
    out[0] = (unsigned char)((0xF00u >> length & 0xFFu) | value);
    return length;
}

static void test_utf8(void **state)
{
    (void)state;
    size_t found[5] = {0};
    uint32_t value;
    for (uint32_t bytes = 0; bytes < 1u << 24; bytes++) {
        const unsigned char text[4] = {bytes >> 16 & 0xFF, bytes >> 8 & 0xFF, bytes & 0xFF, 0};
        unsigned char back[4];
        size_t length = hewn_utf8_next((const char *)text, 3, &value);
        if (length == 0)
            continue;
        if (length > 3 || write_utf8(value, back) != length || memcmp(text, back, length) != 0)
            fail_msg("%02x %02x %02x: U+%04X of %zu bytes", text[0], text[1], text[2], value, length);
        found[length] += length == 3 || (text[2] == 0 && (length == 2 || text[1] == 0));
    }
    assert_true(found[1] == 0x80 && found[2] == 0x800 - 0x80 && found[3] == 0x10000 - 0x800 - 0x800);
    for (uint32_t code = 0; code < 0x110000; code++) {
        unsigned char text[4];
        size_t length = write_utf8(code, text), expected = code >= 0xD800 && code < 0xE000 ? 0 : length;
        if (hewn_utf8_next((const char *)text, 4, &value) != expected || (expected > 0 && value != code))
            fail_msg("U+%04X", code);
        for (size_t left = 0; left < length; left++)
            assert_int_equal(hewn_utf8_next((const char *)text, left, &value), 0);
    }
    static const char *const bad[] = {"\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xF0\x90\x80",
                                      "\xF0\x90\x80z"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(hewn_utf8_next(bad[i], SIZE_MAX, &value), 0);
}

/* The two are inverse, rise, and agree where the line meets the curve. */
static void test_srgb(void **state)
{
    (void)state;
    double before = -1;
    for (int i = 0; i <= 10000; i++) {
        double share = i / 10000.0, linear = hewn_srgb_to_linear(share);
        assert_true(linear > before && fabs(hewn_srgb_from_linear(linear) - share) < 1e-6);
        before = linear;
    }
    assert_true(hewn_srgb_to_linear(0) == 0 && hewn_srgb_to_linear(1) == 1);
    assert_true(fabs(hewn_srgb_to_linear(0.5) - 0.214041) < 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_json_document),
        cmocka_unit_test(test_json_repairs_utf8),
        cmocka_unit_test(test_json_numbers_read_back),
        cmocka_unit_test(test_utf8),
        cmocka_unit_test(test_srgb),
        cmocka_unit_test(test_json_ignores_the_locale),
        IN_FOLDER(test_output_appears_when_finished),
        IN_FOLDER(test_output_given_up_leaves_nothing),
        IN_FOLDER(test_output_of_any_pieces),
        IN_FOLDER(test_output_mode),
        IN_FOLDER(test_output_through_a_link),
        IN_FOLDER(test_output_refused_early),
        IN_FOLDER(test_output_without_permission),
        IN_FOLDER(test_output_past_the_size_limit),
        IN_FOLDER(test_output_to_devices),
        IN_FOLDER(test_output_to_standard_output),
        IN_FOLDER(test_read_failures),
        IN_FOLDER(test_read_pipe),
    };
    return cmocka_run_group_tests_name("base", tests, NULL, NULL);
}
