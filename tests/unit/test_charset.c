/* Sets of characters: what names, texts and descriptions mean, and what is wrong with them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "atlas/charset.h"
#include "base/alloc.h"

static void assert_set(hewn_charset *set, const uint32_t *wanted, size_t count)
{
    uint32_t *items;
    assert_int_equal(set->count, count);
    assert_int_equal(hewn_charset_list(set, &items, NULL), HEWN_OK);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(items[i], wanted[i]);
    hewn_free(items);
    hewn_charset_clear(set);
}

static void names(void **state)
{
    (void)state;
    hewn_charset set = {0};
    bool known;
    assert_int_equal(hewn_charset_add_named(&set, "ascii", NULL, &known, NULL), HEWN_OK);
    assert_true(known);
    uint32_t wanted[95 + 96];
    for (uint32_t i = 0; i < 95 + 96; i++)
        wanted[i] = i < 95 ? 0x20 + i : 0xA0 + i - 95;
    assert_set(&set, wanted, 95);
    assert_int_equal(hewn_charset_add_named(&set, "latin1", NULL, &known, NULL), HEWN_OK);
    assert_true(known);
    assert_set(&set, wanted, 95 + 96);
    assert_int_equal(hewn_charset_add_named(&set, "letters.txt", NULL, &known, NULL), HEWN_OK);
    assert_true(!known && set.count == 0);
    hewn_charset_clear(&set);
}

static void texts(void **state)
{
    (void)state;
    hewn_charset set = {0};
    hewn_error error = {0};
    assert_int_equal(hewn_charset_add_text(&set,
                                           "\xEF\xBB\xBF"
                                           "a\xC3\xA9\n\t\xE2\x82\xAC\xF0\x9F\x98\x80",
                                           NULL),
                     HEWN_OK);
    assert_set(&set, (const uint32_t[]){'a', 0xE9, 0x20AC, 0x1F600}, 4);
    assert_int_equal(hewn_charset_add_text(&set, "ab\xC3(", &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "byte 3"));
    hewn_charset_clear(&set);
}

static void descriptions(void **state)
{
    (void)state;
    hewn_charset set = {0};
    assert_int_equal(
        hewn_charset_add_description(&set, " 65, 0x42 'C'\n\"D\\\"\xC3\xA9\\\\\"\r\n[97, 'c'],['x' 0x79]", NULL),
        HEWN_OK);
    assert_set(&set, (const uint32_t[]){'"', 65, 66, 67, 'D', '\\', 'a', 'b', 'c', 'x', 'y', 0xE9}, 12);
    assert_int_equal(hewn_charset_add_description(&set, "'\\'' [0x10FFFF,0x10FFFF]", NULL), HEWN_OK);
    assert_set(&set, (const uint32_t[]){'\'', 0x10FFFF}, 2);
    assert_int_equal(hewn_charset_add_description(&set, "", NULL), HEWN_OK);
    assert_int_equal(set.count, 0);
}

static void bad_descriptions(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t line;
        const char *part;
    } cases[] = {{"abc", 1, "number"},       {"65\n66\nx", 3, "number"},    {"0x", 1, "digits"},
                 {"0x110000", 1, "at most"}, {"99999999999", 1, "at most"}, {"'ab'", 1, "one character"},
                 {"''", 1, "one character"}, {"'a", 1, "does not end"},     {"\"ab\n\"", 1, "does not end"},
                 {"\n[1", 2, "number"},      {"[1,2", 1, "[FIRST, LAST]"},  {"[2,1]", 1, "lower"},
                 {"\"a\\b\"", 1, "quote"},   {"'\xFF'", 1, "UTF-8"},        {"[1 2 3]", 1, "[FIRST, LAST]"},
                 {"-5", 1, "number"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hewn_charset set = {0};
        hewn_error error = {0};
        hewn_result result = hewn_charset_add_description(&set, cases[i].text, &error);
        if (result != HEWN_BAD_INPUT || error.line != cases[i].line || !strstr(error.message, cases[i].part))
            fail_msg("'%s': %s, line %u: %s", cases[i].text, hewn_result_name(result), error.line, error.message);
        hewn_charset_clear(&set);
    }
}

/* Whatever is added again takes nothing: text of many megabytes and all characters many times are sets like others. */
static void repeats(void **state)
{
    (void)state;
    enum { LENGTH = 9 << 20 };
    hewn_charset set = {0};
    char *text = malloc(LENGTH + 1);
    assert_non_null(text);
    for (size_t i = 0; i < LENGTH; i++)
        text[i] = "abca"[i % 4];
    text[LENGTH] = '\0';
    assert_int_equal(hewn_charset_add_text(&set, text, NULL), HEWN_OK);
    free(text);
    assert_set(&set, (const uint32_t[]){'a', 'b', 'c'}, 3);
    for (int i = 0; i < 8; i++)
        assert_int_equal(hewn_charset_add_description(&set, "[0,0x10FFFF]", NULL), HEWN_OK);
    assert_int_equal(set.count, 0x110000);
    hewn_charset_clear(&set);
    assert_set(&set, NULL, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names),        cmocka_unit_test(texts),
        cmocka_unit_test(descriptions), cmocka_unit_test(bad_descriptions),
        cmocka_unit_test(repeats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
