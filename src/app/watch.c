#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "app/app.h"
#include "base/alloc.h"
#include "base/error.h"

/* Files are looked at by name a few times a second: that sees editors that write a new file and rename it, network
 * folders, and files that are missing for a moment, none of which a watch on the inode would. */

typedef struct stamp {
    bool exists;
    ino_t inode;
    off_t size;
    struct timespec modified;
} stamp;

typedef struct watched_file {
    char *path;
    stamp stamp;
} watched_file;

struct hewn_watch {
    watched_file *files;
    size_t count, capacity;
    struct timespec marked;
};

static stamp look(const char *path)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return (stamp){0};
    return (stamp){.exists = true, .inode = status.st_ino, .size = status.st_size, .modified = status.st_mtim};
}

static bool same_stamp(const stamp *a, const stamp *b)
{
    return a->exists == b->exists && a->inode == b->inode && a->size == b->size &&
           a->modified.tv_sec == b->modified.tv_sec && a->modified.tv_nsec == b->modified.tv_nsec;
}

hewn_result hewn_watch_create(hewn_watch **out, hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for watching");
    hewn_watch_mark(*out);
    return HEWN_OK;
}

void hewn_watch_destroy(hewn_watch **watch)
{
    if (!*watch)
        return;
    for (size_t i = 0; i < (*watch)->count; ++i)
        hewn_free((*watch)->files[i].path);
    hewn_free((*watch)->files);
    hewn_free(*watch);
    *watch = NULL;
}

void hewn_watch_mark(hewn_watch *watch)
{
    for (size_t i = 0; i < watch->count; ++i)
        watch->files[i].stamp = look(watch->files[i].path);
    clock_gettime(CLOCK_REALTIME, &watch->marked);
}

/* A file becomes known only after it was read, so a change in between shows as a time after the mark. Such a stamp is
 * spoilt, and the next look differs from it. File systems tick coarsely, hence the slack. */
static void spoil_if_recent(stamp *seen, const struct timespec *marked)
{
    double age =
        (double)(marked->tv_sec - seen->modified.tv_sec) + 1e-9 * (double)(marked->tv_nsec - seen->modified.tv_nsec);
    if (seen->exists && age < 0.02)
        seen->size = -1;
}

hewn_result hewn_watch_add(hewn_watch *watch, const char *path, hewn_error *error)
{
    for (size_t i = 0; i < watch->count; ++i)
        if (strcmp(watch->files[i].path, path) == 0)
            return HEWN_OK;
    void *items = watch->files;
    HEWN_TRY(hewn_reserve(&items, &watch->capacity, watch->count + 1, sizeof *watch->files, error));
    watch->files = items;
    watched_file file = {.path = hewn_strdup(path), .stamp = look(path)};
    if (!file.path)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for watching");
    spoil_if_recent(&file.stamp, &watch->marked);
    watch->files[watch->count++] = file;
    return HEWN_OK;
}

/* Whether a file that exists differs from its stamp. One that vanished is waited for. */
static bool changed(const hewn_watch *watch)
{
    for (size_t i = 0; i < watch->count; ++i) {
        stamp now = look(watch->files[i].path);
        if (now.exists && !same_stamp(&now, &watch->files[i].stamp))
            return true;
    }
    return false;
}

static void sleep_a_little(void)
{
    struct timespec pause = {.tv_nsec = 50 * 1000 * 1000};
    nanosleep(&pause, NULL); /* a signal ends it early, which is welcome */
}

hewn_result hewn_watch_wait(hewn_watch *watch, hewn_error *error)
{
    bool moving = false;
    while (!hewn_signals_cancelled()) {
        bool different = changed(watch);
        if (moving && !different)
            return HEWN_OK; /* changed before, and as it was at the last look */
        moving = different;
        if (different)
            hewn_watch_mark(watch);
        sleep_a_little();
    }
    return hewn_fail(error, HEWN_CANCELLED, "cancelled");
}
