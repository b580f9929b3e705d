#include "io/parts.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "io/unpack.h"

static hewn_format_read_parts reader_of(hewn_mesh_format format)
{
    switch (format) {
    case HEWN_MESH_OBJ: return hewn_obj_read_parts;
    case HEWN_MESH_PLY: return hewn_ply_read_parts;
    case HEWN_MESH_STL: return hewn_stl_read_parts;
    default: return NULL;
    }
}

bool hewn_mesh_format_has_parts(hewn_mesh_format format)
{
    return reader_of(format) != NULL;
}

bool hewn_mesh_format_welds(hewn_mesh_format format)
{
    return format == HEWN_MESH_STL;
}

/* A mapped file, whose pages are let go whenever the reader tells how far it is. */
typedef struct mapped_file {
    void *bytes;
    size_t length;
    const hewn_progress *caller;
} mapped_file;

static bool report(void *user, const char *stage, double fraction)
{
    const mapped_file *file = user;
    madvise(file->bytes, file->length, MADV_DONTNEED);
    return !file->caller || !file->caller->report || file->caller->report(file->caller->user, stage, fraction);
}

static hewn_result map(const char *path, mapped_file *out, hewn_error *error)
{
    struct stat status;
    char reason[128];
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0 || fstat(file, &status) != 0) {
        const char *text = strerror_r(errno, reason, sizeof reason);
        if (file >= 0)
            close(file);
        return hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "cannot open: %s", text);
    }
    out->length = S_ISREG(status.st_mode) ? (size_t)status.st_size : 0;
    out->bytes = out->length > 0 ? mmap(NULL, out->length, PROT_READ, MAP_PRIVATE, file, 0) : MAP_FAILED;
    const char *text = strerror_r(errno, reason, sizeof reason);
    close(file);
    if (out->bytes != MAP_FAILED)
        return HEWN_OK;
    out->bytes = NULL;
    if (!S_ISREG(status.st_mode))
        return hewn_fail_at(error, HEWN_LIMIT, path, 0, "only a regular file can be read in parts");
    return out->length == 0 ? hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "the file is empty")
                            : hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "cannot read: %s", text);
}

hewn_result hewn_model_read_parts(const char *path, const hewn_read_desc *desc, const hewn_part_taker *taker,
                                  hewn_model *about, hewn_error *error)
{
    const hewn_mesh_format format = desc->format != HEWN_MESH_UNKNOWN ? desc->format : hewn_mesh_format_of(path);
    const hewn_format_read_parts read = reader_of(format);
    mapped_file file = {.caller = desc->progress};
    const hewn_progress progress = {report, &file};
    *about = (hewn_model){0};
    if (!read)
        return hewn_fail_at(error, HEWN_LIMIT, path, 0, "a file of this format cannot be read in parts");
    HEWN_TRY(map(path, &file, error));
    const hewn_source source = {
        .bytes = file.bytes, .length = file.length, .name = path, .path = path, .progress = &progress};
    const hewn_result result =
        hewn_is_packed(file.bytes, file.length)
            ? hewn_fail_at(error, HEWN_LIMIT, path, 0, "a compressed file cannot be read in parts; unpack it first")
            : read(&source, taker, about, error);
    munmap(file.bytes, file.length);
    return result;
}
