/* Volume files in. */
#ifndef HEWN_VOLUME_IO_H
#define HEWN_VOLUME_IO_H

#include "hewn/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_volume_format {
    HEWN_VOLUME_UNKNOWN = 0,
    HEWN_VOLUME_NIFTI,     /* .nii, .hdr with .img; NIfTI-1, NIfTI-2, ANALYZE 7.5 */
    HEWN_VOLUME_NRRD,      /* .nrrd, .nhdr with its data elsewhere */
    HEWN_VOLUME_METAIMAGE, /* .mha, .mhd with its data elsewhere */
    HEWN_VOLUME_RAW,       /* nothing but samples */
    HEWN_VOLUME_NPY,       /* NumPy's arrays */
    HEWN_VOLUME_INR,       /* INRIMAGE-4 */
    HEWN_VOLUME_TIFF,      /* a page a slice */
    HEWN_VOLUME_VDB,       /* OpenVDB's grids of scalars */
    HEWN_VOLUME_DICOM      /* a folder of slices, or one file */
} hewn_volume_format;

/* The format that a file's extension names (any case; one ".gz" after it is passed over), or HEWN_VOLUME_UNKNOWN. */
HEWN_API hewn_volume_format hewn_volume_format_of(const char *path_or_extension);

/* The format of a file, by its extension or else by how it begins; a folder is DICOM. HEWN_VOLUME_UNKNOWN also for what
 * cannot be opened. */
HEWN_API hewn_volume_format hewn_volume_format_of_file(const char *path);

/* "nifti", "nrrd", "metaimage", "raw", "npy", "inr", "tiff", "vdb", "dicom"; NULL for HEWN_VOLUME_UNKNOWN. */
HEWN_API const char *hewn_volume_format_name(hewn_volume_format format);
HEWN_API bool hewn_volume_format_find(const char *name, hewn_volume_format *out);

/* What raw files do not say. */
typedef struct hewn_raw_desc {
    uint32_t dims[3];
    uint64_t frame_count; /* 0: 1 */
    hewn_voxel type;
    double spacing[3]; /* all 0: 1 */
    bool big_endian;
    uint64_t offset; /* bytes before the first sample */
} hewn_raw_desc;

/* Zero is the default. */
typedef struct hewn_volume_read_desc {
    hewn_volume_format format;     /* HEWN_VOLUME_UNKNOWN: from the file; needed for "-", standard input */
    hewn_raw_desc raw;             /* for HEWN_VOLUME_RAW */
    const char *grid;              /* of a .vdb, by name; NULL: its first grid of scalars */
    const char *series;            /* of a DICOM folder, by its UID; NULL: the only one */
    bool blocks;                   /* a .vdb's samples may stay in blocks (hewn_volume.blocks); else it is made dense */
    uint64_t memory_limit;         /* bytes of heap for samples, and for a compressed file; 0 is 16 GiB */
    const hewn_progress *progress; /* or NULL; the stage is "load" */
} hewn_volume_read_desc;

/* Reads a volume, compressed with gzip or not, in its own type; `out` passes hewn_volume_check(). Samples of a file
 * that is not compressed, in this machine's byte order and large are left in the file (hewn/volume.h). Names of other
 * files in a header may not lead out of its folder. `desc` may be NULL. docs/volumes.md says what each format keeps.
 * HEWN_INVALID_ARGUMENT for an unknown format or a bad description; HEWN_IO; HEWN_BAD_INPUT says why a file cannot be
 * used; HEWN_LIMIT for more than memory_limit; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. Safe from several threads at once.
 */
HEWN_API hewn_result hewn_volume_read(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out,
                                      hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
