/* The prefix sum against a serial twin: every kind of length, sums past 32 bits, counts that only the device knows. */
#include "gpu_test.h"

#include "base/alloc.h"
#include "shared/scan.h"

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    hewn_scan *scan;
} fixture;

static int open_fixture(void **state)
{
    static fixture shared;
    shared.device = gpu_test_open(&shared.messages);
    GPU_TEST_TRY(hewn_scan_create(shared.device, false, &shared.scan, &error));
    *state = &shared;
    return 0;
}

static int close_fixture(void **state)
{
    fixture *f = *state;
    hewn_scan_destroy(f->device, &f->scan);
    assert_null(f->scan);
    gpu_test_close(&f->device, &f->messages);
    return 0;
}

static hewn_buffer make_buffer(fixture *f, uint64_t bytes, hewn_buffer_use use)
{
    hewn_buffer buffer;
    GPU_TEST_TRY(hewn_buffer_create(f->device, "a test", bytes, use, &buffer, &error));
    return buffer;
}

typedef struct job {
    uint32_t count;    /* values that are there */
    uint32_t capacity; /* values that there is room for; the rest must stay as they are */
    uint32_t guard;    /* words before and behind, which must stay too */
    bool indirect;
    uint32_t (*value)(uint64_t *random);
} job;

static uint32_t value_small(uint64_t *random)
{
    return gpu_test_random(random) & 15;
}

static uint32_t value_any(uint64_t *random)
{
    return gpu_test_random(random);
}

static uint32_t value_most(uint64_t *random)
{
    (void)random;
    return UINT32_MAX;
}

static uint32_t value_one(uint64_t *random)
{
    (void)random;
    return 1;
}

static void record(fixture *f, const job *j, const hewn_buffer *values, const hewn_buffer *total,
                   const hewn_buffer *scratch, const hewn_buffer *upload, const hewn_buffer *back)
{
    const uint64_t bytes = ((uint64_t)j->capacity + 2 * j->guard) * 4;
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    hewn_commands_copy(commands, upload, 0, values, 0, bytes);
    hewn_commands_copy(commands, upload, bytes, total, 0, 16);
    const uint64_t address = values->address + j->guard * 4ull;
    if (j->indirect)
        hewn_scan_record_indirect(f->scan, commands, address, total->address + 12, j->capacity, total->address,
                                  scratch->address);
    else
        hewn_scan_record(f->scan, commands, address, j->count, total->address, scratch->address);
    hewn_commands_copy(commands, values, 0, back, 0, bytes);
    hewn_commands_copy(commands, total, 0, back, bytes, 16);
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
}

/* The twin: one loop, 64 bits. */
static void compare(const job *j, const uint32_t *before, const uint32_t *after)
{
    const uint64_t words = (uint64_t)j->capacity + 2 * j->guard;
    uint64_t sum = 0, wrong = 0, first = 0;
    for (uint64_t i = 0; i < words; i++) {
        bool inside = i >= j->guard && i - j->guard < j->count;
        if (after[i] != (inside ? (uint32_t)sum : before[i]) && wrong++ == 0)
            first = i;
        if (inside)
            sum += before[i];
    }
    if (wrong)
        fail_msg("%llu of %llu words wrong, first %llu: %u", (unsigned long long)wrong, (unsigned long long)words,
                 (unsigned long long)first, after[first]);
    assert_int_equal(after[words], (uint32_t)sum);
    assert_int_equal(after[words + 1], sum >> 32);
    assert_int_equal(after[words + 2], 0xabababab);
    hewn_error error = {0};
    hewn_result checked = hewn_scan_check(after + words, "things", &error);
    assert_int_equal(checked, sum > UINT32_MAX ? HEWN_LIMIT : HEWN_OK);
    if (sum > UINT32_MAX)
        assert_non_null(strstr(error.message, "things"));
}

