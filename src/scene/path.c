#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/utf8.h"
#include "scene/scene.h"

/* How much of a path is its folder, the last slash included; 0 where it has none. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

char *hewn_path_real(const char *path)
{
    char *found = realpath(path, NULL); /* from the C library's heap, so it is copied to ours */
    if (!found)
        return NULL;
    char *copy = hewn_strdup(found);
    free(found);
    return copy;
}

char *hewn_path_real_folder(const char *path)
{
    size_t length = folder_length(path);
    if (length == 0)
        return hewn_path_real(".");
    char *folder = hewn_alloc(length + 1, 1);
    if (!folder)
        return NULL;
    memcpy(folder, path, length);
    folder[length] = '\0';
    char *real = hewn_path_real(folder);
    hewn_free(folder);
    return real;
}

char *hewn_path_beside(const char *from, const char *name)
{
    if (name[0] == '/')
        return hewn_strdup(name);
    while (strncmp(name, "./", 2) == 0)
        name += 2;
    size_t folder = folder_length(from), length = strlen(name);
    char *path = hewn_alloc(folder + length + 1, 1);
    if (!path)
        return NULL;
    memcpy(path, from, folder);
    memcpy(path + folder, name, length + 1);
    return path;
}

bool hewn_path_is_inside(const char *path, const char *folder)
{
    size_t length = strlen(folder);
    if (length > 0 && folder[length - 1] == '/')
        length--; /* the file system's root */
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

void hewn_text_clean(char *out, size_t capacity, const char *text, size_t length)
{
    size_t used = 0;
    for (size_t i = 0; i < length;) {
        uint32_t value = 0;
        size_t size = hewn_utf8_next(text + i, length - i, &value);
        /* The controls of ASCII and Latin-1: a message must not drive a terminal. */
        bool control = size > 0 && (value < 0x20 || (value >= 0x7F && value < 0xA0));
        size_t put = size == 0 || control ? 1 : size;
        if (used + put + 1 > capacity)
            break;
        if (size == 0 || control)
            out[used] = size == 0 ? '?' : ' ';
        else
            memcpy(out + used, text + i, size);
        used += put;
        i += size == 0 ? 1 : size;
    }
    if (capacity > 0)
        out[used] = '\0';
}
