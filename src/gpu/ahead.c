#include "gpu/ahead.h"

#include <pthread.h>
#include <sched.h>
#include <string.h>
#include <time.h>

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/empty_run.h"
#include "gpu/program.h"

static const char known_folder[] = "known";

enum {
    KNOWN_MOST = 4096,            /* programs that a driver has had: the latest ones */
    WRITING_NANOSECONDS = 5000000 /* that a driver may take to put a program's code on the disk */
};

/* A program that wants its code. */
typedef struct job {
    const hewn_program *program; /* the device's own; NULL once it is destroyed */
    uint32_t *words;
    size_t bytes;
    hewn_hash key;
    uint32_t push_bytes;
    bool uniforms;
    enum { WAITS, IN_WORK, DONE, FAILED } state;
} job;

struct hewn_ahead {
    hewn_device *device;
    hewn_hash *known; /* programs that the driver has had; the caller's thread only */
    size_t known_count, known_capacity;
    job *jobs; /* none is removed before all are done */
    size_t job_count, job_capacity, taken;
    hewn_empty_run own;
    bool own_open;
    pthread_mutex_t lock;   /* of the jobs */
    pthread_cond_t changed; /* a job came, a job is done, or it is time to stop */
    pthread_t thread;
    bool threaded, stopping;
    hewn_device second; /* the thread's */
};

bool hewn_ahead_pays(const hewn_device *device)
{
    cpu_set_t cores;
    return device->compiles_late && device->cache.root && sched_getaffinity(0, sizeof cores, &cores) == 0 &&
           CPU_COUNT(&cores) > 1;
}

/* --- which programs the driver has had -----------------------------------------------------------------------------
 */

static bool is_known(const hewn_ahead *ahead, hewn_hash key)
{
    for (size_t i = 0; i < ahead->known_count; i++)
        if (ahead->known[i].a == key.a && ahead->known[i].b == key.b)
            return true;
    return false;
}

static void load_known(hewn_ahead *ahead)
{
    size_t bytes;
    ahead->known = hewn_cache_load(&ahead->device->cache, known_folder, ahead->device->pipeline_key, &bytes);
    ahead->known_count = ahead->known_capacity = bytes / sizeof *ahead->known;
}

/* Another process may have added to the list since it was read: what it added is done again at worst. */
static hewn_result save_known(hewn_ahead *ahead, hewn_error *error)
{
    bool more = false;
    for (size_t i = 0; i < ahead->job_count; i++) {
        const job *one = &ahead->jobs[i];
        if (one->state != DONE || is_known(ahead, one->key))
            continue;
        void *items = ahead->known;
        HEWN_TRY(hewn_reserve(&items, &ahead->known_capacity, ahead->known_count + 1, sizeof *ahead->known, error));
        ahead->known = items;
        ahead->known[ahead->known_count++] = one->key;
        more = true;
    }
    size_t kept = ahead->known_count < KNOWN_MOST ? ahead->known_count : KNOWN_MOST;
    if (more)
        hewn_cache_store(&ahead->device->cache, known_folder, ahead->device->pipeline_key,
                         ahead->known + (ahead->known_count - kept), kept * sizeof *ahead->known);
    return HEWN_OK;
}

/* --- taking turns ---------------------------------------------------------------------------------------------------
 */

/* The largest one that waits, or -1. The lock is held. */
static ptrdiff_t largest_waiting(const hewn_ahead *ahead)
{
    ptrdiff_t found = -1;
    for (size_t i = 0; i < ahead->job_count; i++)
        if (ahead->jobs[i].state == WAITS && (found < 0 || ahead->jobs[i].bytes > ahead->jobs[found].bytes))
            found = (ptrdiff_t)i;
    return found;
}

static bool anything_in_work(const hewn_ahead *ahead)
{
    for (size_t i = 0; i < ahead->job_count; i++)
        if (ahead->jobs[i].state == IN_WORK)
            return true;
    return false;
}

/* On the second device, whose program is made for that and goes again. */
static hewn_result run_second(hewn_device *device, hewn_empty_run *run, const job *one)
{
    hewn_program program = {.push_bytes = one->push_bytes, .uniforms = one->uniforms};
    hewn_result result = hewn_program_make(device, "made ahead", &program, one->words, one->bytes, NULL);
    if (result == HEWN_OK)
        result = hewn_empty_run_do(device, run, &program, NULL);
    hewn_program_unmake(device, &program);
    return result;
}

static void work(hewn_ahead *ahead, hewn_empty_run *run)
{
    pthread_mutex_lock(&ahead->lock);
    while (!ahead->stopping) {
        ptrdiff_t at = largest_waiting(ahead);
        if (at < 0) {
            pthread_cond_wait(&ahead->changed, &ahead->lock);
            continue;
        }
        ahead->jobs[at].state = IN_WORK;
        job one = ahead->jobs[at]; /* the array may move meanwhile */
        pthread_mutex_unlock(&ahead->lock);
        hewn_result result = run_second(&ahead->second, run, &one);
        pthread_mutex_lock(&ahead->lock);
        ahead->jobs[at].state = result == HEWN_OK ? DONE : FAILED;
        pthread_cond_broadcast(&ahead->changed);
    }
    pthread_mutex_unlock(&ahead->lock);
}

/* The thread. Where it cannot have a device of its own, the caller's does it all. */
static void *make_ahead(void *user)
{
    hewn_ahead *ahead = user;
    hewn_empty_run run = {0};
    if (hewn_device_open_second(ahead->device, &ahead->second, NULL) == HEWN_OK) {
        if (hewn_empty_run_open(&ahead->second, &run, NULL) == HEWN_OK)
            work(ahead, &run);
        hewn_empty_run_close(&ahead->second, &run);
    }
    hewn_device_close_second(&ahead->second);
    return NULL;
}

