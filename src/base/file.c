#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"

enum { OUTPUT_BUFFER = 1 << 20, READ_STEP = 1 << 16 };

static hewn_result system_failure(hewn_error *error, const char *path, const char *what, int code)
{
    char reason[128];
    const char *text = strerror_r(code, reason, sizeof reason);
    return hewn_fail_at(error, HEWN_IO, path, 0, "%s: %s", what, text);
}

static hewn_result out_of_memory(hewn_error *error, const char *path)
{
    return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, path, 0, "out of memory");
}

/* --- reading ----------------------------------------------------------------------------------------------------- */

static hewn_result too_long(hewn_error *error, const char *name, size_t limit)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "larger than the limit of %zu bytes", limit);
}

/* Reads to the end into a block that starts with room for `expected` bytes. */
static hewn_result read_all(int file, const char *name, size_t expected, size_t limit, char **bytes, size_t *length,
                            hewn_error *error)
{
    size_t capacity = expected + READ_STEP, used = 0;
    char *block = hewn_alloc(capacity, 1);
    if (!block)
        return out_of_memory(error, name);
    for (;;) {
        if (capacity - used < READ_STEP) {
            void *items = block;
            if (hewn_reserve(&items, &capacity, used + READ_STEP, 1, NULL) != HEWN_OK) {
                hewn_free(block);
                return out_of_memory(error, name);
            }
            block = items;
        }
        ssize_t got = read(file, block + used, capacity - used - 1);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0) {
            int code = errno;
            hewn_free(block);
            return system_failure(error, name, "cannot read", code);
        }
        if (got == 0)
            break;
        used += (size_t)got;
        if (used > limit) {
            hewn_free(block);
            return too_long(error, name, limit);
        }
    }
    block[used] = '\0';
    *bytes = block;
    *length = used;
    return HEWN_OK;
}

hewn_result hewn_file_read(const char *path, size_t limit, char **bytes, size_t *length, hewn_error *error)
{
    *bytes = NULL;
    *length = 0;
    bool standard = strcmp(path, "-") == 0;
    const char *name = standard ? "standard input" : path;
    int file = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return system_failure(error, name, "cannot open", errno);
    struct stat status;
    hewn_result result;
    if (fstat(file, &status) != 0) {
        result = system_failure(error, name, "cannot read", errno);
    } else if (S_ISDIR(status.st_mode)) {
        result = hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "is a folder");
    } else if (S_ISREG(status.st_mode) && (uint64_t)status.st_size > limit) {
        result = too_long(error, name, limit);
    } else {
        size_t expected = S_ISREG(status.st_mode) ? (size_t)status.st_size : 0;
        result = read_all(file, name, expected, limit, bytes, length, error);
    }
    if (!standard)
        close(file);
    return result;
}

/* --- writing ----------------------------------------------------------------------------------------------------- */

struct hewn_output {
    int file;
    bool owned;      /* `file` is ours to close: not standard output */
    char *name;      /* for messages */
    char *target;    /* where the finished file goes; NULL where it is written in place */
    char *temporary; /* the file until then; NULL likewise */
    size_t used;
    hewn_result status; /* the first failure, for good */
    hewn_error failure;
    char buffer[OUTPUT_BUFFER];
};

static hewn_result repeat_failure(const hewn_output *output, hewn_error *error)
{
    if (error)
        *error = output->failure;
    return output->status;
}

/* Remembers the failure in the output and hands it to the caller. */
static hewn_result fail_output(hewn_output *output, const char *what, int code, hewn_error *error)
{
    output->status = system_failure(&output->failure, output->name, what, code);
    return repeat_failure(output, error);
}

/* "folder/.hewn-0123456789abcdef.tmp" beside `target`: short whatever the target's name is, and not to be guessed. */
static char *temporary_name(const char *target)
{
    const char *slash = strrchr(target, '/');
    size_t folder = slash ? (size_t)(slash - target) + 1 : 0;
    uint64_t random;
    if (getrandom(&random, sizeof random, 0) != (ssize_t)sizeof random)
        return NULL;
    char *name = hewn_alloc(folder + 32, 1);
    if (name) {
        memcpy(name, target, folder);
        snprintf(name + folder, 32, ".hewn-%016llx.tmp", (unsigned long long)random);
    }
    return name;
}

static hewn_result open_temporary(hewn_output *output, const struct stat *existing, hewn_error *error)
{
    for (int attempt = 0; attempt < 16; attempt++) {
        output->temporary = temporary_name(output->target);
        if (!output->temporary)
            return out_of_memory(error, output->name);
        output->file = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (output->file >= 0) {
            output->owned = true;
            if (existing) /* as if the old file had been opened and emptied; not every file system has modes */
                (void)!fchmod(output->file, existing->st_mode & 0777);
            return HEWN_OK;
        }
        int code = errno;
        hewn_free(output->temporary);
        output->temporary = NULL;
        if (code != EEXIST)
            return system_failure(error, output->name, "cannot create a file in its folder", code);
    }
    return system_failure(error, output->name, "cannot create a file in its folder", EEXIST);
}

