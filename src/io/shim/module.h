/* Shims over libraries that take long to load, as OpenVDB does, are modules of their own: they are loaded when the
 * first file needs them, and Hewn starts as fast without as with them. */
#ifndef HEWN_SRC_IO_SHIM_MODULE_H
#define HEWN_SRC_IO_SHIM_MODULE_H

#include <stddef.h>

/* Under this name a module has its table of functions. */
#define HEWN_MODULE_TABLE "hewn_module_table"

/* The path of a file that lies where modules do ("hewn_vdb.so"): in the build folder where this code runs from there,
 * else where Hewn is installed. */
void hewn_module_path(const char *file, char *path, size_t room);

/* The table of functions of a module ("hewn_vdb"). It stays loaded. NULL where it cannot be, with a message of at most
 * `room` bytes. Safe from several threads at once. */
const void *hewn_module_load(const char *name, char *message, size_t room);

#endif
