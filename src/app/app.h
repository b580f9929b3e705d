/* What the commands of `hewn` share. */
#ifndef HEWN_SRC_APP_APP_H
#define HEWN_SRC_APP_APP_H

#include "app/options.h"
#include "hewn/hewn.h"

/* One command: `hewn NAME ...`. */
typedef struct hewn_command {
    const char *name;
    const char *summary; /* one line for the list of commands */
    const char *usage;   /* its operands and options in short, after "hewn NAME " */
    const char *about;   /* a paragraph or two, with line breaks */
    const hewn_option *options;
    size_t option_count;
    const char *after; /* what follows the options: an example */
    /* Returns the exit code. */
    int (*run)(const struct hewn_command *command, const hewn_arguments *arguments);
} hewn_command;

extern const hewn_command hewn_command_mesh, hewn_command_info, hewn_command_check, hewn_command_repair,
    hewn_command_convert, hewn_command_smooth, hewn_command_subdivide, hewn_command_simplify, hewn_command_lod,
    hewn_command_voxelize, hewn_command_render, hewn_command_atlas, hewn_command_eval, hewn_command_query,
    hewn_command_devices;
extern const hewn_command *const hewn_commands[];
extern const size_t hewn_command_count;

/* The command of that name, or NULL. */
const hewn_command *hewn_command_find(const char *name);

/* When main() started, on hewn_clock_now()'s clock. */
double hewn_started(void);

/* --- help.c ------------------------------------------------------------------------------------------------------ */

void hewn_help_print(FILE *file);
void hewn_help_print_command(const hewn_command *command, FILE *file);

/* --- failure.c --------------------------------------------------------------------------------------------------- */

/* The exit code of a result: the only place that decides it. 0 done, 1 failed, 2 usage, 3 bad input, 4 device, 5 out of
 * memory, 130 cancelled. */
int hewn_exit_code(hewn_result result);

/* That of a mesh that is not what was required of it: a failure like others. */
enum { HEWN_EXIT_UNMET = 1 };

/* Says on stderr what failed, as "hewn: file:line: message", and returns the exit code. */
int hewn_report_failure(const hewn_error *error);

/* The same for a mistake in the command line, and says where help is. `command` may be NULL. */
int hewn_report_misuse(const hewn_command *command, const hewn_error *error);

/* Flushes standard output; the exit code of the whole run, given what it would be if that works. */
int hewn_finish_output(int code);

/* --- progress.c -------------------------------------------------------------------------------------------------- */

/* From now on the first Ctrl-C (or SIGTERM, SIGHUP) asks for the end, and the second one ends the process. */
void hewn_signals_catch(void);

/* From now on, until this is taken back, such a signal ends the process right away: nothing has been written that would
 * have to be cleaned up, but for the file `remove` (or NULL). Not in a stage of progress that is called "write". */
void hewn_signals_end_at_once(bool may, const char *remove);

/* Whether the end was asked for. */
bool hewn_signals_cancelled(void);

/* Progress for the library: cancels after a signal, and draws one line on stderr where that is a terminal and `quiet`
 * is false. */
hewn_progress hewn_progress_begin(bool quiet);

/* Takes the line away. */
void hewn_progress_end(void);

/* --- watch.c ----------------------------------------------------------------------------------------------------- */

/* The state of a set of files, to see when one of them changes. */
typedef struct hewn_watch hewn_watch;

hewn_result hewn_watch_create(hewn_watch **out, hewn_error *error);
void hewn_watch_destroy(hewn_watch **watch);

/* Call when the files are about to be read: changes count from now on. */
void hewn_watch_mark(hewn_watch *watch);

/* Adds a file, unless it is watched already. */
hewn_result hewn_watch_add(hewn_watch *watch, const char *path, hewn_error *error);

/* Returns once a file has changed since the mark and stands still again; HEWN_CANCELLED after a signal. */
hewn_result hewn_watch_wait(hewn_watch *watch, hewn_error *error);

#endif
