/* `hewn info` of a volume file. */
#ifndef HEWN_SRC_APP_VOLUME_INFO_H
#define HEWN_SRC_APP_VOLUME_INFO_H

#include "app/volume_arguments.h"

/* Reads a volume, `-` from standard input, and prints what is in it to standard output. */
hewn_result hewn_volume_tell(const char *path, const hewn_volume_arguments *wanted, bool json, hewn_error *error);

#endif
