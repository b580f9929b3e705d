#include "gpu/cache.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"

enum { PATH_BYTES = 4096 };

static const uint64_t default_limit = 256u << 20;

/* Starts every file. The check covers the key, so that a file under a wrong name is no hit. */
typedef struct file_header {
    char magic[8];
    uint64_t length;
    hewn_hash check;
} file_header;

static const char magic[8] = {'H', 'E', 'W', 'N', 'k', 'e', 'p', '1'};

hewn_result hewn_cache_open(hewn_cache *cache, hewn_error *error)
{
    *cache = (hewn_cache){.limit = default_limit};
    const char *home = secure_getenv("XDG_CACHE_HOME");
    const char *below = "/hewn";
    /* The base directory specification has relative paths ignored. */
    if (!home || home[0] != '/') {
        home = secure_getenv("HOME");
        below = "/.cache/hewn";
    }
    if (!home || home[0] != '/')
        return HEWN_OK;
    size_t bytes = strlen(home) + strlen(below) + 1;
    cache->root = hewn_alloc(bytes, 1);
    if (!cache->root)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory naming the cache folder");
    snprintf(cache->root, bytes, "%s%s", home, below);
    return HEWN_OK;
}

void hewn_cache_close(hewn_cache *cache)
{
    hewn_free(cache->root);
    *cache = (hewn_cache){0};
}

static bool print_path(const hewn_cache *cache, const char *folder, hewn_hash key, char out[PATH_BYTES])
{
    char name[33];
    hewn_hash_print(key, name);
    int length = snprintf(out, PATH_BYTES, "%s/%s/%s", cache->root, folder, name);
    return length > 0 && length < PATH_BYTES - 16; /* room for a temporary name */
}

static file_header make_header(hewn_hash key, const void *bytes, size_t length)
{
    file_header header = {.length = length};
    memcpy(header.magic, magic, sizeof magic);
    header.check = hewn_hash_bytes(hewn_hash_bytes(hewn_hash_begin(), &key, sizeof key), bytes, length);
    return header;
}

static bool read_all(int file, void *bytes, size_t length)
{
    char *at = bytes;
    while (length > 0) {
        ssize_t got = read(file, at, length);
        if (got <= 0)
            return false;
        at += got;
        length -= (size_t)got;
    }
    return true;
}

static void *read_entry(const hewn_cache *cache, int file, hewn_hash key, size_t *length)
{
    struct stat about;
    file_header header;
    if (fstat(file, &about) != 0 || !S_ISREG(about.st_mode) || !read_all(file, &header, sizeof header))
        return NULL;
    if (memcmp(header.magic, magic, sizeof magic) != 0 || header.length > cache->limit ||
        (uint64_t)about.st_size != sizeof header + header.length)
        return NULL;
    void *bytes = hewn_alloc(header.length, 1);
    if (!bytes)
        return NULL;
    if (read_all(file, bytes, header.length)) {
        file_header right = make_header(key, bytes, header.length);
        if (memcmp(&right.check, &header.check, sizeof right.check) == 0) {
            *length = header.length;
            return bytes;
        }
    }
    hewn_free(bytes);
    return NULL;
}

void *hewn_cache_load(const hewn_cache *cache, const char *folder, hewn_hash key, size_t *length)
{
    char path[PATH_BYTES];
    *length = 0;
    if (!cache->root || !print_path(cache, folder, key, path))
        return NULL;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0)
        return NULL;
    void *bytes = read_entry(cache, file, key, length);
    /* A hit counts as use: the trimming below takes the oldest modification time first. */
    if (bytes)
        (void)!futimens(file, NULL);
    close(file);
    return bytes;
}

/* Makes every missing folder on the way to `path`. */
static void make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        (void)!mkdir(path, 0700);
        *slash = '/';
    }
}

typedef struct kept_file {
    char name[64];
    uint64_t size;
    struct timespec used;
} kept_file;

static int older_first(const void *left, const void *right)
{
    const kept_file *a = left, *b = right;
    if (a->used.tv_sec != b->used.tv_sec)
        return a->used.tv_sec < b->used.tv_sec ? -1 : 1;
    if (a->used.tv_nsec != b->used.tv_nsec)
        return a->used.tv_nsec < b->used.tv_nsec ? -1 : 1;
    return strcmp(a->name, b->name);
}

/* Lists the folder's files; returns the sum of their sizes. Also what a killed writer left behind is counted. */
static uint64_t list_files(DIR *folder, kept_file **files, size_t *count)
{
    uint64_t total = 0;
    size_t capacity = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        struct stat about;
        if (strlen(entry->d_name) >= sizeof(*files)->name ||
            fstatat(dirfd(folder), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(about.st_mode))
            continue;
        void *items = *files;
        if (hewn_reserve(&items, &capacity, *count + 1, sizeof **files, NULL) != HEWN_OK)
            break;
        *files = items;
        kept_file *file = &(*files)[(*count)++];
        memcpy(file->name, entry->d_name, strlen(entry->d_name) + 1);
        file->size = (uint64_t)about.st_size;
        file->used = about.st_mtim;
        total += file->size;
    }
    return total;
}

static void trim(const hewn_cache *cache, const char *folder)
{
    char path[PATH_BYTES];
    if (snprintf(path, sizeof path, "%s/%s", cache->root, folder) >= (int)sizeof path)
        return;
    DIR *listing = opendir(path);
    if (!listing)
        return;
    kept_file *files = NULL;
    size_t count = 0;
    uint64_t total = list_files(listing, &files, &count);
    if (total > cache->limit) {
        qsort(files, count, sizeof *files, older_first);
        for (size_t i = 0; i < count && total > cache->limit; i++) {
            unlinkat(dirfd(listing), files[i].name, 0);
            total -= files[i].size;
        }
    }
    hewn_free(files);
    closedir(listing);
}

void hewn_cache_store(const hewn_cache *cache, const char *folder, hewn_hash key, const void *bytes, size_t length)
{
    char path[PATH_BYTES], temporary[PATH_BYTES + 16];
    if (!cache->root || length > cache->limit / 2 || !print_path(cache, folder, key, path))
        return;
    make_folders(path);
    snprintf(temporary, sizeof temporary, "%s.tmpXXXXXX", path);
    int file = mkostemp(temporary, O_CLOEXEC);
    if (file < 0)
        return;
    file_header header = make_header(key, bytes, length);
    bool whole = hewn_file_put(file, &header, sizeof header) && hewn_file_put(file, bytes, length);
    whole = close(file) == 0 && whole;
    if (!whole || rename(temporary, path) != 0)
        unlink(temporary);
    else
        trim(cache, folder);
}