static void run_job(fixture *f, const job *j)
{
    const uint64_t words = (uint64_t)j->capacity + 2 * j->guard;
    hewn_buffer values = make_buffer(f, words * 4, HEWN_BUFFER_DEVICE);
    hewn_buffer total = make_buffer(f, 16, HEWN_BUFFER_DEVICE);
    hewn_buffer scratch = make_buffer(f, hewn_scan_scratch_bytes(j->capacity), HEWN_BUFFER_DEVICE);
    hewn_buffer upload = make_buffer(f, words * 4 + 16, HEWN_BUFFER_UPLOAD);
    hewn_buffer back = make_buffer(f, words * 4 + 16, HEWN_BUFFER_READBACK);
    uint32_t *before = upload.mapped;
    uint64_t random = 0x9e3779b97f4a7c15u + j->count;
    for (uint64_t i = 0; i < words; i++)
        before[i] = j->value(&random);
    before[words] = before[words + 1] = before[words + 2] = 0xabababab;
    before[words + 3] = j->count;
    record(f, j, &values, &total, &scratch, &upload, &back);
    compare(j, before, back.mapped);
    hewn_buffer_destroy(f->device, &values);
    hewn_buffer_destroy(f->device, &total);
    hewn_buffer_destroy(f->device, &scratch);
    hewn_buffer_destroy(f->device, &upload);
    hewn_buffer_destroy(f->device, &back);
    assert_int_equal(f->messages, 0);
}

/* Around the sizes of an invocation, a workgroup's block, and a block of blocks. */
static const uint32_t edge_counts[] = {0,           1,
                                       2,           31,
                                       32,          33,
                                       63,          64,
                                       65,          255,
                                       256,         257,
                                       2047,        2048,
                                       2049,        4095,
                                       4096,        4097,
                                       65535,       65536,
                                       65537,       (1u << 20) + 3,
                                       2048 * 2048, 2048 * 2048 + 1};

static void test_edges(void **state)
{
    for (size_t i = 0; i < sizeof edge_counts / sizeof *edge_counts; i++) {
        job j = {.count = edge_counts[i], .capacity = edge_counts[i], .guard = 3, .value = value_small};
        run_job(*state, &j);
    }
}

static void test_edges_indirect(void **state)
{
    for (size_t i = 0; i < sizeof edge_counts / sizeof *edge_counts; i++)
        for (uint32_t spare = 0; spare <= (edge_counts[i] > 100000 ? 0u : 5000u); spare += 2500) {
            job j = {.count = edge_counts[i],
                     .capacity = edge_counts[i] + spare,
                     .guard = 3,
                     .indirect = true,
                     .value = value_small};
            run_job(*state, &j);
        }
}

/* Room for many, few there: the levels above must not read what nobody wrote. */
static void test_indirect_nearly_empty(void **state)
{
    for (uint32_t count = 0; count < 3; count++) {
        job j = {.count = count, .capacity = 2048 * 2048 * 2 + 5, .indirect = true, .value = value_any};
        run_job(*state, &j);
    }
}

static void test_random_lengths(void **state)
{
    uint64_t random = 7;
    for (int i = 0; i < 60; i++) {
        uint32_t capacity = gpu_test_random(&random) >> (8 + gpu_test_random(&random) % 24);
        capacity = capacity > 1u << 19 ? 1u << 19 : capacity;
        job j = {.capacity = capacity, .guard = gpu_test_random(&random) % 5, .value = value_any};
        j.indirect = i % 2;
        j.count = j.indirect ? gpu_test_random(&random) % (capacity + 1) : capacity;
        run_job(*state, &j);
    }
}

/* Sums around 2^32: exact, whatever the carry goes through. */
static void test_overflow(void **state)
{
    const uint32_t counts[] = {1, 2, 3, 64, 2048, 2049, 300000};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (int indirect = 0; indirect < 2; indirect++) {
            job most = {.count = counts[i], .capacity = counts[i], .indirect = indirect, .value = value_most};
            run_job(*state, &most);
            job any = {.count = counts[i], .capacity = counts[i], .indirect = indirect, .value = value_any};
            run_job(*state, &any);
        }
}

/* An invocation that loops over more than 65,535 values is cut short by some drivers, without an error: a sum of ones
 * would then be too small. Both the plain and the indirect form pass that length in one workgroup's reach. */
static void test_no_long_loops(void **state)
{
    const uint32_t counts[] = {65535 * 2, 65535 * 64 + 1};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (int indirect = 0; indirect < 2; indirect++) {
            job j = {.count = counts[i], .capacity = counts[i], .indirect = indirect, .value = value_one};
            run_job(*state, &j);
        }
    assert_true(HEWN_SCAN_ITEMS < 65535 && HEWN_SCAN_GROUP < 65535);
}

