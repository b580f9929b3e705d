#include "pipeline/label_paths.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/text.h"
#include "pipeline/paths.h"

static bool is_folder(const char *path)
{
    struct stat status;
    size_t length = strlen(path);
    return (length > 0 && path[length - 1] == '/') || (stat(path, &status) == 0 && S_ISDIR(status.st_mode));
}

static bool has_place(const char *path)
{
    return strstr(path, "{label}") || strstr(path, "{name}");
}

static hewn_result check_complex(const hewn_label_job_desc *desc, hewn_label_target target, hewn_mesh_format format,
                                 hewn_error *error)
{
    if (!desc->complex)
        return HEWN_OK;
    if (target != HEWN_LABELS_TOGETHER)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--complex writes one mesh; name one file");
    if (format != HEWN_MESH_PLY)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--complex needs PLY, the only format that keeps two labels a face");
    return HEWN_OK;
}

hewn_result hewn_label_target_find(const hewn_label_job_desc *desc, hewn_label_target *out, hewn_mesh_format *format,
                                   hewn_error *error)
{
    *out = is_folder(desc->output)   ? HEWN_LABELS_FOLDER
           : has_place(desc->output) ? HEWN_LABELS_PATTERN
                                     : HEWN_LABELS_TOGETHER;
    if (*out == HEWN_LABELS_FOLDER && has_place(desc->output))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "{label} and {name} stand for files, but '%s' is a folder",
                         desc->output);
    const char *slash = strrchr(desc->output, '/'), *place = strchr(desc->output, '{');
    if (*out == HEWN_LABELS_PATTERN && slash && place && place < slash && has_place(place) &&
        (!has_place(slash) || strstr(desc->output, "}") < slash))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "{label} and {name} may stand in names of files only, not of folders");
    if (*out == HEWN_LABELS_FOLDER)
        *format = desc->to != HEWN_MESH_UNKNOWN ? desc->to : HEWN_MESH_STL;
    else
        HEWN_TRY(hewn_output_format(desc->output, desc->to, format, error));
    if (*format == HEWN_MESH_GLTF)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "glTF as text (.gltf) can be read only; .glb can be written");
    return check_complex(desc, *out, *format, error);
}

/* A name as part of a file's: no slashes, nothing that shells and other systems choke on, no dot at the front. */
static void append_name(hewn_text *text, const char *name)
{
    for (const char *at = name; *at; at++) {
        bool bad =
            (unsigned char)*at < 0x20 || *at == 0x7f || strchr("/\\:*?\"<>|{}", *at) || (at == name && *at == '.');
        hewn_text_append_bytes(text, bad ? "_" : at, 1);
    }
}

static void append_pattern(hewn_text *text, const char *pattern, const hewn_label_fact *label)
{
    for (const char *at = pattern; *at;) {
        if (strncmp(at, "{label}", 7) == 0) {
            hewn_text_print(text, "%" PRId64, label->label);
            at += 7;
        } else if (strncmp(at, "{name}", 6) == 0) {
            append_name(text, label->name);
            at += 6;
        } else {
            hewn_text_append_bytes(text, at++, 1);
        }
    }
}

static int compare_paths(const void *a, const void *b)
{
    return strcmp((*(const hewn_label_fact *const *)a)->path, (*(const hewn_label_fact *const *)b)->path);
}

static hewn_result check_different(hewn_label_fact *labels, uint32_t count, hewn_error *error)
{
    hewn_label_fact **sorted = hewn_alloc(count, sizeof(hewn_label_fact *));
    if (!sorted)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the names of files");
    for (uint32_t n = 0; n < count; n++)
        sorted[n] = &labels[n];
    qsort(sorted, count, sizeof *sorted, compare_paths);
    hewn_result result = HEWN_OK;
    for (uint32_t n = 1; n < count && result == HEWN_OK; n++)
        if (strcmp(sorted[n - 1]->path, sorted[n]->path) == 0)
            result = hewn_fail(error, HEWN_INVALID_ARGUMENT,
                               "labels %" PRId64 " and %" PRId64 " would both be written to %s; {label} in the name "
                               "keeps them apart",
                               sorted[n - 1]->label, sorted[n]->label, sorted[n]->path);
    hewn_free(sorted);
    return result;
}

hewn_result hewn_label_paths_find(const hewn_label_job_desc *desc, hewn_label_target target, hewn_mesh_format format,
                                  hewn_label_fact *labels, uint32_t count, hewn_error *error)
{
    if (target == HEWN_LABELS_TOGETHER)
        return HEWN_OK;
    for (uint32_t n = 0; n < count; n++) {
        hewn_text text = {0};
        if (target == HEWN_LABELS_PATTERN) {
            append_pattern(&text, desc->output, &labels[n]);
        } else {
            size_t length = strlen(desc->output);
            hewn_text_print(&text, "%s%s", desc->output, desc->output[length - 1] == '/' ? "" : "/");
            append_name(&text, labels[n].name);
            hewn_text_print(&text, ".%s", hewn_mesh_format_name(format));
        }
        HEWN_TRY(hewn_text_status(&text, error));
        labels[n].path = text.bytes;
    }
    return check_different(labels, count, error);
}

hewn_result hewn_label_folder_make(const hewn_label_job_desc *desc, hewn_label_target target, bool *made,
                                   hewn_error *error)
{
    *made = false;
    if (target != HEWN_LABELS_FOLDER)
        return HEWN_OK;
    if (mkdir(desc->output, 0777) == 0)
        *made = true;
    else if (errno != EEXIST)
        return hewn_fail_at(error, HEWN_IO, desc->output, 0, "the folder cannot be made: %s", strerror(errno));
    return HEWN_OK;
}
