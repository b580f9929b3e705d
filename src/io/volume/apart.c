#include "io/volume/apart.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

/* What is sent back; samples follow it. Pointers of the other process to static tables hold here too, because it is a
 * copy of this one; others are sent as text. */
typedef struct reply {
    hewn_result result;
    hewn_error error;
    hewn_volume volume;
    uint64_t sample_bytes;
    char name[256], remark[256];
} reply;

/* Where samples begin. */
enum { SAMPLES_AT = HEWN_VOLUME_ROOM_AT };
_Static_assert(sizeof(reply) <= SAMPLES_AT, "samples begin after the reply");

static const uint64_t SPARE = (uint64_t)1 << 26; /* bytes for the library itself */

/* --- in the other process ----------------------------------------------------------------------------------------- */

static bool write_all(int file, const void *bytes, size_t length)
{
    for (const char *at = bytes; length > 0;) {
        size_t part = length < (size_t)1 << 30 ? length : (size_t)1 << 30;
        ssize_t put = write(file, at, part);
        if (put < 0 && errno == EINTR)
            continue;
        if (put <= 0)
            return false;
        at += put;
        length -= (size_t)put;
    }
    return true;
}

/* A number that lies may ask for all memory there is; then it gets none. The sanitizers need all addresses. */
static void limit_memory(const hewn_apart *job)
{
#if !defined(__SANITIZE_ADDRESS__)
    const hewn_volume_source limits = {.desc = job->desc};
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    bool known =
        file && fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) == 1; /* data and stack, as RLIMIT_DATA counts */
    if (file)
        fclose(file);
    uint64_t file_bytes = job->source ? job->source->length : 0; /* libraries copy it, more than once */
    uint64_t most =
        2 * hewn_volume_limit(&limits) + 4 * file_bytes + SPARE + (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
    const struct rlimit limit = {most, most};
    if (known)
        setrlimit(RLIMIT_DATA, &limit);
#else
    (void)job;
#endif
}

/* Nor may it work for ever. Of a folder nobody knows how much there is. */
static void limit_time(const hewn_apart *job)
{
    uint64_t seconds = 60 + (job->source ? job->source->length : 0) / (1 << 18);
    const struct rlimit limit = {seconds, seconds};
    if (job->source)
        setrlimit(RLIMIT_CPU, &limit); /* of this process, from its start */
}

static void copy_text(char out[256], const char *text)
{
    snprintf(out, 256, "%s", text ? text : "");
}

static uint64_t bytes_of(const hewn_volume *volume)
{
    if (volume->blocks)
        return volume->memory_length;
    return hewn_volume_frame_size(volume) * volume->frame_count * hewn_voxel_size(volume->type);
}

/* Sends the reply, and the samples unless the reader wrote them into the shared file itself. */
static bool send(const hewn_apart *job, int file, const reply *answer)
{
    char page[SAMPLES_AT] = {0};
    memcpy(page, answer, sizeof *answer);
    if (job->source && answer->result == HEWN_OK && answer->volume.mapped &&
        (answer->volume.blocks || answer->volume.samples == answer->volume.memory) &&
        answer->volume.memory_length == answer->sample_bytes)
        return pwrite(file, page, sizeof page, 0) == (ssize_t)sizeof page;
    return ftruncate(file, 0) == 0 && write_all(file, page, sizeof page) &&
           write_all(file, answer->volume.blocks ? answer->volume.memory : answer->volume.samples,
                     answer->sample_bytes);
}

static bool work(const hewn_apart *job, int file)
{
    static const int fatal[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGHUP};
    const struct rlimit no_core = {0, 0};
    hewn_volume_read_desc desc = *job->desc;
    reply answer = {.result = HEWN_OK};
    int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0)
        dup2(nowhere, STDERR_FILENO); /* where libraries say why they give up */
    for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++)
        signal(fatal[i], SIG_DFL);
    setrlimit(RLIMIT_CORE, &no_core);
    limit_memory(job);
    limit_time(job);
    desc.progress = NULL;
    if (job->source) {
        job->source->desc = &desc;
        job->source->room_file = file;
    }
    answer.result = job->read(job, &desc, &answer.volume, &answer.error);
    if (answer.result == HEWN_OK)
        answer.sample_bytes = bytes_of(&answer.volume);
    copy_text(answer.name, answer.volume.name);
    copy_text(answer.remark, answer.volume.remark);
    return send(job, file, &answer);
}