/* --- the caller's side ----------------------------------------------------------------------------------------------
 */

static hewn_result begin(hewn_device *device, hewn_error *error)
{
    hewn_ahead *ahead = hewn_alloc_zero(1, sizeof *ahead);
    if (!ahead)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for making machine code");
    ahead->device = device;
    pthread_mutex_init(&ahead->lock, NULL);
    pthread_cond_init(&ahead->changed, NULL);
    load_known(ahead);
    device->ahead = ahead;
    return HEWN_OK;
}

hewn_result hewn_ahead_add(hewn_device *device, const hewn_program *program, const uint32_t *words, size_t bytes,
                           hewn_error *error)
{
    if (!device->ahead)
        HEWN_TRY(begin(device, error));
    hewn_ahead *ahead = device->ahead;
    hewn_hash key = hewn_hash_bytes(hewn_hash_begin(), words, bytes);
    if (is_known(ahead, key))
        return HEWN_OK;
    job one = {.program = program,
               .words = hewn_alloc(bytes, 1),
               .bytes = bytes,
               .key = key,
               .push_bytes = program->push_bytes,
               .uniforms = program->uniforms};
    if (!one.words)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for making machine code");
    memcpy(one.words, words, bytes);
    pthread_mutex_lock(&ahead->lock);
    void *jobs = ahead->jobs;
    hewn_result result = hewn_reserve(&jobs, &ahead->job_capacity, ahead->job_count + 1, sizeof *ahead->jobs, error);
    ahead->jobs = jobs;
    if (result == HEWN_OK)
        ahead->jobs[ahead->job_count++] = one;
    pthread_cond_broadcast(&ahead->changed);
    pthread_mutex_unlock(&ahead->lock);
    if (result == HEWN_OK)
        ahead->taken++;
    if (result != HEWN_OK)
        hewn_free(one.words);
    else if (!ahead->threaded)
        ahead->threaded = pthread_create(&ahead->thread, NULL, make_ahead, ahead) == 0;
    return result;
}

size_t hewn_ahead_taken(const hewn_device *device)
{
    return device->ahead ? device->ahead->taken : 0;
}

void hewn_ahead_forget(hewn_device *device, const hewn_program *program)
{
    hewn_ahead *ahead = device->ahead;
    if (!ahead)
        return;
    pthread_mutex_lock(&ahead->lock);
    for (size_t i = 0; i < ahead->job_count; i++)
        if (ahead->jobs[i].program == program) {
            ahead->jobs[i].program = NULL;
            if (ahead->jobs[i].state == WAITS)
                ahead->jobs[i].state = FAILED;
        }
    pthread_mutex_unlock(&ahead->lock);
}

/* Takes part until nothing waits and nothing is in work. The driver puts code on the disk by a thread of its own, so
 * that what the second device did last may not be there yet. */
static hewn_result take_part(hewn_ahead *ahead, hewn_error *error)
{
    hewn_result result = HEWN_OK;
    bool waited = false;
    pthread_mutex_lock(&ahead->lock);
    for (ptrdiff_t at; result == HEWN_OK;) {
        at = largest_waiting(ahead);
        if (at < 0 && !anything_in_work(ahead))
            break;
        if (at < 0) {
            waited = true;
            pthread_cond_wait(&ahead->changed, &ahead->lock);
            continue;
        }
        ahead->jobs[at].state = IN_WORK;
        const hewn_program *program = ahead->jobs[at].program;
        pthread_mutex_unlock(&ahead->lock);
        result = hewn_empty_run_do(ahead->device, &ahead->own, program, error);
        pthread_mutex_lock(&ahead->lock);
        ahead->jobs[at].state = result == HEWN_OK ? DONE : FAILED;
        waited = false;
    }
    pthread_mutex_unlock(&ahead->lock);
    if (waited)
        nanosleep(&(struct timespec){.tv_nsec = WRITING_NANOSECONDS}, NULL);
    return result;
}

static void clear_jobs(hewn_ahead *ahead)
{
    for (size_t i = 0; i < ahead->job_count; i++)
        hewn_free(ahead->jobs[i].words);
    ahead->job_count = 0;
}

hewn_result hewn_ahead_finish(hewn_device *device, hewn_error *error)
{
    hewn_ahead *ahead = device->ahead;
    if (!ahead || ahead->job_count == 0)
        return HEWN_OK;
    if (!ahead->own_open) {
        hewn_result opened = hewn_empty_run_open(device, &ahead->own, error);
        if (opened != HEWN_OK) {
            hewn_empty_run_close(device, &ahead->own);
            return opened;
        }
        ahead->own_open = true;
    }
    HEWN_TRY(take_part(ahead, error));
    hewn_result result = save_known(ahead, error);
    pthread_mutex_lock(&ahead->lock);
    clear_jobs(ahead);
    pthread_mutex_unlock(&ahead->lock);
    return result;
}

void hewn_ahead_stop(hewn_device *device)
{
    hewn_ahead *ahead = device->ahead;
    if (!ahead)
        return;
    pthread_mutex_lock(&ahead->lock);
    ahead->stopping = true;
    pthread_cond_broadcast(&ahead->changed);
    pthread_mutex_unlock(&ahead->lock);
    if (ahead->threaded)
        pthread_join(ahead->thread, NULL);
    hewn_empty_run_close(device, &ahead->own);
    clear_jobs(ahead);
    pthread_cond_destroy(&ahead->changed);
    pthread_mutex_destroy(&ahead->lock);
    hewn_free(ahead->jobs);
    hewn_free(ahead->known);
    hewn_free(ahead);
    device->ahead = NULL;
}
