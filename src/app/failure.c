#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"

int hewn_exit_code(hewn_result result)
{
    switch (result) {
    case HEWN_OK: return 0;
    case HEWN_IO:
    case HEWN_LIMIT:
    case HEWN_INTERNAL: return 1;
    case HEWN_INVALID_ARGUMENT: return 2;
    case HEWN_BAD_INPUT: return 3;
    case HEWN_NO_LOADER:
    case HEWN_NO_DEVICE:
    case HEWN_MISSING_FEATURE:
    case HEWN_DEVICE_LOST: return 4;
    case HEWN_OUT_OF_DEVICE_MEMORY:
    case HEWN_OUT_OF_MEMORY: return 5;
    case HEWN_CANCELLED: return 130;
    }
    return 1;
}

int hewn_report_failure(const hewn_error *error)
{
    if (error->file[0] && error->line)
        fprintf(stderr, "hewn: %s:%u: %s\n", error->file, error->line, error->message);
    else if (error->file[0])
        fprintf(stderr, "hewn: %s: %s\n", error->file, error->message);
    else
        fprintf(stderr, "hewn: %s\n", error->message);
    return hewn_exit_code(error->code);
}

int hewn_report_misuse(const hewn_command *command, const hewn_error *error)
{
    const char *space = command ? " " : "", *name = command ? command->name : "";
    if (error->code != HEWN_INVALID_ARGUMENT)
        return hewn_report_failure(error);
    bool at_file = error->file[0] != '\0';
    fprintf(stderr, "hewn%s%s: %s%s%s\nTry 'hewn%s%s --help'.\n", space, name, error->file, at_file ? ": " : "",
            error->message, space, name);
    return hewn_exit_code(error->code);
}

int hewn_finish_output(int code)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return code;
    if (errno)
        fprintf(stderr, "hewn: standard output: cannot write: %s\n", strerror(errno));
    else
        fprintf(stderr, "hewn: standard output: cannot write\n");
    return code ? code : hewn_exit_code(HEWN_IO);
}
