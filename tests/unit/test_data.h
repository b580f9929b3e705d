/* Where the test data lie: in HEWN_DATA, or else beside the project. Tests that need it skip where it is absent. */
#ifndef HEWN_TEST_DATA_H
#define HEWN_TEST_DATA_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* The folder, or NULL where there is none. */
static inline const char *data_folder(char path[4096])
{
    const char *given = getenv("HEWN_DATA"), *source = getenv("HEWN_SOURCE");
    bool own = given && *given;
    snprintf(path, 4096, "%s%s", own ? given : source ? source : ".", own ? "" : "/../shared/data");
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode) ? path : NULL;
}

/* Whether a file of them is at hand; its path in any case. */
static inline bool data_file(char path[8192], const char *name)
{
    char folder[4096];
    const char *found = data_folder(folder);
    snprintf(path, 8192, "%s/%s", folder, name);
    return found && access(path, R_OK) == 0;
}

#endif
