/* What the commands that write a mesh file have in common: `convert` and all that do something to the mesh on its way.
 */
#ifndef HEWN_SRC_APP_FILE_COMMAND_H
#define HEWN_SRC_APP_FILE_COMMAND_H

#include "app/app.h"
#include "hewn/file_job.h"

/* Room for the steps that a job may point to. */
typedef struct hewn_file_steps {
    hewn_repair_desc repair;
    hewn_file_smooth smooth;
    hewn_file_subdivide subdivide;
    hewn_simplify_desc simplify;
} hewn_file_steps;

/* What is a command's own. `read` takes its options and points `desc` to those `steps` that it filled in;
 * HEWN_INVALID_ARGUMENT. `print` tells on standard error what its steps did. */
typedef struct hewn_file_command {
    hewn_result (*read)(const hewn_arguments *arguments, hewn_file_steps *steps, hewn_file_job_desc *desc,
                        hewn_error *error);
    void (*print)(const hewn_file_job_desc *desc, const hewn_file_report *report);
} hewn_file_command;

/* Reads the arguments, runs the job and prints what was done, unless quiet. Returns the exit code. */
int hewn_file_command_run(const hewn_command *command, const hewn_arguments *arguments, const hewn_file_command *own);

#endif
