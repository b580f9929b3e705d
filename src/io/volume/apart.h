/* Readers over libraries that end the process on bad data, by assertions or worse, run in a process of their own: what
 * becomes of that, this one goes on and can say so. It is a program (apart_main.c) and not a copy of this process: a
 * copy would have the locks that other threads hold just then, and nobody to open them. */
#ifndef HEWN_SRC_IO_VOLUME_APART_H
#define HEWN_SRC_IO_VOLUME_APART_H

#include "io/volume/source.h"

/* The program, which lies where modules do. */
#define HEWN_APART_PROGRAM "hewn-volume-reader"

typedef enum hewn_apart_reader { HEWN_APART_VDB, HEWN_APART_DICOM, HEWN_APART_DICOM_FOLDER } hewn_apart_reader;

/* Its arguments, after the version of Hewn, which must be its own. Numbers are decimal. */
enum {
    HEWN_APART_VERSION = 1,
    HEWN_APART_READER,
    HEWN_APART_NAME,   /* of the file or folder */
    HEWN_APART_LIMIT,  /* memory_limit of the description */
    HEWN_APART_BLOCKS, /* 1 or 0 */
    HEWN_APART_REPLY,  /* file descriptors: where the reply goes, */
    HEWN_APART_INPUT,  /* and of the bytes to be read, plus 1: 0 for a folder, which has none */
    HEWN_APART_CHOICE, /* the grid or the series; it may be missing */
    HEWN_APART_ARGUMENTS
};

/* Exit codes but 0, with which a reply was written. */
enum { HEWN_APART_NO_REPLY = 1, HEWN_APART_OTHER_VERSION = 2 };

/* What is to be read, and by what. */
typedef struct hewn_apart {
    hewn_apart_reader reader;
    const hewn_volume_source *source; /* NULL for a folder, whose path is the name */
    const char *name;                 /* for messages */
    const hewn_volume_read_desc *desc;
    const char *choice; /* or NULL */
} hewn_apart;

/* What is sent back, at the beginning of a file; samples follow it at HEWN_VOLUME_ROOM_AT. */
typedef struct hewn_apart_reply {
    hewn_result result;
    hewn_error error;
    hewn_volume volume; /* its pointers mean nothing in the other process */
    uint64_t sample_bytes;
    bool blocks;                 /* the samples are in blocks */
    char name[256], remark[256]; /* empty: none */
    char unit[16];               /* likewise */
} hewn_apart_reply;
_Static_assert(sizeof(hewn_apart_reply) <= HEWN_VOLUME_ROOM_AT, "samples begin after the reply");

/* Reads apart. The samples are then in memory that both processes shared, and count as mapped. The other process may
 * take twice the description's memory limit, four times the file and 64 MiB more; it gets no progress callback, which
 * is called from here while it works. HEWN_BAD_INPUT where it did not live to tell; HEWN_MISSING_FEATURE where the
 * program cannot be run; HEWN_IO where nothing came back; and what the reader returns. */
hewn_result hewn_volume_read_apart(const hewn_apart *job, hewn_volume *out, hewn_error *error);

#endif
