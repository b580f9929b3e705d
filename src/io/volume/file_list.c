#include "io/volume/file_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* "%d", "%i" or "%u", perhaps with a width and zeroes before it, and no other percent sign: what printf() would do with
 * that and no more. */
static bool expand(hewn_word pattern, int64_t number, char *out, size_t room)
{
    const char *percent = memchr(pattern.begin, '%', (size_t)(pattern.end - pattern.begin));
    if (!percent)
        return false;
    const char *at = percent + 1;
    bool zeroes = at < pattern.end && *at == '0';
    int width = 0;
    for (; at < pattern.end && *at >= '0' && *at <= '9' && width < 100; at++)
        width = 10 * width + (*at - '0');
    if (at >= pattern.end || (*at != 'd' && *at != 'i' && *at != 'u') || width > 20 ||
        memchr(at + 1, '%', (size_t)(pattern.end - at - 1)))
        return false;
    int before = (int)(percent - pattern.begin), after = (int)(pattern.end - at - 1);
    int length =
        zeroes ? snprintf(out, room, "%.*s%0*lld%.*s", before, pattern.begin, width, (long long)number, after, at + 1)
               : snprintf(out, room, "%.*s%*lld%.*s", before, pattern.begin, width, (long long)number, after, at + 1);
    return length > 0 && (size_t)length < room;
}

/* The next line that is not empty, without blanks around it; empty at the end. */
static hewn_word next_line(const char **at, const char *end)
{
    while (*at < end && (hewn_is_line_end(**at) || hewn_is_blank(**at)))
        ++*at;
    hewn_word line = {*at, *at};
    while (line.end < end && !hewn_is_line_end(*line.end))
        line.end++;
    *at = line.end;
    while (line.end > line.begin && hewn_is_blank(line.end[-1]))
        line.end--;
    return line;
}

static bool parse_number(hewn_word word, int64_t *out)
{
    return hewn_word_integer(word, out) && llabs(*out) <= INT32_MAX;
}

bool hewn_file_list_pattern(hewn_word text, hewn_file_list *out)
{
    hewn_word words[4];
    int count = 0;
    int64_t last;
    for (const char *at = text.begin; at < text.end && count < 4; count++) {
        words[count].begin = at;
        while (at < text.end && !hewn_is_blank(*at))
            at++;
        words[count].end = at;
        while (at < text.end && hewn_is_blank(*at))
            at++;
    }
    if (count < 4 || !memchr(words[0].begin, '%', (size_t)(words[0].end - words[0].begin)) ||
        !parse_number(words[1], &out->next) || !parse_number(words[2], &last) || !parse_number(words[3], &out->step) ||
        out->step == 0)
        return false;
    out->pattern = words[0];
    out->count = (last - out->next) / out->step >= 0 ? (uint64_t)((last - out->next) / out->step) + 1 : 0;
    return true;
}

/* What a name in the list is, as a word that lives as long as `room` and the header. */
static hewn_result next_name(hewn_file_list *names, char *room, size_t room_size, hewn_word *out, hewn_error *error)
{
    if (names->lines) {
        *out = next_line(&names->lines, names->source->bytes + names->source->length);
        return HEWN_OK;
    }
    if (!expand(names->pattern, names->next, room, room_size))
        return hewn_fail_at(error, HEWN_BAD_INPUT, names->source->name, 0,
                            "the pattern of the files' names is not one with %%d");
    names->next += names->step;
    *out = (hewn_word){room, room + strlen(room)};
    return HEWN_OK;
}

hewn_result hewn_file_list_one(const hewn_volume_source *header, hewn_word name, hewn_file_part_read read,
                               const void *user, hewn_volume *volume, hewn_error *error)
{
    char *path;
    hewn_volume_source samples;
    hewn_volume_read_desc desc = *header->desc;
    HEWN_TRY(hewn_volume_path_beside(header, name.begin, (size_t)(name.end - name.begin), &path, error));
    desc.format = HEWN_VOLUME_RAW; /* what is packed there, the header says */
    hewn_result result = hewn_volume_source_open(path, &desc, &samples, error);
    if (result == HEWN_OK)
        result = read(&samples, user, volume, error);
    hewn_volume_source_close(&samples);
    hewn_free(path);
    return result;
}

/* Room grows with what files really hold. */
static hewn_result append(hewn_volume *volume, const hewn_volume *part, size_t *room, hewn_error *error)
{
    size_t bytes = part->dims[0] * hewn_voxel_size(part->type);
    HEWN_TRY(hewn_reserve(&volume->memory, room, volume->memory_length + bytes, 1, error));
    memcpy((char *)volume->memory + volume->memory_length, part->samples, bytes);
    volume->memory_length += bytes;
    return HEWN_OK;
}

hewn_result hewn_file_list_read(hewn_file_list *names, hewn_file_part_read read, const void *user, hewn_volume *volume,
                                hewn_error *error)
{
    const hewn_volume_source *source = names->source;
    size_t bytes, size = hewn_voxel_size(volume->type), room = 0;
    const char *at = names->lines, *end = source->bytes + source->length;
    for (hewn_word line; names->lines && (line = next_line(&at, end), line.begin < line.end);)
        names->count++;
    HEWN_TRY(hewn_volume_head_check(source, volume, &bytes, error));
    if (names->count == 0 || bytes / size % names->count != 0 || bytes / size / names->count > UINT32_MAX)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "%zu samples cannot be parted among %llu files",
                            bytes / size, (unsigned long long)names->count);
    if (bytes > hewn_volume_limit(source))
        return hewn_fail_at(error, HEWN_LIMIT, source->name, 0, "%zu bytes of samples are over the limit", bytes);
    for (uint64_t i = 0; i < names->count; i++) {
        char text[1024];
        hewn_word name;
        hewn_volume part = hewn_volume_blank();
        part.type = volume->type;
        part.dims[0] = (uint32_t)(bytes / size / names->count);
        HEWN_TRY(next_name(names, text, sizeof text, &name, error));
        hewn_result result = hewn_file_list_one(source, name, read, user, &part, error);
        if (result == HEWN_OK)
            result = append(volume, &part, &room, error);
        hewn_volume_destroy(&part);
        HEWN_TRY(result);
    }
    volume->samples = volume->memory;
    return HEWN_OK;
}