/* --- in this one -------------------------------------------------------------------------------------------------- */

/* Sleeps until the process ends, or it is time to report again. */
static void wait_a_while(int handle, struct timespec *pause)
{
    enum { LONGEST = 20000000 }; /* ns */
    struct pollfd ends = {.fd = handle, .events = POLLIN};
    if (handle >= 0) {
        (void)poll(&ends, 1, LONGEST / 1000000);
        return;
    }
    nanosleep(pause, NULL); /* nobody tells when: look more and more seldom */
    pause->tv_nsec = pause->tv_nsec < LONGEST ? 2 * pause->tv_nsec : pause->tv_nsec;
}

/* Waits for the other process; a callback that says no ends it. */
static hewn_result wait_for(const hewn_apart *job, pid_t child, int handle, int *status, hewn_error *error)
{
    struct timespec pause = {0, 200000}; /* 0.2 ms at first, then longer */
    for (;;) {
        hewn_result result = hewn_progress_report(job->desc->progress, "load", 0.5, error);
        if (result != HEWN_OK) {
            kill(child, SIGKILL);
            waitpid(child, status, 0);
            return result;
        }
        pid_t ended = waitpid(child, status, WNOHANG);
        if (ended == child)
            return HEWN_OK;
        if (ended < 0 && errno != EINTR)
            return hewn_fail_at(error, HEWN_IO, job->name, 0, "the process that reads it is lost");
        wait_a_while(handle, &pause);
    }
}

static hewn_result take_reply(const hewn_apart *job, int file, hewn_volume *out, hewn_error *error)
{
    reply answer;
    off_t length = lseek(file, 0, SEEK_END);
    if (length < SAMPLES_AT || pread(file, &answer, sizeof answer, 0) != (ssize_t)sizeof answer)
        return hewn_fail_at(error, HEWN_IO, job->name, 0, "the process that reads it sent no reply");
    if (answer.result != HEWN_OK) {
        if (error)
            *error = answer.error;
        return answer.result;
    }
    if ((uint64_t)length - SAMPLES_AT != answer.sample_bytes)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory for %llu bytes of samples",
                            (unsigned long long)answer.sample_bytes);
    void *block = mmap(NULL, (size_t)length, PROT_READ, MAP_PRIVATE, file, 0);
    if (block == MAP_FAILED)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory for the samples");
    *out = answer.volume;
    out->name = answer.name[0] ? hewn_strdup(answer.name) : NULL;
    out->remark = answer.remark[0] ? hewn_strdup(answer.remark) : NULL;
    out->memory = block;
    out->memory_length = (size_t)length;
    out->mapped = true;
    out->samples = out->blocks ? NULL : (const char *)block + SAMPLES_AT;
    out->blocks = out->blocks ? (const void *)((const char *)block + SAMPLES_AT) : NULL;
    return HEWN_OK;
}

static hewn_result run(const hewn_apart *job, int file, hewn_volume *out, hewn_error *error)
{
    int status = 0;
    pid_t child = fork();
    if (child < 0)
        return hewn_fail_at(error, HEWN_IO, job->name, 0, "no process can be made to read it");
    if (child == 0)
        _exit(work(job, file) ? 0 : 1);
    int handle = pidfd_open(child, 0);
    hewn_result waited = wait_for(job, child, handle, &status, error);
    if (handle >= 0)
        close(handle);
    HEWN_TRY(waited);
    if (!WIFEXITED(status))
        return hewn_fail_at(
            error, HEWN_BAD_INPUT, job->name, 0,
            "it is damaged in a way that the library which reads such files does not survive (signal %d)",
            WIFSIGNALED(status) ? WTERMSIG(status) : 0);
    if (WEXITSTATUS(status) != 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, job->name, 0, "the process that reads it failed (exit code %d)",
                            WEXITSTATUS(status));
    return take_reply(job, file, out, error);
}

hewn_result hewn_volume_read_apart(const hewn_apart *job, hewn_volume *out, hewn_error *error)
{
    *out = (hewn_volume){0};
    int file = memfd_create("hewn volume", MFD_CLOEXEC);
    if (file < 0)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory for the samples");
    hewn_result result = run(job, file, out, error);
    close(file);
    return result;
}
