#include <stdio.h>
#include <string.h>

#include "app/app.h"

static const char exit_codes[] = "Exit codes:\n"
                                 "  0 done   1 failed   2 usage   3 bad input   4 device   5 out of memory\n"
                                 "  130 cancelled\n";

void hewn_help_print(FILE *file)
{
    fprintf(file, "Usage: hewn COMMAND [OPTION]...\n"
                  "\n"
                  "Turns implicit shapes into meshes that can be trusted.\n"
                  "\n"
                  "Commands:\n");
    for (size_t i = 0; i < hewn_command_count; ++i)
        fprintf(file, "  %-9s  %s\n", hewn_commands[i]->name, hewn_commands[i]->summary);
    fprintf(file,
            "  %-9s  %s\n"
            "  %-9s  %s\n"
            "\n"
            "Options:\n"
            "  -h, --help     print this help; after a command, that command's\n"
            "  -V, --version  print the version\n"
            "\n"
            "Environment:\n"
            "  HEWN_DEVICE      the device to use where --device is not given\n"
            "  HEWN_VALIDATION  1 turns Vulkan's validation layer on; any message of it makes\n"
            "                   the command fail at the end, with exit code 4\n"
            "\n"
            "%s\n"
            "Example:\n"
            "  hewn mesh assets/scenes/bracket.lua -o bracket.glb\n",
            "help", "print the help of a command", "version", "print the version", exit_codes);
}

void hewn_help_print_command(const hewn_command *command, FILE *file)
{
    fprintf(file, "Usage: hewn %s %s\n\n%s\nOptions:\n", command->name, command->usage, command->about);
    hewn_options_print(command->options, command->option_count, file);
    fprintf(file, "\n%s\n%s", exit_codes, command->after);
}
