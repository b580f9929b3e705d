/* The bytes of a volume file: mapped, read or unpacked; and the samples that a reader makes of them. */
#ifndef HEWN_SRC_IO_VOLUME_SOURCE_H
#define HEWN_SRC_IO_VOLUME_SOURCE_H

#include "hewn/volume_io.h"

/* A whole file in memory, already unpacked. */
typedef struct hewn_volume_source {
    const char *bytes;
    size_t length;
    const char *name; /* for messages */
    const char *path; /* where other files are looked for; NULL: nowhere */
    const hewn_volume_read_desc *desc;
    /* What holds the bytes. Whoever leaves samples there takes it over and puts NULL here; where it is NULL to begin
     * with, samples are copied. */
    char *memory;
    size_t memory_length;
    bool mapped;
    int mapped_file; /* above 0: the bytes are those of this open file */
    int room_file;   /* above 0: samples get their room in this file, mapped from HEWN_VOLUME_ROOM_AT on, not on the
                        heap */
} hewn_volume_source;

/* A page in, so that samples are aligned and what is before them is mapped apart. */
enum { HEWN_VOLUME_ROOM_AT = 4096 };

/* Makes a volume of a source; `*out` is zero after an error. Readers fill in what the header says, call
 * hewn_volume_head_check(), and get samples then. */
typedef hewn_result (*hewn_volume_format_read)(hewn_volume_source *source, hewn_volume *out, hewn_error *error);

/* Opens a file, "-" is standard input: large ones that are not compressed are mapped. `path` and `desc` must outlive
 * it. HEWN_IO, HEWN_BAD_INPUT, HEWN_LIMIT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_volume_source_open(const char *path, const hewn_volume_read_desc *desc, hewn_volume_source *out,
                                    hewn_error *error);
void hewn_volume_source_close(hewn_volume_source *source);

/* The path of a file that a header names, to be freed by the caller. It must lie in the header's folder or in one
 * below: a header from elsewhere has no business with other files of this machine. HEWN_BAD_INPUT, HEWN_OUT_OF_MEMORY.
 */
hewn_result hewn_volume_path_beside(const hewn_volume_source *header, const char *name, size_t length, char **out,
                                    hewn_error *error);

/* Bytes of heap that samples may take. */
uint64_t hewn_volume_limit(const hewn_volume_source *source);

/* hewn_volume_check(), with the file's name in its error; `*bytes` (or NULL) is what all samples take. */
hewn_result hewn_volume_head_check(const hewn_volume_source *source, const hewn_volume *volume, size_t *bytes,
                                   hewn_error *error);

/* Room on the heap, or in the source's file, for all samples of a checked head, which the volume then owns;
 * `volume->memory` is to be filled. Callers have made sure that the file can hold that many. HEWN_LIMIT,
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_volume_make_room(const hewn_volume_source *source, hewn_volume *volume, hewn_error *error);

/* Room for so many bytes in the same way, for a volume in blocks, which are to be made in `volume->memory`. */
hewn_result hewn_volume_make_blocks_room(const hewn_volume_source *source, uint64_t bytes, hewn_volume *volume,
                                         hewn_error *error);

/* The samples of a checked head stand in the source as they are, from `offset` on: left there where that can be, else
 * copied. HEWN_BAD_INPUT where there are fewer bytes than the head tells. */
hewn_result hewn_volume_take_samples(hewn_volume_source *source, uint64_t offset, bool big_endian, hewn_volume *volume,
                                     hewn_error *error);

/* Likewise samples that a packing hides (io/unpack.h), `skip` bytes into what comes out. */
hewn_result hewn_volume_unpack_samples(const hewn_volume_source *source, uint64_t offset, int packing, uint64_t skip,
                                       bool big_endian, hewn_volume *volume, hewn_error *error);

/* Numbers as text, between blanks, line ends and commas, from `offset` on. */
hewn_result hewn_volume_parse_samples(const hewn_volume_source *source, uint64_t offset, hewn_volume *volume,
                                      hewn_error *error);

/* Turns bytes of the other order around, `count` samples of `size` bytes. */
void hewn_swap_samples(void *samples, size_t count, size_t size);

/* One axis of the samples as they lie in a file, fastest first. */
typedef struct hewn_file_axis {
    uint64_t size;
    int axis; /* 0 to 2: of space; -1: frames */
} hewn_file_axis;

/* Brings samples whose axes lie in another order into the volume's: copies them unless they lie so already. Several
 * axes of frames count together, the first one fastest. HEWN_OUT_OF_MEMORY, HEWN_LIMIT. */
hewn_result hewn_volume_reorder(const hewn_volume_source *source, const hewn_file_axis *axes, size_t axis_count,
                                hewn_volume *volume, hewn_error *error);

/* Sets to_world: voxel (i, j, k) is at origin + i columns[0] + j columns[1] + k columns[2]. */
void hewn_volume_place(hewn_volume *volume, double columns[3][3], const double origin[3]);

/* Turns a world whose +x is the patient's left, or whose +y is the back, into RAS. */
void hewn_volume_turn_world(hewn_volume *volume, bool left, bool posterior);

/* A head for which a file has said nothing yet: one frame, one voxel along each axis, values as samples, spacing 1. */
hewn_volume hewn_volume_blank(void);

/* A copy of text as a name: printable, without what could steer a terminal; NULL for none, and when out of memory. */
char *hewn_volume_text(const char *text, size_t length);

#endif
