/* Samples that a header leaves to other files: one, or several whose samples follow each other. */
#ifndef HEWN_SRC_IO_VOLUME_FILE_LIST_H
#define HEWN_SRC_IO_VOLUME_FILE_LIST_H

#include "io/scan.h"
#include "io/volume/source.h"

/* The names of several files, in order. */
typedef struct hewn_file_list {
    const hewn_volume_source *source; /* the header */
    const char *lines;                /* in it, up to its end: a name each; NULL: */
    hewn_word pattern;                /* "slice%03d.raw", with numbers from `next` on */
    int64_t next, step;
    uint64_t count; /* of files; found by hewn_file_list_read() where there are lines */
} hewn_file_list;

/* Reads the samples of one file, or of its share of the volume. */
typedef hewn_result (*hewn_file_part_read)(hewn_volume_source *source, const void *user, hewn_volume *volume,
                                           hewn_error *error);

/* Takes "PATTERN MIN MAX STEP" apart; false for all else. */
bool hewn_file_list_pattern(hewn_word text, hewn_file_list *out);

/* Opens the file beside the header and reads from it; its bytes are taken as they are, packed or not. */
hewn_result hewn_file_list_one(const hewn_volume_source *header, hewn_word name, hewn_file_part_read read,
                               const void *user, hewn_volume *volume, hewn_error *error);

/* Fills a checked head from all files, an equal part from each. */
hewn_result hewn_file_list_read(hewn_file_list *names, hewn_file_part_read read, const void *user, hewn_volume *volume,
                                hewn_error *error);

#endif
