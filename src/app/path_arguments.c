#include "app/path_arguments.h"

#include <string.h>
#include <unistd.h>

#include "base/error.h"

hewn_result hewn_input_argument_read(const hewn_arguments *arguments, const char **out, hewn_error *error)
{
    if (arguments->operand_count == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "which file? Give its name");
    if (arguments->operand_count > 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "one file at a time, please; '%s' is one too many",
                         arguments->operands[1]);
    *out = arguments->operands[0];
    return **out ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
}

hewn_result hewn_format_parse(const char *text, const char *option, hewn_mesh_format *out, hewn_error *error)
{
    *out = strpbrk(text, "./") ? HEWN_MESH_UNKNOWN : hewn_mesh_format_of(text);
    if (*out != HEWN_MESH_UNKNOWN)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is glb, gltf, obj, ply, stl, off or 3mf, not '%s'", option,
                     text);
}

hewn_result hewn_output_argument_read(const hewn_arguments *arguments, const char *what, const char *example,
                                      const char **output, hewn_error *error)
{
    *output = hewn_arguments_value(arguments, "output");
    if (!*output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "where should the %s go? Give -o %s", what, example);
    return (*output)[0] ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
}

hewn_result hewn_mesh_output_read(const hewn_arguments *arguments, const char **output, const char **report,
                                  hewn_mesh_format *format, hewn_error *error)
{
    const char *to = hewn_arguments_value(arguments, "to");
    HEWN_TRY(hewn_output_argument_read(arguments, "mesh", "FILE", output, error));
    *report = hewn_arguments_value(arguments, "report");
    if (*report && !(*report)[0])
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
    if (to)
        HEWN_TRY(hewn_format_parse(to, "--to", format, error));
    bool binary = *format == HEWN_MESH_PLY || *format == HEWN_MESH_STL;
    return binary ? hewn_output_spare_terminal(*output, to, error) : HEWN_OK;
}

hewn_result hewn_output_spare_terminal(const char *output, const char *what, hewn_error *error)
{
    if (strcmp(output, "-") != 0 || !isatty(STDOUT_FILENO))
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "standard output is a terminal, and %s is binary; send it to a file or a pipe", what);
}
