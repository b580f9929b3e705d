/* Shared by the tests of mesh files: reading from memory, comparing models, and walking through the test data. */
#ifndef HEWN_TEST_IO_SUPPORT_H
#define HEWN_TEST_IO_SUPPORT_H

#include <unistd.h>

#include "base/file.h"
#include "io/formats.h"
#include "test_model_support.h"

/* From a block of exactly its size, so that a sanitizer sees any step past it. */
static inline hewn_result read_exact(hewn_format_read read, const void *bytes, size_t length, hewn_model *out,
                                     hewn_error *error)
{
    char *copy = hewn_alloc(length, 1);
    assert_non_null(copy);
    memcpy(copy, bytes, length);
    const hewn_source source = {.bytes = copy, .length = length, .name = "given"};
    hewn_result result = read(&source, out, error);
    hewn_free(copy);
    return result;
}

static inline hewn_model read_bytes(hewn_format_read read, const void *bytes, size_t length)
{
    hewn_model model = {0};
    hewn_error error = {0};
    if (read_exact(read, bytes, length, &model, &error) != HEWN_OK)
        fail_msg("line %u: %s", error.line, error.message);
    if (hewn_model_check(&model, &error) != HEWN_OK)
        fail_msg("a reader made a bad model: %s", error.message);
    return model;
}

static inline hewn_model read_text(hewn_format_read read, const char *text)
{
    return read_bytes(read, text, strlen(text));
}

/* Fails as bad input at this line (0: any), with a message that says `part`. */
static inline void assert_bad(hewn_format_read read, const void *bytes, size_t length, uint32_t line, const char *part)
{
    hewn_model model = {.vertex_count = 1};
    hewn_error error = {0};
    hewn_result result = read_exact(read, bytes, length, &model, &error);
    if (result != HEWN_BAD_INPUT || !strstr(error.message, part) || (line && error.line != line))
        fail_msg("result %d, line %u (not %u): \"%s\" (not \"%s\")", result, error.line, line, error.message, part);
    assert_string_equal(error.file, "given");
    const hewn_model nothing = {0};
    assert_memory_equal(&model, &nothing, sizeof model);
    assert_int_equal(read_exact(read, bytes, length, &model, NULL), HEWN_BAD_INPUT);
}

static inline void assert_bad_text(hewn_format_read read, const char *text, uint32_t line, const char *part)
{
    assert_bad(read, text, strlen(text), line, part);
}

static inline uint64_t first_of(const hewn_model *model, uint64_t face)
{
    return model->first ? model->first[face] : 3 * face;
}

static inline void assert_same_channel(const hewn_model *a, const hewn_channel *channel, const hewn_model *b)
{
    const hewn_channel *other = hewn_model_find_channel(b, channel->info.domain, channel->info.name);
    if (!other)
        fail_msg("no channel \"%s\"", channel->info.name);
    assert_int_equal(channel->info.scalar, other->info.scalar);
    assert_int_equal(channel->info.components, other->info.components);
    if (channel_bytes(a, channel) > 0)
        assert_memory_equal(channel->values, other->values, channel_bytes(a, channel));
    assert_int_equal(channel->name_count, other->name_count);
    for (uint32_t i = 0; i < channel->name_count; i++)
        assert_string_equal(channel->names[i], other->names[i]);
}

/* Polygons, bits of positions and of every channel, names. */
static inline void assert_same_model(const hewn_model *a, const hewn_model *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    for (uint64_t face = 0; face <= a->face_count; face++)
        assert_int_equal(first_of(a, face), first_of(b, face));
    if (a->vertex_count > 0)
        assert_memory_equal(a->positions, b->positions, a->vertex_count * 3 * sizeof(double));
    if (a->face_count > 0)
        assert_memory_equal(a->corners, b->corners, hewn_model_corner_count(a) * sizeof(uint32_t));
    assert_ptr_equal(a->unit, b->unit);
    assert_int_equal(a->up_known, b->up_known);
    assert_int_equal(a->up, b->up);
    assert_int_equal(a->channel_count, b->channel_count);
    for (uint32_t i = 0; i < a->channel_count; i++)
        assert_same_channel(a, &a->channels[i], b);
}

static inline hewn_model read_model(const char *path)
{
    hewn_model model = {0};
    hewn_error error = {0};
    if (hewn_model_read(path, NULL, &model, &error) != HEWN_OK)
        fail_msg("%s, line %u: %s", path, error.line, error.message);
    return model;
}

static inline void write_model(const hewn_model *model, const char *path, const hewn_write_desc *desc)
{
    hewn_error error = {0};
    if (hewn_model_write(model, path, desc, &error) != HEWN_OK)
        fail_msg("%s: %s", path, error.message);
}

/* What a model is after it was written to a file of this extension and read again. */
static inline hewn_model through_file(const hewn_model *model, const char *extension)
{
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/model.%s", folder, extension);
    write_model(model, path, NULL);
    hewn_model read = read_model(path);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
    return read;
}

/* The text of a model as a file of this extension, with a NUL after it; to be freed. */
static inline char *written_text(const hewn_model *model, const char *extension)
{
    char folder[64], path[96], *bytes = NULL;
    size_t length = 0;
    make_folder(folder);
    snprintf(path, sizeof path, "%s/model.%s", folder, extension);
    write_model(model, path, NULL);
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
    return bytes;
}

/* The number after " key" in a line of statistics, or -1. */
static inline long long statistic(const char *line, const char *key)
{
    for (const char *at = line; (at = strstr(at, key)) != NULL; at++)
        if (at > line && at[-1] == ' ')
            return strtoll(at + strlen(key), NULL, 10);
    return -1;
}

/* One file of the test data, by its path, and what another program counted in it. */
typedef void (*check_file)(const char *path, const char *statistics);

/* Calls for every file of these folders and this extension that STATS.txt counts vertices of. Returns how many, or -1
 * where there is no test data. */
static inline int for_each_statistic(const char *const *folders, size_t folder_count, const char *extension,
                                     check_file check)
{
    char data[4096], path[4400], line[1024], file[256];
    int checked = 0;
    FILE *stats = NULL;
    if (data_folder(data)) {
        snprintf(path, sizeof path, "%s/STATS.txt", data);
        stats = fopen(path, "r");
    }
    if (!stats)
        return -1;
    while (fgets(line, sizeof line, stats)) {
        bool wanted = false;
        for (char *tab = line; (tab = strchr(tab, '\t')) != NULL;)
            *tab = ' ';
        const char *dot = sscanf(line, "%255s", file) == 1 ? strrchr(file, '.') : NULL;
        for (size_t i = 0; i < folder_count; i++)
            wanted = wanted || (strncmp(file, folders[i], strlen(folders[i])) == 0 && file[strlen(folders[i])] == '/');
        if (!wanted || !dot || strcmp(dot + 1, extension) != 0 || statistic(line, "V=") < 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", data, file);
        check(path, line);
        checked++;
    }
    fclose(stats);
    return checked;
}

#endif
