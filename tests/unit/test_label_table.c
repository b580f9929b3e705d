/* Tables of names and colours of labels: each kind that is known, and what is refused at which line. */
#include "hewn/labels.h"
#include "test_model_support.h"

static hewn_label_table parse(const char *text)
{
    hewn_label_table table;
    hewn_error error = {0};
    if (hewn_label_table_parse(text, strlen(text), "t", &table, &error) != HEWN_OK)
        fail_msg("line %u: %s", error.line, error.message);
    return table;
}

/* `color` is 0xRRGGBBAA; 0: it has none. */
static void check_entry(const hewn_label_table *table, int64_t label, const char *name, uint32_t color)
{
    const hewn_label_name *entry = hewn_label_table_find(table, label);
    assert_non_null(entry);
    assert_string_equal(entry->name, name);
    assert_int_equal(entry->has_color, color != 0);
    for (int k = 0; color != 0 && k < 4; k++)
        assert_int_equal(entry->color[k], color >> (24 - 8 * k) & 0xff);
}

static void test_snap(void **state)
{
    (void)state;
    hewn_label_table table =
        parse("################################################\r\n"
              "# ITK-SnAP Label Description File\r\n# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\r\n"
              "    0     0    0    0        0  0  0    \"Clear Label\"\r\n"
              "    1   255    0    0        1  1  1    \"Left # lung, upper\"\r\n"
              "    2     0  255    7        0.5  1  1    \"2\"\r\n");
    assert_int_equal(table.count, 3);
    check_entry(&table, 1, "Left # lung, upper", 0xff0000ff);
    check_entry(&table, 2, "2", 0x00ff0780);
    assert_int_equal(hewn_label_table_find(&table, 0)->color[3], 0);
    assert_null(hewn_label_table_find(&table, 3));
    hewn_label_table_destroy(&table);
    assert_null(table.entries);
}

static void test_freesurfer(void **state)
{
    (void)state;
    hewn_label_table table = parse("#$Id: FreeSurferColorLUT.txt\n\n#No. Label Name:                R   G   B   A\n\n"
                                   "0   Unknown                 0   0   0   0\n"
                                   "1   Left-Cerebral-Exterior  70  130 180 0\n"
                                   "4   Left-Lateral-Ventricle\t120 18  134 0\n"
                                   "14175  wm_rh_S_temporal_transverse  221 60  60  0");
    check_entry(&table, 1, "Left-Cerebral-Exterior", 0x4682b4ff);
    check_entry(&table, 4, "Left-Lateral-Ventricle", 0x781286ff);
    check_entry(&table, 14175, "wm_rh_S_temporal_transverse", 0xdd3c3cff);
    hewn_label_table_destroy(&table);
}

static void test_slicer(void **state)
{
    (void)state;
    hewn_label_table table = parse("# Color table file /x/y.ctbl\n# 3 values\n0 Background 0 0 0 0\n"
                                   "1 tissue 128 174 128 255\n2 bone 241 214 145 100\n");
    check_entry(&table, 1, "tissue", 0x80ae80ff);
    check_entry(&table, 2, "bone", 0xf1d69164);
    assert_int_equal(hewn_label_table_find(&table, 0)->color[3], 0);
    hewn_label_table_destroy(&table);
}