/* Devices and pipes are written in place: a rename would replace /dev/null by a file. */
static hewn_result open_in_place(hewn_output *output, hewn_error *error)
{
    output->file = open(output->name, O_WRONLY | O_CLOEXEC);
    if (output->file < 0)
        return system_failure(error, output->name, "cannot open for writing", errno);
    output->owned = true;
    return HEWN_OK;
}

static hewn_result open_output(hewn_output *output, const char *path, hewn_error *error)
{
    if (strcmp(path, "-") == 0) {
        fflush(stdout); /* what was printed before comes before */
        output->file = STDOUT_FILENO;
        return HEWN_OK;
    }
    size_t length = strlen(path);
    if (length == 0)
        return hewn_fail(error, HEWN_IO, "the output has an empty name");
    struct stat status;
    bool exists = stat(path, &status) == 0;
    if (!exists && errno != ENOENT)
        return system_failure(error, path, "cannot write", errno);
    if ((exists && S_ISDIR(status.st_mode)) || path[length - 1] == '/')
        return hewn_fail_at(error, HEWN_IO, path, 0, "cannot write: is a folder");
    if (exists && !S_ISREG(status.st_mode))
        return open_in_place(output, error);
    if (exists && faccessat(AT_FDCWD, path, W_OK, AT_EACCESS) != 0)
        return system_failure(error, path, "cannot write", errno);
    char *resolved = exists ? realpath(path, NULL) : NULL; /* write through a symbolic link, as a plain open would */
    output->target = hewn_strdup(resolved ? resolved : path);
    free(resolved);
    if (!output->target)
        return out_of_memory(error, path);
    return open_temporary(output, exists ? &status : NULL, error);
}

hewn_result hewn_output_create(const char *path, hewn_output **out, hewn_error *error)
{
    *out = NULL;
    hewn_output *output = hewn_alloc(1, sizeof *output);
    if (!output)
        return out_of_memory(error, path);
    output->file = -1;
    output->owned = false;
    output->target = output->temporary = NULL;
    output->used = 0;
    output->status = HEWN_OK;
    output->name = hewn_strdup(strcmp(path, "-") == 0 ? "standard output" : path);
    hewn_result result = output->name ? open_output(output, path, error) : out_of_memory(error, path);
    if (result != HEWN_OK) {
        hewn_output_destroy(&output);
        return result;
    }
    *out = output;
    return HEWN_OK;
}

bool hewn_file_put(int file, const void *bytes, size_t length)
{
    for (const char *at = bytes; length > 0;) {
        size_t part = length < ((size_t)1 << 30) ? length : (size_t)1 << 30;
        ssize_t put = write(file, at, part);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return false;
        at += put;
        length -= (size_t)put;
    }
    return true;
}

static hewn_result write_through(hewn_output *output, const char *bytes, size_t length, hewn_error *error)
{
    return hewn_file_put(output->file, bytes, length) ? HEWN_OK : fail_output(output, "cannot write", errno, error);
}

static hewn_result flush(hewn_output *output, hewn_error *error)
{
    size_t used = output->used;
    output->used = 0;
    return write_through(output, output->buffer, used, error);
}

hewn_result hewn_output_write(hewn_output *output, const void *bytes, size_t length, hewn_error *error)
{
    if (output->status != HEWN_OK)
        return repeat_failure(output, error);
    if (length == 0)
        return HEWN_OK;
    if (length > OUTPUT_BUFFER - output->used)
        HEWN_TRY(flush(output, error));
    if (length >= OUTPUT_BUFFER)
        return write_through(output, bytes, length, error);
    memcpy(output->buffer + output->used, bytes, length);
    output->used += length;
    return HEWN_OK;
}

const char *hewn_output_temporary(const hewn_output *output)
{
    return output->temporary;
}

hewn_result hewn_output_settle(hewn_output *output, hewn_error *error)
{
    if (output->status != HEWN_OK)
        return repeat_failure(output, error);
    HEWN_TRY(flush(output, error));
    if (output->owned) {
        int file = output->file;
        output->owned = false; /* closed now, whatever close says */
        if (close(file) != 0)
            return fail_output(output, "cannot write", errno, error);
    }
    return HEWN_OK;
}

static hewn_result finish(hewn_output *output, hewn_error *error)
{
    HEWN_TRY(hewn_output_settle(output, error));
    if (output->temporary) {
        if (rename(output->temporary, output->target) != 0)
            return fail_output(output, "cannot rename the finished file", errno, error);
        hewn_free(output->temporary);
        output->temporary = NULL;
    }
    return HEWN_OK;
}

hewn_result hewn_output_finish(hewn_output **output, hewn_error *error)
{
    hewn_result result = finish(*output, error);
    hewn_output_destroy(output);
    return result;
}

void hewn_output_destroy(hewn_output **output)
{
    hewn_output *old = *output;
    if (!old)
        return;
    if (old->owned)
        close(old->file);
    if (old->temporary)
        unlink(old->temporary);
    hewn_free(old->temporary);
    hewn_free(old->target);
    hewn_free(old->name);
    hewn_free(old);
    *output = NULL;
}
