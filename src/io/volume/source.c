#include "io/volume/source.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "base/progress.h"
#include "io/unpack.h"

static const uint64_t USUAL_LIMIT = (uint64_t)16 << 30;
enum { LEAST_MAPPED = 16 << 20 }; /* bytes; smaller files are read, and may then change or go away */

uint64_t hewn_volume_limit(const hewn_volume_source *source)
{
    return source->desc->memory_limit ? source->desc->memory_limit : USUAL_LIMIT;
}

/* Maps a large regular file; false, and nothing done, for all else. What cannot be opened is told by who reads it. */
static bool map(const char *path, hewn_volume_source *out)
{
    struct stat status;
    int file = strcmp(path, "-") == 0 ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return false;
    bool large = fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_size >= LEAST_MAPPED;
    void *block = large ? mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_PRIVATE, file, 0) : MAP_FAILED;
    if (block == MAP_FAILED) {
        close(file);
        return false;
    }
    out->memory = block;
    out->memory_length = (size_t)status.st_size;
    out->mapped = true;
    out->mapped_file = file;
    return true;
}

static void free_block(hewn_volume_source *source)
{
    if (source->mapped && source->memory)
        munmap(source->memory, source->memory_length);
    else
        hewn_free(source->memory);
    if (source->mapped_file > 0)
        close(source->mapped_file);
    source->mapped_file = 0;
}

void hewn_volume_source_close(hewn_volume_source *source)
{
    free_block(source);
    *source = (hewn_volume_source){0};
}

static hewn_result unpack(hewn_volume_source *source, hewn_error *error)
{
    char *unpacked;
    size_t length;
    if (!hewn_is_packed(source->memory, source->memory_length))
        return HEWN_OK;
    HEWN_TRY(hewn_unpack(source->memory, source->memory_length, hewn_volume_limit(source), source->name,
                         source->desc->progress, &unpacked, &length, error));
    free_block(source);
    source->memory = unpacked;
    source->memory_length = length;
    source->mapped = false;
    return HEWN_OK;
}

hewn_result hewn_volume_source_open(const char *path, const hewn_volume_read_desc *desc, hewn_volume_source *out,
                                    hewn_error *error)
{
    bool standard = strcmp(path, "-") == 0;
    *out =
        (hewn_volume_source){.name = standard ? "standard input" : path, .path = standard ? NULL : path, .desc = desc};
    HEWN_TRY(hewn_progress_report(desc->progress, "load", 0, error));
    if (!map(path, out))
        HEWN_TRY(hewn_file_read(path, SIZE_MAX / 4, &out->memory, &out->memory_length, error));
    /* A raw file may begin with anything. */
    size_t length = strlen(path);
    bool named = length > 3 && strcasecmp(path + length - 3, ".gz") == 0;
    hewn_result result = desc->format == HEWN_VOLUME_RAW && !named ? HEWN_OK : unpack(out, error);
    if (result != HEWN_OK)
        hewn_volume_source_close(out);
    out->bytes = out->memory;
    out->length = out->memory_length;
    return result;
}

/* Whether a name stays where it begins: relative, and no step up. */
static bool stays_below(const char *name)
{
    if (*name == '\0' || *name == '/')
        return false;
    for (const char *at = name; at; at = strchr(at, '/') ? strchr(at, '/') + 1 : NULL)
        if (strncmp(at, "..", 2) == 0 && (at[2] == '/' || at[2] == '\0'))
            return false;
    return true;
}

hewn_result hewn_volume_path_beside(const hewn_volume_source *header, const char *name, size_t length, char **out,
                                    hewn_error *error)
{
    *out = NULL;
    if (!header->path)
        return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0, "the samples are in a file of their own");
    const char *slash = strrchr(header->path, '/');
    size_t folder = slash ? (size_t)(slash - header->path) + 1 : 0;
    char *path = hewn_alloc(folder + length + 1, 1);
    if (!path)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, header->name, 0, "out of memory for a file's name");
    memcpy(path, header->path, folder);
    memcpy(path + folder, name, length);
    path[folder + length] = '\0';
    if (strlen(path + folder) != length || !stays_below(path + folder)) {
        hewn_free(path);
        return hewn_fail_at(error, HEWN_BAD_INPUT, header->name, 0,
                            "the name of the file with the samples leads out of the header's folder");
    }
    *out = path;
    return HEWN_OK;
}

hewn_volume hewn_volume_blank(void)
{
    hewn_volume volume = {.dims = {1, 1, 1}, .frame_count = 1, .slope = 1};
    for (int i = 0; i < 4; i++)
        volume.to_world[5 * i] = 1;
    return volume;
}

void hewn_volume_place(hewn_volume *volume, double columns[3][3], const double origin[3])
{
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            volume->to_world[4 * row + column] = columns[column][row];
        volume->to_world[4 * row + 3] = origin[row];
    }
}

void hewn_volume_turn_world(hewn_volume *volume, bool left, bool posterior)
{
    const bool turn[2] = {left, posterior};
    for (int i = 0; i < 8; i++) /* 0 - x: a zero stays what it is called */
        volume->to_world[i] = turn[i / 4] ? 0 - volume->to_world[i] : volume->to_world[i];
}

char *hewn_volume_text(const char *text, size_t length)
{
    while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\0'))
        length--;
    if (length == 0)
        return NULL;
    char *copy = hewn_alloc(length + 1, 1);
    for (size_t i = 0; copy && i < length; i++)
        copy[i] = (char)((unsigned char)text[i] < 0x20 || (unsigned char)text[i] >= 0x7f ? '?' : text[i]);
    if (copy)
        copy[length] = '\0';
    return copy;
}
