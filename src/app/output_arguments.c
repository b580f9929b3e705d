#include "app/output_arguments.h"

#include <string.h>
#include <unistd.h>

#include "app/file_arguments.h"
#include "base/error.h"

hewn_result hewn_output_arguments_read(const hewn_arguments *arguments, const char *what, const char *example,
                                       const char **output, hewn_error *error)
{
    *output = hewn_arguments_value(arguments, "output");
    if (!*output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "where should the %s go? Give -o %s", what, example);
    return (*output)[0] ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
}

hewn_result hewn_output_arguments_read_mesh(const hewn_arguments *arguments, const char **output, const char **report,
                                            hewn_mesh_format *format, hewn_error *error)
{
    const char *to = hewn_arguments_value(arguments, "to");
    HEWN_TRY(hewn_output_arguments_read(arguments, "mesh", "FILE", output, error));
    *report = hewn_arguments_value(arguments, "report");
    if (*report && !(*report)[0])
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
    if (to)
        HEWN_TRY(hewn_format_parse(to, "--to", format, error));
    bool binary = *format == HEWN_MESH_PLY || *format == HEWN_MESH_STL;
    return binary ? hewn_output_arguments_spare_terminal(*output, to, error) : HEWN_OK;
}

hewn_result hewn_output_arguments_spare_terminal(const char *output, const char *what, hewn_error *error)
{
    if (strcmp(output, "-") != 0 || !isatty(STDOUT_FILENO))
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "standard output is a terminal, and %s is binary; send it to a file or a pipe", what);
}