/* More workgroups than one row of a dispatch has. */
static void test_large(void **state)
{
    fixture *f = *state;
    if (!gpu_test_long()) {
        print_message("# 2^26 and beyond only with HEWN_LONG\n");
        skip();
    }
    const uint32_t counts[] = {1u << 26, (1u << 26) + 2048 * 3 + 1};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (int indirect = 0; indirect < 2; indirect++) {
            job j = {.count = counts[i], .capacity = counts[i], .indirect = indirect, .value = value_any};
            if (counts[i] * 4ull <= hewn_device_get_info(f->device)->max_allocation)
                run_job(f, &j);
        }
}

/* Several scans in one recording share the scratch one after another. */
static void test_several_in_one_recording(void **state)
{
    fixture *f = *state;
    enum { COUNT = 5000, TIMES = 4 };
    hewn_buffer values = make_buffer(f, COUNT * 4, HEWN_BUFFER_DEVICE);
    hewn_buffer totals = make_buffer(f, TIMES * 8 + 4, HEWN_BUFFER_DEVICE);
    hewn_buffer scratch = make_buffer(f, hewn_scan_scratch_bytes(COUNT), HEWN_BUFFER_DEVICE);
    hewn_buffer back = make_buffer(f, COUNT * 4 + TIMES * 8, HEWN_BUFFER_READBACK);
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    hewn_commands_fill(commands, &values, 0, COUNT * 4, 1);
    hewn_commands_fill(commands, &totals, TIMES * 8, 4, COUNT);
    uint64_t prefix[COUNT], totals_expected[TIMES];
    for (size_t i = 0; i < COUNT; i++)
        prefix[i] = 1;
    for (int t = 0; t < TIMES; t++) {
        if (t % 2)
            hewn_scan_record_indirect(f->scan, commands, values.address, totals.address + TIMES * 8, COUNT,
                                      totals.address + 8u * (unsigned)t, scratch.address);
        else
            hewn_scan_record(f->scan, commands, values.address, COUNT, totals.address + 8u * (unsigned)t,
                             scratch.address);
        uint64_t sum = 0;
        for (size_t i = 0; i < COUNT; i++) {
            uint64_t value = (uint32_t)prefix[i];
            prefix[i] = sum;
            sum += value;
        }
        totals_expected[t] = sum;
    }
    hewn_commands_copy(commands, &values, 0, &back, 0, COUNT * 4);
    hewn_commands_copy(commands, &totals, 0, &back, COUNT * 4, TIMES * 8);
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    const uint32_t *got = back.mapped;
    for (size_t i = 0; i < COUNT; i++)
        assert_int_equal(got[i], (uint32_t)prefix[i]);
    for (size_t t = 0; t < TIMES; t++)
        assert_int_equal((uint64_t)got[COUNT + 2 * t + 1] << 32 | got[COUNT + 2 * t], totals_expected[t]);
    hewn_buffer_destroy(f->device, &values);
    hewn_buffer_destroy(f->device, &totals);
    hewn_buffer_destroy(f->device, &scratch);
    hewn_buffer_destroy(f->device, &back);
}

static void test_too_long_is_refused(void **state)
{
    fixture *f = *state;
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    hewn_scan_record(f->scan, commands, 4096, 1ull << 32, 4096, 4096);
    hewn_error error = {0};
    assert_int_equal(hewn_commands_submit(&commands, NULL, &error), HEWN_LIMIT);
    assert_null(commands);
    assert_int_equal(error.code, HEWN_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_edges_indirect),
        cmocka_unit_test(test_random_lengths),
        cmocka_unit_test(test_indirect_nearly_empty),
        cmocka_unit_test(test_overflow),
        cmocka_unit_test(test_no_long_loops),
        cmocka_unit_test(test_large),
        cmocka_unit_test(test_several_in_one_recording),
        cmocka_unit_test(test_too_long_is_refused),
    };
    return cmocka_run_group_tests_name("scan", tests, open_fixture, close_fixture);
}
