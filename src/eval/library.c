#include "eval/library.h"

#include <string.h>

#include "base/error.h"

extern const unsigned char hewn_text_point[], hewn_text_noise_point[], hewn_text_outline_point[], hewn_text_interval[],
    hewn_text_noise_interval[], hewn_text_gradient[], hewn_text_noise_gradient[], hewn_text_sampled_point[],
    hewn_text_sampled_interval[], hewn_text_sampled_gradient[], hewn_text_outline_table_point[],
    hewn_text_outline_table_interval[], hewn_text_outline_table_gradient[];

static const char marker[] = "\n//: ";

/* The files that a text is made of, NULL after the last. */
enum { FILES_MAX = 6 };

static const char *file_of(hewn_library_text which, int file)
{
    static const unsigned char *const files[HEWN_LIBRARY_TEXTS][FILES_MAX] = {
        [HEWN_LIBRARY_POINT] = {hewn_text_point, hewn_text_noise_point, hewn_text_outline_point,
                                hewn_text_sampled_point, hewn_text_outline_table_point},
        [HEWN_LIBRARY_INTERVAL] = {hewn_text_interval, hewn_text_noise_interval, hewn_text_sampled_interval,
                                   hewn_text_outline_table_interval},
        [HEWN_LIBRARY_GRADIENT] = {hewn_text_gradient, hewn_text_noise_gradient, hewn_text_sampled_gradient,
                                   hewn_text_outline_table_gradient}};
    return (const char *)files[which][file];
}

/* The index of a name, HEWN_LIBRARY_NAMES_MAX if it is not there. */
static size_t find(const hewn_library *library, const char *name, size_t length)
{
    for (size_t i = 0; i < library->count; i++)
        if (library->names[i].length == length && memcmp(library->names[i].name, name, length) == 0)
            return i;
    return HEWN_LIBRARY_NAMES_MAX;
}

static size_t intern(hewn_library *library, const char *name, size_t length)
{
    size_t at = find(library, name, length);
    if (at == HEWN_LIBRARY_NAMES_MAX && library->count < HEWN_LIBRARY_NAMES_MAX) {
        at = library->count++;
        library->names[at].name = name;
        library->names[at].length = length;
        library->names[at].needs = 0;
    }
    return at;
}

/* One marker line, after its colon: the block's own name, then those it needs. */
static bool read_marker(hewn_library *library, const char *line)
{
    size_t own = HEWN_LIBRARY_NAMES_MAX;
    while (*line && *line != '\n') {
        size_t length = strcspn(line, " \n");
        size_t at = intern(library, line, length);
        if (at == HEWN_LIBRARY_NAMES_MAX)
            return false;
        if (own == HEWN_LIBRARY_NAMES_MAX)
            own = at;
        library->names[own].needs |= (uint64_t)1 << at;
        line += length;
        line += strspn(line, " ");
    }
    return true;
}

hewn_result hewn_library_read(hewn_library *out, hewn_error *error)
{
    memset(out, 0, sizeof *out);
    for (int which = 0; which < HEWN_LIBRARY_TEXTS; which++)
        for (int file = 0; file_of((hewn_library_text)which, file); file++)
            for (const char *at = strstr(file_of((hewn_library_text)which, file), marker); at;
                 at = strstr(at + 1, marker))
                if (!read_marker(out, at + strlen(marker)))
                    return hewn_fail(error, HEWN_INTERNAL, "the shader library has more than %d blocks",
                                     HEWN_LIBRARY_NAMES_MAX);
    return HEWN_OK;
}

hewn_result hewn_library_choose(const hewn_library *library, const char *name, hewn_library_choice *choice,
                                hewn_error *error)
{
    size_t own = find(library, name, strlen(name));
    if (own == HEWN_LIBRARY_NAMES_MAX)
        return hewn_fail(error, HEWN_INTERNAL, "the shader library has no block '%s'", name);
    uint64_t bits = choice->bits | (uint64_t)1 << own, before = 0;
    while (bits != before) {
        before = bits;
        for (size_t i = 0; i < library->count; i++)
            if (bits >> i & 1)
                bits |= library->names[i].needs;
    }
    choice->bits = bits;
    return HEWN_OK;
}

static void write_file(const hewn_library *library, hewn_library_choice choice, const char *file, hewn_text *text)
{
    const char *at = strstr(file, marker);
    while (at) {
        const char *name = at + strlen(marker), *end = strstr(name, marker);
        size_t own = find(library, name, strcspn(name, " \n"));
        const char *block = strchr(name, '\n');
        if (block && own < HEWN_LIBRARY_NAMES_MAX && choice.bits >> own & 1)
            hewn_text_append_bytes(text, block, end ? (size_t)(end - block) : strlen(block));
        at = end;
    }
}

void hewn_library_write(const hewn_library *library, hewn_library_choice choice, hewn_library_text which,
                        hewn_text *text)
{
    for (int file = 0; file_of(which, file); file++)
        write_file(library, choice, file_of(which, file), text);
}
