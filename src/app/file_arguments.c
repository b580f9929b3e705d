#include "app/file_arguments.h"

#include <string.h>

#include "app/path_arguments.h"
#include "base/error.h"

static hewn_result read_unit(const hewn_arguments *arguments, const char *name, const hewn_unit **out,
                             hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, name);
    if (!text)
        return HEWN_OK;
    *out = hewn_unit_find(text);
    if (*out)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s is one of %s, not '%s'", name, hewn_unit_names(), text);
}

/* "+Z", and what people write for it: "Z", "z", "+z". */
static hewn_result read_axis(const hewn_arguments *arguments, const char *name, hewn_axis *axis, const hewn_axis **out,
                             hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, name);
    if (!text)
        return HEWN_OK;
    const char *letter = text[0] == '+' ? text + 1 : text;
    char proper[] = {'+', (char)(letter[0] & ~0x20), '\0'};
    *out = axis;
    if (strlen(letter) == 1 && hewn_axis_find(proper, axis))
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s is +X, +Y or +Z, not '%s'", name, text);
}

hewn_result hewn_file_arguments_read(const hewn_arguments *arguments, hewn_file_arguments *out, hewn_error *error)
{
    *out = (hewn_file_arguments){0};
    hewn_file_job_desc *desc = &out->desc;
    const char *from = hewn_arguments_value(arguments, "from");
    HEWN_TRY(hewn_input_argument_read(arguments, &desc->input, error));
    if (from)
        HEWN_TRY(hewn_format_parse(from, "--from", &desc->from, error));
    HEWN_TRY(hewn_mesh_output_read(arguments, &desc->output, &desc->report, &desc->to, error));
    HEWN_TRY(read_unit(arguments, "unit", &desc->unit, error));
    HEWN_TRY(read_axis(arguments, "up", &out->up, &desc->up, error));
    HEWN_TRY(read_unit(arguments, "to-unit", &desc->to_unit, error));
    HEWN_TRY(read_axis(arguments, "to-up", &out->to_up, &desc->to_up, error));
    out->quiet = hewn_arguments_has(arguments, "quiet");
    return HEWN_OK;
}
