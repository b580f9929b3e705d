#include "pipeline/spool.h"

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

enum { POSITIONS, NORMALS, INDICES, FILES, ITEM = 12 };

struct hewn_spool {
    char *folder;
    int files[FILES];
    void *views[FILES];
    size_t lengths[FILES];
};

static hewn_result system_failure(hewn_error *error, const hewn_spool *spool, const char *what)
{
    char reason[128];
    const char *text = strerror_r(errno, reason, sizeof reason);
    return hewn_fail_at(error, HEWN_IO, spool->folder, 0, "%s a temporary file: %s", what, text);
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

hewn_result hewn_spool_create(const char *output, hewn_spool **out, hewn_error *error)
{
    hewn_spool *spool = hewn_alloc_zero(1, sizeof *spool);
    *out = NULL;
    for (int i = 0; spool && i < FILES; i++)
        spool->files[i] = -1;
    if (spool)
        spool->folder = folder_of(output);
    if (!spool || !spool->folder) {
        hewn_spool_destroy(&spool);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for temporary files");
    }
    for (int i = 0; i < FILES; i++) {
        spool->files[i] = open_nameless(spool->folder);
        if (spool->files[i] < 0) {
            hewn_result result = system_failure(error, spool, "cannot make");
            hewn_spool_destroy(&spool);
            return result;
        }
    }
    *out = spool;
    return HEWN_OK;
}

void hewn_spool_destroy(hewn_spool **spool_place)
{
    hewn_spool *spool = *spool_place;
    if (!spool)
        return;
    for (int i = 0; i < FILES; i++) {
        if (spool->views[i])
            munmap(spool->views[i], spool->lengths[i]);
        if (spool->files[i] >= 0)
            close(spool->files[i]);
    }
    hewn_free(spool->folder);
    hewn_free(spool);
    *spool_place = NULL;
}

static hewn_result put(const hewn_spool *spool, int which, const void *items, uint64_t first, uint64_t count,
                       hewn_error *error)
{
    const char *at = items;
    uint64_t place = ITEM * first, left = ITEM * count;
    while (left > 0) {
        ssize_t written = pwrite(spool->files[which], at, left < 1 << 30 ? (size_t)left : 1 << 30, (off_t)place);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return system_failure(error, spool, "cannot write");
        at += written;
        place += (uint64_t)written;
        left -= (uint64_t)written;
    }
    return HEWN_OK;
}

hewn_result hewn_spool_take(hewn_spool *spool, const hewn_mesh_part *part, hewn_error *error)
{
    for (int i = 0; i < 2; i++) {
        const hewn_vertex_run *vertices = &part->vertices[i];
        const hewn_triangle_run *triangles = &part->triangles[i];
        HEWN_TRY(put(spool, POSITIONS, vertices->positions, vertices->first, vertices->count, error));
        HEWN_TRY(put(spool, NORMALS, vertices->normals, vertices->first, vertices->count, error));
        HEWN_TRY(put(spool, INDICES, triangles->indices, triangles->first, triangles->count, error));
    }
    return HEWN_OK;
}

static hewn_result map(hewn_spool *spool, int which, uint64_t count, hewn_error *error)
{
    size_t length = (size_t)(ITEM * count);
    if (length == 0)
        return HEWN_OK;
    void *view = mmap(NULL, length, PROT_READ, MAP_SHARED, spool->files[which], 0);
    if (view == MAP_FAILED)
        return system_failure(error, spool, "cannot read");
    spool->views[which] = view;
    spool->lengths[which] = length;
    return HEWN_OK;
}

hewn_result hewn_spool_view(hewn_spool *spool, uint64_t vertices, uint64_t triangles, hewn_triangles *out,
                            hewn_error *error)
{
    *out = (hewn_triangles){0};
    HEWN_TRY(map(spool, POSITIONS, vertices, error));
    HEWN_TRY(map(spool, NORMALS, vertices, error));
    HEWN_TRY(map(spool, INDICES, triangles, error));
    *out = (hewn_triangles){.vertex_count = vertices,
                            .triangle_count = triangles,
                            .positions = spool->views[POSITIONS],
                            .normals = spool->views[NORMALS],
                            .indices = spool->views[INDICES]};
    return HEWN_OK;
}

void hewn_spool_relax(hewn_spool *spool)
{
    for (int i = 0; i < FILES; i++)
        if (spool->views[i])
            madvise(spool->views[i], spool->lengths[i], MADV_DONTNEED);
}