static void test_plain(void **state)
{
    (void)state;
    hewn_label_table table = parse(
        "\xef\xbb\xbfLabel,Name,R,G,B\n7,\"Superior, left\",1,2,3\n-3, K\xc3\xb6rper\n9000000000;a b;10;20;30\n"
        "5 Brodmann area 17\n6 My area 4 255 0 0\n11\tname with  spaces\t9\t8\t7\t255\n12 x 0.5 1.0 0\n13 \"a  b\"\n");
    assert_int_equal(table.count, 8);
    for (size_t i = 1; i < table.count; i++)
        assert_true(table.entries[i - 1].label < table.entries[i].label);
    check_entry(&table, 7, "Superior, left", 0x010203ff);
    check_entry(&table, -3, "K\xc3\xb6rper", 0);
    check_entry(&table, 9000000000, "a b", 0x0a141eff);
    check_entry(&table, 5, "Brodmann area 17", 0);
    check_entry(&table, 6, "My area 4", 0xff0000ff);
    check_entry(&table, 11, "name with  spaces", 0x090807ff);
    check_entry(&table, 12, "x", 0x80ff00ff);
    check_entry(&table, 13, "a  b", 0);
    hewn_label_table_destroy(&table);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t line;
        const char *reason;
    } bad[] = {
        {"", 0, "no label"},
        {"# nothing\n\n", 0, "no label"},
        {"1 a\nx b\n", 2, "number of a label"},
        {"a b\n", 1, "number of a label"},
        {"1.5 a\n", 1, "number of a label"},
        {"1e300 a\n", 1, "number of a label"},
        {"nan a\n", 1, "number of a label"},
        {"1 a\n\n2\n", 3, "no name"},
        {"1 \"\"\n", 1, "no name"},
        {"1 a\n2 b\n1 c\n", 3, "second time"},
        {"3 a\n2 b\n2 c\n3 d\n", 3, "second time"},
        {"1 a 1 2 256\n", 1, "0 to 255"},
        {"1 a 1 2 -1 255\n", 1, "0 to 255"},
        {"1 a 1 2 3 300\n", 1, "0 to 255"},
        {"1 1 2 3 1.5 1 1 \"a\"\n", 1, "0 to 1"},
        {"1 a\x01"
         "b\n",
         1, "control"},
        {"1 \xff\xfe\n", 1, "UTF-8"},
        {"1 \xc0\xaf\n", 1, "UTF-8"},
        {"1 \xed\xa0\x80\n", 1, "UTF-8"},
        {"1 a\xe2\x82\n", 1, "UTF-8"},
        {"1,a,2,3\n", 1, "three or four"},
        {"1,a,red,3,4\n", 1, "three numbers"},
        {"1\ta\t1\t2\t3\t4\t5\n", 1, "three or four"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        hewn_label_table table;
        hewn_error error = {0};
        hewn_result result = hewn_label_table_parse(bad[i].text, strlen(bad[i].text), "t.txt", &table, &error);
        if (result != HEWN_BAD_INPUT || error.line != bad[i].line || !strstr(error.message, bad[i].reason) ||
            strcmp(error.file, "t.txt") != 0)
            fail_msg("'%s': %s:%u: %s", bad[i].text, error.file, error.line, error.message);
        assert_null(table.entries);
    }
    hewn_label_table table;
    char zeros[] = "1 a\0b\n";
    assert_int_equal(hewn_label_table_parse(zeros, sizeof zeros - 1, "t", &table, NULL), HEWN_BAD_INPUT);
    assert_int_equal(hewn_label_table_read("/nonexistent", &table, NULL), HEWN_IO);
}

/* Bytes of any kind are taken or refused, never worse. */
static void test_random_bytes(void **state)
{
    (void)state;
    static const char alphabet[] = "0123456789 \t\n\r\",;#abz.-+e\xc3\xb6\xff/";
    random_state random = {5};
    for (int round = 0; round < 20000; round++) {
        char text[200];
        size_t length = random_below(&random, sizeof text);
        for (size_t i = 0; i < length; i++)
            text[i] = alphabet[random_below(&random, sizeof alphabet - 1)];
        hewn_label_table table;
        hewn_error error = {0};
        char *exact = hewn_alloc(length, 1); /* so that reading past the end is noticed */
        memcpy(exact, text, length);
        hewn_result result = hewn_label_table_parse(exact, length, "t", &table, &error);
        hewn_free(exact);
        assert_true(result == HEWN_OK || result == HEWN_BAD_INPUT);
        for (size_t i = 0; i < table.count; i++)
            assert_true(table.entries[i].name[0] != '\0');
        hewn_label_table_destroy(&table);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_snap),  cmocka_unit_test(test_freesurfer), cmocka_unit_test(test_slicer),
        cmocka_unit_test(test_plain), cmocka_unit_test(test_refused),    cmocka_unit_test(test_random_bytes),
    };
    return cmocka_run_group_tests_name("label_table", tests, NULL, NULL);
}
