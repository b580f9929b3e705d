#include "app/number_lines.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/app.h"
#include "base/alloc.h"
#include "base/error.h"

enum { LONGEST = 4096 };

struct hewn_number_lines {
    int file; /* below 0: none */
    char buffer[1 << 16];
    size_t used, filled;
    const char *name; /* for messages */
    const char *what;
    uint32_t width;
    uint32_t line;
    uint32_t *places; /* the line of each row of the last part */
    size_t place_capacity;
    char text[LONGEST + 2];
};

hewn_result hewn_number_lines_open(const char *path, uint32_t width, const char *what, hewn_number_lines **out,
                                   hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a file");
    bool standard = strcmp(path, "-") == 0;
    (*out)->name = standard ? "standard input" : path;
    (*out)->what = what;
    (*out)->width = width;
    (*out)->file = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    struct stat status;
    hewn_result result = HEWN_OK;
    if ((*out)->file < 0)
        result = hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "cannot open: %s", strerror(errno));
    else if (fstat((*out)->file, &status) == 0 && S_ISDIR(status.st_mode))
        result = hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "it is a folder");
    if (result != HEWN_OK)
        hewn_number_lines_close(out);
    return result;
}

void hewn_number_lines_close(hewn_number_lines **lines)
{
    if (*lines && (*lines)->file >= 0 && (*lines)->file != STDIN_FILENO)
        close((*lines)->file);
    if (*lines)
        hewn_free((*lines)->places);
    hewn_free(*lines);
    *lines = NULL;
}

static hewn_result refuse(const hewn_number_lines *lines, const char *format, const char *word, hewn_error *error)
{
    char why[160];
    snprintf(why, sizeof why, format, word);
    return hewn_fail_at(error, HEWN_BAD_INPUT, lines->name, lines->line, "%s; %s", why, lines->what);
}

/* Reads on; a pipe through which nothing comes keeps nobody who wants to stop. `*more` is false at the end. */
static hewn_result fill(hewn_number_lines *lines, bool *more, hewn_error *error)
{
    struct pollfd wait = {.fd = lines->file, .events = POLLIN};
    int ready;
    do {
        ready = poll(&wait, 1, 50);
        if (hewn_signals_cancelled())
            return hewn_fail(error, HEWN_CANCELLED, "cancelled reading %s", lines->name);
    } while (ready == 0 || (ready < 0 && errno == EINTR));
    ssize_t got;
    do
        got = read(lines->file, lines->buffer, sizeof lines->buffer);
    while (got < 0 && errno == EINTR);
    if (got < 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, lines->name, 0, "cannot read: %s", strerror(errno));
    lines->used = 0;
    lines->filled = (size_t)got;
    *more = got > 0;
    return HEWN_OK;
}

/* A line without its end; *length is negative where the file has none left. */
static hewn_result next_line(hewn_number_lines *lines, long *length, hewn_error *error)
{
    long count = 0;
    bool more = true;
    lines->line++;
    for (;;) {
        if (lines->used == lines->filled)
            HEWN_TRY(fill(lines, &more, error));
        if (!more || lines->buffer[lines->used] == '\n')
            break;
        if (count == LONGEST)
            return refuse(lines, "the line is longer than 4,096 characters%s", "", error);
        lines->text[count++] = lines->buffer[lines->used++];
    }
    lines->used += more;
    lines->text[count] = '\0';
    *length = !more && count == 0 ? -1 : count;
    return HEWN_OK;
}

static hewn_result read_row(const hewn_number_lines *lines, double *row, uint32_t *count, hewn_error *error)
{
    static const char between[] = " \t\r,;";
    *count = 0;
    for (const char *at = lines->text + strspn(lines->text, between); *at && *at != '#'; at += strspn(at, between)) {
        char word[52], *end;
        size_t length = strcspn(at, " \t\r,;#");
        double value = strtod(at, &end);
        if (strspn(at, "0123456789+-.eE") != length || end != at + length || !isfinite(value)) {
            snprintf(word, sizeof word, length < 48 ? "%.*s" : "%.*s...", (int)(length < 48 ? length : 48), at);
            return refuse(lines, "'%s' is not a finite number", word, error);
        }
        if (*count < lines->width)
            row[*count] = value;
        ++*count;
        at += length;
    }
    return HEWN_OK;
}

hewn_result hewn_number_lines_read(hewn_number_lines *lines, double *rows, size_t most, size_t *count,
                                   hewn_error *error)
{
    *count = 0;
    HEWN_TRY(hewn_reserve((void **)&lines->places, &lines->place_capacity, most, sizeof *lines->places, error));
    while (*count < most) {
        long length = -1;
        uint32_t found;
        HEWN_TRY(next_line(lines, &length, error));
        if (length < 0)
            return HEWN_OK;
        if (strlen(lines->text) != (size_t)length)
            return refuse(lines, "the line has a zero byte%s", "", error);
        HEWN_TRY(read_row(lines, rows + *count * lines->width, &found, error));
        if (found == 0)
            continue;
        char number[16];
        snprintf(number, sizeof number, "%u", found);
        if (found != lines->width)
            return refuse(lines, "the line has %s numbers", number, error);
        lines->places[*count] = lines->line;
        ++*count;
    }
    return HEWN_OK;
}

hewn_result hewn_number_lines_refuse(const hewn_number_lines *lines, size_t index, const char *why, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, lines->name, lines->places[index], "%s; %s", why, lines->what);
}
