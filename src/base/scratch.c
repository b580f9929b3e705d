#include "base/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"

struct hewn_scratch {
    char *folder;
    int file;
};

static hewn_result system_failure(hewn_error *error, const hewn_scratch *scratch, const char *what)
{
    char reason[128];
    const char *text = strerror_r(errno, reason, sizeof reason);
    return hewn_fail_at(error, HEWN_IO, scratch->folder, 0, "%s a temporary file: %s", what, text);
}

/* The folder of a path that is a file or will be one; else a place for large temporary files. */
static char *folder_of(const char *output)
{
    struct stat status;
    const char *given = getenv("TMPDIR");
    bool special = strcmp(output, "-") == 0 || (stat(output, &status) == 0 && !S_ISREG(status.st_mode));
    if (special)
        return hewn_strdup(given && given[0] ? given : "/var/tmp");
    const char *slash = strrchr(output, '/');
    char *folder = hewn_strdup(slash ? output : ".");
    if (folder && slash)
        folder[slash == output ? 1 : slash - output] = '\0';
    return folder;
}

/* A file without a name, where the file system has such; else one that loses its name at once. */
static int open_nameless(const char *folder)
{
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0)
        return file;
    char path[4096];
    if ((size_t)snprintf(path, sizeof path, "%s/.hewn-XXXXXX", folder) >= sizeof path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    file = mkostemp(path, O_CLOEXEC);
    if (file >= 0)
        unlink(path);
    return file;
}

hewn_result hewn_scratch_create(const char *output, hewn_scratch **out, hewn_error *error)
{
    *out = NULL;
    hewn_scratch *scratch = hewn_alloc_zero(1, sizeof *scratch);
    if (scratch) {
        scratch->file = -1;
        scratch->folder = folder_of(output);
    }
    if (!scratch || !scratch->folder) {
        hewn_scratch_destroy(&scratch);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for temporary files");
    }
    scratch->file = open_nameless(scratch->folder);
    if (scratch->file < 0) {
        hewn_result result = system_failure(error, scratch, "cannot make");
        hewn_scratch_destroy(&scratch);
        return result;
    }
    *out = scratch;
    return HEWN_OK;
}

void hewn_scratch_destroy(hewn_scratch **scratch_place)
{
    hewn_scratch *scratch = *scratch_place;
    if (!scratch)
        return;
    if (scratch->file >= 0)
        close(scratch->file);
    hewn_free(scratch->folder);
    hewn_free(scratch);
    *scratch_place = NULL;
}

hewn_result hewn_scratch_write(const hewn_scratch *scratch, const void *bytes, size_t length, uint64_t place,
                               hewn_error *error)
{
    const char *at = bytes;
    while (length > 0) {
        ssize_t written = pwrite(scratch->file, at, length < 1 << 30 ? length : 1 << 30, (off_t)place);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return system_failure(error, scratch, "cannot write");
        at += written;
        place += (uint64_t)written;
        length -= (size_t)written;
    }
    return HEWN_OK;
}

hewn_result hewn_scratch_read(const hewn_scratch *scratch, void *bytes, size_t length, uint64_t place,
                              hewn_error *error)
{
    char *at = bytes;
    while (length > 0) {
        ssize_t got = pread(scratch->file, at, length < 1 << 30 ? length : 1 << 30, (off_t)place);
        if (got < 0 && errno == EINTR)
            continue;
        if (got == 0)
            errno = EIO;
        if (got <= 0)
            return system_failure(error, scratch, "cannot read");
        at += got;
        place += (uint64_t)got;
        length -= (size_t)got;
    }
    return HEWN_OK;
}

hewn_result hewn_scratch_map(const hewn_scratch *scratch, size_t length, void **out, hewn_error *error)
{
    *out = NULL;
    if (length == 0)
        return HEWN_OK;
    void *view = mmap(NULL, length, PROT_READ, MAP_SHARED, scratch->file, 0);
    if (view == MAP_FAILED)
        return system_failure(error, scratch, "cannot read");
    *out = view;
    return HEWN_OK;
}
