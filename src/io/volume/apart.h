/* Readers over libraries that end the process on bad data, by assertions or worse, run in a process of their own: what
 * becomes of that, this one goes on and can say so. */
#ifndef HEWN_SRC_IO_VOLUME_APART_H
#define HEWN_SRC_IO_VOLUME_APART_H

#include "io/volume/source.h"

/* What is to be read, and by what. Runs in the other process; `out` and `error` come back from there. */
typedef struct hewn_apart {
    hewn_result (*read)(const struct hewn_apart *job, const hewn_volume_read_desc *desc, hewn_volume *out,
                        hewn_error *error);
    hewn_volume_source *source; /* as `read` wants: a file in memory, */
    const char *path;           /* or a folder */
    const char *name;           /* for messages */
    const hewn_volume_read_desc *desc;
} hewn_apart;

/* Reads apart. The samples are then in memory that both processes shared, and count as mapped. The other process may
 * take the description's memory limit and 1 GiB more; it gets no progress callback, which is called from here while it
 * works. HEWN_BAD_INPUT where it did not live to tell; HEWN_IO where it cannot be made; and what `read` returns. */
hewn_result hewn_volume_read_apart(const hewn_apart *job, hewn_volume *out, hewn_error *error);

#endif
