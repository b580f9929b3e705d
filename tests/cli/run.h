/* Running the real command, and looking at what it did. */
#ifndef HEWN_TESTS_CLI_RUN_H
#define HEWN_TESTS_CLI_RUN_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

#include <cmocka.h>

enum { RUN_MAX_ARGUMENTS = 32, RUN_MAX_CHANGES = 8 };

/* How to run it. Zero everywhere but `arguments` is the ordinary way. */
typedef struct run_desc {
    const char *program;                      /* another one than Hewn, found on PATH; NULL: Hewn */
    const char *arguments[RUN_MAX_ARGUMENTS]; /* after the command's name, up to a NULL */
    const char *folder;                       /* working folder */
    const char *input;                        /* file for standard input; NULL: empty */
    const char *output;                       /* file for standard output; NULL: captured */
    const char *changes[RUN_MAX_CHANGES];     /* to the environment: "NAME=value", or "NAME" to take it away */
    size_t file_limit;                        /* RLIMIT_FSIZE in bytes; 0: none */
    bool terminal;                            /* stderr is a terminal */
    double timeout;                           /* seconds; 0: 120 */
} run_desc;

/* A command that runs. */
typedef struct run_process {
    pid_t id;
    int out, err; /* files, or the terminal */
    bool terminal;
    double started;
    double timeout;
    char *seen; /* on the terminal, and not forgotten */
    size_t seen_length;
} run_process;

/* What became of it. `out` and `err` end with a NUL. */
typedef struct run_result {
    int code;   /* exit code; -1 where a signal ended it */
    int signal; /* that ended it, or 0 */
    double seconds;
    char *out, *err;
    size_t out_length;
} run_result;

run_process run_start(const run_desc *desc);

/* Waits until `text` was written to the terminal that stands for stderr, and forgets all up to its end; fails the test
 * after the timeout. */
void run_await(run_process *process, const char *text);

/* Whether it still runs. */
bool run_is_alive(run_process *process);

/* Waits for the end; fails the test after the timeout. */
run_result run_finish(run_process *process);

/* Both in one. */
run_result run(const run_desc *desc);
void run_result_destroy(run_result *result);

/* Runs, expects this exit code, and that the rest is as it should be: an error says something on stderr, and exactly
 * one line of it starts with "hewn". The caller destroys the result. */
run_result run_expecting(int code, const run_desc *desc);

/* A fresh folder under the system's one for temporary files, and its end with all that is in it. */
char *run_folder_create(void);
void run_folder_destroy(char *folder);

/* Makes a folder in a folder, unless it is there. */
void run_subfolder(const char *folder, const char *name);

/* How many entries a folder has, hidden ones too. */
int run_folder_count(const char *folder);

/* "folder/name" in one of a few static buffers. */
const char *run_path(const char *folder, const char *name);

void run_write_file(const char *path, const char *text);
bool run_file_exists(const char *path);

/* A whole file, with a NUL behind it; the caller frees it. Fails the test where it cannot be read. */
char *run_read_file(const char *path, size_t *length);

/* Fails the test unless both files have the same bytes, and more than a few. */
void run_assert_same_file(const char *a, const char *b);

/* Skips the test where there is no such program on PATH. */
void run_need_program(const char *program);

/* A file of the project ("assets/scenes/csg.lua"), and one of the test data; the latter skips the test if missing. */
const char *run_project_file(const char *name);
const char *run_data_file(const char *name);

/* Seconds of a steady clock, and waiting. */
double run_now(void);
void run_sleep(double seconds);

#endif
