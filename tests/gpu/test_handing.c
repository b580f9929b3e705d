/* Parts of a mesh that are made while the sink has the one before: by events, not by timings; that the sink is done
 * when whoever asked for the parts is told of the end; and that it gets them where there are no threads, too. */
#include <errno.h>
#include <pthread.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "gpu/device.h"
#include "gpu_test_device.h"
#include "hewn/hewn.h"

static const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_MC33, HEWN_METHOD_NETS, HEWN_METHOD_DC};
enum { METHODS = sizeof methods / sizeof *methods };

static const hewn_box unit_cube = {{-1, -1, -1}, {1, 1, 1}};

static hewn_extractor *make_extractor(void)
{
    hewn_field *field;
    hewn_extractor *extractor;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node root = hewn_union(field, hewn_sphere(field, 0.5), hewn_torus(field, 0.8, 0.11));
    GPU_TEST_TRY(hewn_extractor_create(device, field, root, &extractor, &error));
    hewn_field_destroy(&field);
    return extractor;
}

/* --- threads ------------------------------------------------------------------------------------------------------ */

/* Hewn's own threads, not those of the driver: the linker leads them here. */
typedef void *thread_work(void *);
int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, thread_work *work, void *user);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, thread_work *work, void *user);
static bool no_threads;

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, thread_work *work, void *user)
{
    return no_threads ? EAGAIN : __real_pthread_create(thread, attributes, work, user);
}

/* --- one part beside the next ------------------------------------------------------------------------------------- */

/* What a sink and the thread that makes parts know of each other. */
typedef struct relay {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool begun;  /* the part after the one that the sink has */
    bool cancel; /* when the second part has come */
    uint64_t parts, beside, done;
} relay;

/* The makers of parts ask before they hand one over, */
static uint64_t relay_bytes(void *user, const hewn_mesh_part *part)
{
    relay *of = user;
    pthread_mutex_lock(&of->lock);
    if (part)
        of->begun = false;
    pthread_mutex_unlock(&of->lock);
    return 0;
}

/* and tell when they begin one. */
static bool relay_report(void *user, const char *stage, double share)
{
    relay *of = user;
    pthread_mutex_lock(&of->lock);
    of->begun = strcmp(stage, "extract") == 0 && share < 1;
    bool stop = of->begun && of->cancel && of->parts > 1;
    pthread_cond_broadcast(&of->changed);
    pthread_mutex_unlock(&of->lock);
    return !stop;
}

/* Keeps a part until the next one is begun; the last one has none after it. */
static hewn_result relay_take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    relay *of = user;
    struct timespec end;
    int waited = 0;
    (void)error;
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += 60;
    pthread_mutex_lock(&of->lock);
    of->parts++;
    while (part->open_count > 0 && !of->begun && waited == 0)
        waited = pthread_cond_timedwait(&of->changed, &of->lock, &end);
    of->beside += part->open_count > 0 && of->begun;
    pthread_mutex_unlock(&of->lock);
    usleep(of->cancel ? 20000 : 0);
    of->done++; /* read by whoever has waited for this thread */
    return HEWN_OK;
}

/* By events: each part is begun before the sink is done with the one before it. */
static void test_sink_works_beside(void **state)
{
    (void)state;
    hewn_extractor *extractor = make_extractor();
    for (size_t m = 0; m < METHODS; m++) {
        relay of = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
        hewn_extract_stats stats;
        const hewn_progress progress = {.report = relay_report, .user = &of};
        const hewn_mesh_sink sink = {.user = &of, .take = relay_take, .bytes = relay_bytes};
        hewn_extract_desc desc = {
            .bounds = unit_cube, .resolution = 64, .method = methods[m], .max_memory = 600000, .progress = &progress};
        GPU_TEST_TRY(hewn_extract_parts(extractor, &desc, &sink, &stats, &error));
        assert_true(of.parts > 3);
        assert_int_equal(of.parts, stats.parts);
        assert_int_equal(of.beside, of.parts - 1);
    }
    hewn_extractor_destroy(&extractor);
}

/* Whoever is told of the end can rely on it: no sink is at work any more. */
static void test_cancelled_beside_the_sink(void **state)
{
    (void)state;
    hewn_extractor *extractor = make_extractor();
    relay of = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
    const hewn_progress progress = {.report = relay_report, .user = &of};
    const hewn_mesh_sink sink = {.user = &of, .take = relay_take, .bytes = relay_bytes};
    hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64, .max_memory = 600000, .progress = &progress};
    GPU_TEST_TRY(hewn_extract_parts(extractor, &desc, &sink, NULL, &error));
    uint64_t before = device->bytes;
    of.parts = of.done = 0;
    of.cancel = true;
    assert_int_equal(hewn_extract_parts(extractor, &desc, &sink, NULL, NULL), HEWN_CANCELLED);
    assert_true(of.parts > 1);
    assert_int_equal(of.done, of.parts);
    assert_int_equal(device->bytes, before);
    hewn_extractor_destroy(&extractor);
}

/* --- in turn ------------------------------------------------------------------------------------------------------ */

typedef struct tally {
    uint64_t parts, here, triangles; /* those that were taken on this thread */
    pthread_t thread;
} tally;

static hewn_result tally_take(void *user, const hewn_mesh_part *part, hewn_error *error)
{
    tally *of = user;
    (void)error;
    of->parts++;
    of->here += pthread_equal(pthread_self(), of->thread) != 0;
    of->triangles += part->triangles[0].count + part->triangles[1].count;
    return HEWN_OK;
}

static void test_no_threads(void **state)
{
    (void)state;
    hewn_extractor *extractor = make_extractor();
    tally of[2] = {{.thread = pthread_self()}, {.thread = pthread_self()}};
    hewn_extract_stats stats[2];
    const hewn_extract_desc desc = {.bounds = unit_cube, .resolution = 64, .max_memory = 600000};
    for (int i = 0; i < 2; i++) {
        const hewn_mesh_sink sink = {.user = &of[i], .take = tally_take};
        no_threads = i > 0;
        GPU_TEST_TRY(hewn_extract_parts(extractor, &desc, &sink, &stats[i], &error));
        assert_int_equal(of[i].triangles, stats[i].triangles);
        assert_int_equal(of[i].here, i > 0 ? of[i].parts : 0);
    }
    no_threads = false;
    assert_true(of[0].parts > 3);
    assert_int_equal(of[0].parts, of[1].parts);
    assert_int_equal(stats[0].peak_memory, stats[1].peak_memory);
    hewn_extractor_destroy(&extractor);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sink_works_beside),
        cmocka_unit_test(test_cancelled_beside_the_sink),
        cmocka_unit_test(test_no_threads),
    };
    return cmocka_run_group_tests_name("handing", tests, open_device, close_device);
}
