#include "io/volume/apart.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "base/progress.h"
#include "io/shim/module.h"

/* --- the other process -------------------------------------------------------------------------------------------- */

/* A file in memory; never one of the first three, which the program gets for itself. */
static int create_file(const char *name)
{
    int made = memfd_create(name, MFD_CLOEXEC), file = made;
    if (made >= 0 && made <= STDERR_FILENO) {
        file = fcntl(made, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
        close(made);
    }
    return file;
}

/* The bytes as a file that the program can map: the one they are mapped from, or a copy in memory. */
static int open_input(const hewn_volume_source *source)
{
    if (source->mapped_file > 0)
        return fcntl(source->mapped_file, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    int file = create_file("hewn volume file");
    if (file >= 0 && !hewn_file_put(file, source->bytes, source->length)) {
        close(file);
        return -1;
    }
    return file;
}

/* Signals are as they are at a program's start, and libraries' complaints go nowhere. */
static int spawn(const char *program, char *const arguments[], int input, int reply, pid_t *child)
{
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    int failed = posix_spawn_file_actions_init(&files);
    if (failed)
        return failed;
    failed = posix_spawnattr_init(&attributes);
    if (failed) {
        posix_spawn_file_actions_destroy(&files);
        return failed;
    }
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    for (int standard = 0; standard < 3 && !failed; standard++)
        failed = posix_spawn_file_actions_addopen(&files, standard, "/dev/null", O_RDWR, 0);
    if (!failed && input >= 0) /* onto itself: it stays open in the program */
        failed = posix_spawn_file_actions_adddup2(&files, input, input);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&files, reply, reply);
    if (!failed)
        failed = posix_spawn(child, program, &files, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return failed;
}

static hewn_result start(const hewn_apart *job, int input, int reply, pid_t *child, hewn_error *error)
{
    char program[4096], numbers[HEWN_APART_ARGUMENTS][24];
    char *arguments[HEWN_APART_ARGUMENTS + 1] = {0};
    hewn_module_path(HEWN_APART_PROGRAM, program, sizeof program);
    const unsigned long long values[HEWN_APART_ARGUMENTS] = {[HEWN_APART_READER] = job->reader,
                                                             [HEWN_APART_LIMIT] = job->desc->memory_limit,
                                                             [HEWN_APART_BLOCKS] = job->desc->blocks,
                                                             [HEWN_APART_REPLY] = (unsigned)reply,
                                                             [HEWN_APART_INPUT] = (unsigned)(input + 1)};
    for (int i = 0; i < HEWN_APART_ARGUMENTS; i++) {
        snprintf(numbers[i], sizeof numbers[i], "%llu", values[i]);
        arguments[i] = numbers[i];
    }
    arguments[0] = program;
    arguments[HEWN_APART_VERSION] = (char *)hewn_version(); /* programs take theirs as if they could be written */
    arguments[HEWN_APART_NAME] = (char *)job->name;
    arguments[HEWN_APART_CHOICE] = (char *)job->choice;
    int failed = spawn(program, arguments, input, reply, child);
    if (failed)
        return hewn_fail_at(error, failed == ENOMEM || failed == EAGAIN ? HEWN_OUT_OF_MEMORY : HEWN_MISSING_FEATURE,
                            job->name, 0, "what reads such files, %s, cannot be run: %s", program, strerror(failed));
    return HEWN_OK;
}

/* --- this one ----------------------------------------------------------------------------------------------------- */

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
    hewn_apart_reply answer;
    off_t length = lseek(file, 0, SEEK_END);
    if (length < HEWN_VOLUME_ROOM_AT || pread(file, &answer, sizeof answer, 0) != (ssize_t)sizeof answer)
        return hewn_fail_at(error, HEWN_IO, job->name, 0, "the process that reads it sent no reply");
    if (answer.result != HEWN_OK) {
        if (error)
            *error = answer.error;
        return answer.result;
    }
    if ((uint64_t)length - HEWN_VOLUME_ROOM_AT != answer.sample_bytes)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory for %llu bytes of samples",
                            (unsigned long long)answer.sample_bytes);
    char *block = mmap(NULL, (size_t)length, PROT_READ, MAP_PRIVATE, file, 0);
    if (block == MAP_FAILED)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory for the samples");
    *out = answer.volume;
    out->name = answer.name[0] ? hewn_strdup(answer.name) : NULL;
    out->remark = answer.remark[0] ? hewn_strdup(answer.remark) : NULL;
    out->unit = answer.unit[0] ? hewn_unit_find(answer.unit) : NULL;
    out->memory = block;
    out->memory_length = (size_t)length;
    out->mapped = true;
    out->samples = answer.blocks ? NULL : block + HEWN_VOLUME_ROOM_AT;
    out->blocks = answer.blocks ? (const void *)(block + HEWN_VOLUME_ROOM_AT) : NULL;
    return HEWN_OK;
}

/* Whether it came to its end. */
static hewn_result judge(const hewn_apart *job, int status, hewn_error *error)
{
    if (!WIFEXITED(status))
        return hewn_fail_at(
            error, HEWN_BAD_INPUT, job->name, 0,
            "it is damaged in a way that the library which reads such files does not survive (signal %d)",
            WIFSIGNALED(status) ? WTERMSIG(status) : 0);
    if (WEXITSTATUS(status) == HEWN_APART_OTHER_VERSION)
        return hewn_fail_at(error, HEWN_MISSING_FEATURE, job->name, 0,
                            "the program " HEWN_APART_PROGRAM ", which reads such files, is of another version");
    if (WEXITSTATUS(status) != 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, job->name, 0, "the process that reads it failed (exit code %d)",
                            WEXITSTATUS(status));
    return HEWN_OK;
}

static hewn_result run(const hewn_apart *job, int input, int reply, hewn_volume *out, hewn_error *error)
{
    int status = 0;
    pid_t child;
    HEWN_TRY(start(job, input, reply, &child, error));
    int handle = pidfd_open(child, 0);
    hewn_result result = wait_for(job, child, handle, &status, error);
    if (handle >= 0)
        close(handle);
    if (result == HEWN_OK)
        result = judge(job, status, error);
    return result == HEWN_OK ? take_reply(job, reply, out, error) : result;
}

hewn_result hewn_volume_read_apart(const hewn_apart *job, hewn_volume *out, hewn_error *error)
{
    hewn_result result;
    *out = (hewn_volume){0};
    int reply = create_file("hewn volume"), input = job->source ? open_input(job->source) : -1;
    if (reply < 0 || (job->source && input < 0))
        result = hewn_fail_at(error, HEWN_OUT_OF_MEMORY, job->name, 0, "out of memory for the samples");
    else
        result = run(job, input, reply, out, error);
    if (input >= 0)
        close(input);
    if (reply >= 0)
        close(reply);
    return result;
}
