#include "io/shim/module.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char here = 0;

/* Whether the file of this name, followed to where it really is, lies in the folder that Hewn was built in. */
static bool is_in_build(const char *path)
{
    char *real = realpath(path, NULL);
    bool inside = real && strncmp(real, HEWN_BUILD_FOLDER "/", strlen(HEWN_BUILD_FOLDER "/")) == 0;
    free(real);
    return inside;
}

/* The program, or the library that this code is in. */
static bool runs_from_build(void)
{
    Dl_info library;
    return is_in_build("/proc/self/exe") ||
           (dladdr(&here, &library) && library.dli_fname && is_in_build(library.dli_fname));
}

void hewn_module_path(const char *file, char *path, size_t room)
{
    snprintf(path, room, "%s/%s", runs_from_build() ? HEWN_BUILD_FOLDER "/src/io" : HEWN_MODULE_FOLDER, file);
}

const void *hewn_module_load(const char *name, char *message, size_t room)
{
    char file[64], path[4096];
    snprintf(file, sizeof file, "%s.so", name);
    hewn_module_path(file, path, sizeof path);
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE); /* the same one each time */
    const void *table = module ? dlsym(module, HEWN_MODULE_TABLE) : NULL;
    const char *reason = table ? NULL : dlerror();
    if (!table)
        snprintf(message, room, "what reads such files cannot be loaded: %s", reason ? reason : path);
    return table;
}
