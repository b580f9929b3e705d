#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "base/clock.h"
#include "base/error.h"

const hewn_command *const hewn_commands[] = {
    &hewn_command_mesh,   &hewn_command_info,      &hewn_command_check,    &hewn_command_repair, &hewn_command_convert,
    &hewn_command_smooth, &hewn_command_subdivide, &hewn_command_simplify, &hewn_command_lod,    &hewn_command_voxelize,
    &hewn_command_render, &hewn_command_atlas,     &hewn_command_eval,     &hewn_command_query,  &hewn_command_devices};
const size_t hewn_command_count = sizeof hewn_commands / sizeof *hewn_commands;

static double started;

double hewn_started(void)
{
    return started;
}

const hewn_command *hewn_command_find(const char *name)
{
    for (size_t i = 0; i < hewn_command_count; ++i)
        if (strcmp(hewn_commands[i]->name, name) == 0)
            return hewn_commands[i];
    return NULL;
}

static int fail_unknown_command(const char *word)
{
    const char *names[24] = {"help", "version"};
    size_t count = 2;
    for (size_t i = 0; i < hewn_command_count && count < 24; ++i)
        names[count++] = hewn_commands[i]->name;
    const char *nearest = hewn_nearest_name(word, names, count);
    hewn_error error = {0};
    if (word[0] == '-')
        hewn_fail(&error, HEWN_INVALID_ARGUMENT, "unknown option '%.64s'; options follow the command", word);
    else if (nearest)
        hewn_fail(&error, HEWN_INVALID_ARGUMENT, "unknown command '%.64s'; did you mean '%s'?", word, nearest);
    else
        hewn_fail(&error, HEWN_INVALID_ARGUMENT, "unknown command '%.64s'", word);
    return hewn_report_misuse(NULL, &error);
}

static bool asks_for_help(int argc, char **argv)
{
    for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; ++i)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
            return true;
    return false;
}

static int run_command(const hewn_command *command, int argc, char **argv)
{
    /* Before everything else, because who asks for help may well be in the middle of a wrong command line. */
    if (asks_for_help(argc, argv)) {
        hewn_help_print_command(command, stdout);
        return 0;
    }
    hewn_arguments arguments;
    hewn_error error = {0};
    if (hewn_arguments_parse(command->options, command->option_count, argc, argv, &arguments, &error) != HEWN_OK)
        return hewn_report_misuse(command, &error);
    int code = command->run(command, &arguments);
    hewn_arguments_destroy(&arguments);
    return code;
}

static int run_help(int argc, char **argv)
{
    if (argc == 0) {
        hewn_help_print(stdout);
        return 0;
    }
    const hewn_command *command = hewn_command_find(argv[0]);
    if (!command)
        return fail_unknown_command(argv[0]);
    hewn_help_print_command(command, stdout);
    return 0;
}

static int run(int argc, char **argv)
{
    if (argc < 2) {
        hewn_help_print(stderr);
        return hewn_exit_code(HEWN_INVALID_ARGUMENT);
    }
    const char *word = argv[1];
    if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0 || strcmp(word, "version") == 0) {
        printf("hewn %s\n", hewn_version());
        return 0;
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0)
        return run_help(argc - 2, argv + 2);
    const hewn_command *command = hewn_command_find(word);
    return command ? run_command(command, argc - 2, argv + 2) : fail_unknown_command(word);
}

int main(int argc, char **argv)
{
    started = hewn_clock_now();
    /* A reader that went away and a file over its limit are errors of write(), which are reported and cleaned up after;
     * dying of the signal would do neither. */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    return hewn_finish_output(run(argc, argv));
}
