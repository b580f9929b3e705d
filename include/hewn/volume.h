/* Volumes: samples on a regular lattice, as scanners, simulations and label maps give them, in the type they were
 * stored in, with the affine map that says where each lies in the world. Readers (hewn/volume_io.h) make them. */
#ifndef HEWN_VOLUME_H
#define HEWN_VOLUME_H

#include "hewn/field.h"
#include "hewn/units.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a sample is. A half is IEEE 754's binary16. */
typedef enum hewn_voxel {
    HEWN_VOXEL_INT8 = 0,
    HEWN_VOXEL_UINT8,
    HEWN_VOXEL_INT16,
    HEWN_VOXEL_UINT16,
    HEWN_VOXEL_INT32,
    HEWN_VOXEL_UINT32,
    HEWN_VOXEL_INT64,
    HEWN_VOXEL_UINT64,
    HEWN_VOXEL_HALF,
    HEWN_VOXEL_FLOAT,
    HEWN_VOXEL_DOUBLE
} hewn_voxel;

enum { HEWN_VOXEL_COUNT = HEWN_VOXEL_DOUBLE + 1 };

HEWN_API size_t hewn_voxel_size(hewn_voxel type);      /* in bytes */
HEWN_API const char *hewn_voxel_name(hewn_voxel type); /* "int8" to "uint64", "half", "float", "double" */
HEWN_API bool hewn_voxel_find(const char *name, hewn_voxel *out);
HEWN_API bool hewn_voxel_is_integer(hewn_voxel type);

/* Samples of a volume that is mostly constant, in blocks: src/volume/blocks.h. */
typedef struct hewn_blocks hewn_blocks;

/* A volume. Zero is the empty one; what it owns it frees in hewn_volume_destroy(). Move it by assignment.
 *
 * Samples: i runs fastest, then j, then k, then the frame: sample (i, j, k) of frame t is number
 * i + dims[0] (j + dims[1] (k + dims[2] t)). They are in this machine's byte order and aligned to their size. They may
 * lie in the file itself, mapped into memory: then they are read from disk when they are first looked at, cost no heap,
 * and the file must not be cut short while the volume lives.
 *
 * Blocks: a reader that was allowed to (hewn/volume_io.h) leaves a volume that is mostly constant in blocks, as its
 * file has it; it then takes memory for what is not constant only. There is one frame. Functions that take a volume say
 * so where they cannot use blocks; samples are for hewn_volume_sample() to find then, and hewn_volume_frame() is NULL.
 *
 * Values: what a sample stands for (Hounsfield units, a distance) is slope × sample + intercept. A reader leaves them
 * apart, so that integers stay integers. An iso value is a value: compare samples with (value - intercept) / slope, and
 * mind that a negative slope turns the order around.
 *
 * Place: the centre of voxel (i, j, k) is at to_world × (i, j, k, 1), in `unit`. Whole numbers are the samples
 * themselves: a surface that is interpolated between samples at i and i + 1 has an i between them, with no half voxel
 * added. The determinant may be negative (left-handed lattice): a mesh made in (i, j, k) must then have its faces
 * turned over when its vertices are brought to the world. Where `anatomical`, the world is RAS: +x is the patient's
 * right, +y front, +z head; readers turn LPS and the like into that. Else the world is what the file has, whatever that
 * is. */
typedef struct hewn_volume {
    uint32_t dims[3];     /* each at least 1 */
    uint64_t frame_count; /* at least 1: time steps, or components of vectors */
    hewn_voxel type;
    const void *samples;       /* NULL where `blocks` has them */
    const hewn_blocks *blocks; /* NULL: they are in `samples` */
    double slope, intercept;   /* finite; slope is not 0 */
    double to_world[16];       /* row-major; finite, invertible, last row 0 0 0 1 */
    bool anatomical;
    bool hounsfield;       /* the file says that values are Hounsfield units */
    bool level_set;        /* the file says that values are signed distances, negative inside */
    const hewn_unit *unit; /* of the world; NULL: the file says none */
    char *name;            /* what the file calls it; NULL: nothing */
    char *remark;          /* what a reader wants its user to know, one sentence; NULL: nothing */
    void *memory;          /* what holds the samples: `memory_length` bytes, mapped or from the heap */
    size_t memory_length;
    bool mapped;
} hewn_volume;

HEWN_API void hewn_volume_destroy(hewn_volume *volume);

/* Checks what every volume promises (above), but for the file behind a mapping. HEWN_BAD_INPUT says what is wrong:
 * spacing of 0, a singular or infinite affine, a slope that is 0 or not finite; HEWN_LIMIT for more bytes than memory
 * can address. */
HEWN_API hewn_result hewn_volume_check(const hewn_volume *volume, hewn_error *error);

/* Samples of one frame, and where a frame begins (NULL for samples in blocks). `frame` must be there. */
HEWN_API uint64_t hewn_volume_frame_size(const hewn_volume *volume);
HEWN_API const void *hewn_volume_frame(const hewn_volume *volume, uint64_t frame);

/* A sample as a double: exact but for 64-bit integers past 2^53, which are rounded to nearest. No bounds are looked at:
 * `index` counts samples from that of frame 0. For tests and the odd sample; loops should switch on the type outside.
 */
HEWN_API double hewn_volume_sample(const hewn_volume *volume, uint64_t index);

/* The same as a value. */
HEWN_API double hewn_volume_value(const hewn_volume *volume, uint64_t index);

/* Where the point (i, j, k) of the lattice is, between samples too. */
HEWN_API void hewn_volume_to_world(const hewn_volume *volume, const double ijk[3], double out[3]);

/* The way back; rows of the inverse, 3 x 4, of a volume that hewn_volume_check() passes. */
HEWN_API void hewn_volume_from_world(const hewn_volume *volume, double out[12]);

/* Distances between neighbours along i, j and k, in the world's unit. */
HEWN_API void hewn_volume_spacing(const hewn_volume *volume, double out[3]);

/* Determinant of the 3 x 3 part of to_world: volume of a voxel, negative for a left-handed lattice. */
HEWN_API double hewn_volume_determinant(const hewn_volume *volume);

/* Towards which side of the patient i, j and k run, each by the nearest axis, as three letters of R L, A P, S I and a
 * NUL: "RAS", "LPS". An axis that is used up is not taken again, as nibabel does. "???" where not anatomical. */
HEWN_API void hewn_volume_orientation(const hewn_volume *volume, char out[4]);

/* The box of all samples' places in the world. */
HEWN_API hewn_box hewn_volume_bounds(const hewn_volume *volume);

/* Spaces that a mesh of a volume may be wanted in. */
typedef enum hewn_space {
    HEWN_SPACE_DEFAULT, /* RAS where the volume is anatomical, else the world */
    HEWN_SPACE_RAS,     /* +x is the patient's right, +y front, +z head */
    HEWN_SPACE_LPS,     /* +x is the patient's left, +y back, +z head */
    HEWN_SPACE_VOXEL,   /* (i, j, k) */
    HEWN_SPACE_GLTF,    /* +x is the patient's left, +y head, +z front; the world itself where not anatomical */
    HEWN_SPACE_WORLD    /* what the file's world is */
} hewn_space;

/* "ras", "lps", "voxel", "gltf", "world"; NULL for the default and past the last. And back, in any case. */
HEWN_API const char *hewn_space_name(hewn_space space);
HEWN_API bool hewn_space_find(const char *name, hewn_space *out);

/* From (i, j, k, 1) to a space, row by row, positions multiplied by `scale` (but for VOXEL). HEWN_BAD_INPUT for RAS and
 * LPS of a volume that is not anatomical. */
HEWN_API hewn_result hewn_volume_bring(const hewn_volume *volume, hewn_space space, double scale, double out[16],
                                       hewn_error *error);

/* --- what is in it ------------------------------------------------------------------------------------------------ */

/* All functions below read one frame once, with as many threads as OpenMP has, and give the same bits for any number of
 * them. */

typedef struct hewn_volume_range {
    double lo, hi;               /* least and greatest finite value; NaN where there is none */
    double sample_lo, sample_hi; /* the same of samples */
    uint64_t finite_count, nan_count, infinite_count;
} hewn_volume_range;

HEWN_API hewn_volume_range hewn_volume_find_range(const hewn_volume *volume, uint64_t frame);

/* Least and greatest sample of each brick of 8 x 8 x 8 cells. A cell is what lies between 2 x 2 x 2 neighbouring
 * samples, so brick (a, b, c) speaks for samples 8a to 8a + 8 along i, and likewise; neighbouring bricks share a layer
 * of samples. Along an axis of n samples there are max(1, ceil((n - 1) / 8)) bricks. In floats: the exact least and
 * greatest where a float can hold them, else the next float outward, so that whatever lies outside [lo, hi] is no
 * sample of the brick. A brick without a number has lo = +infinity and hi = -infinity. Infinite samples count. */
typedef struct hewn_volume_bricks {
    uint32_t dims[3];
    float *lo, *hi;     /* of samples, not values; brick number a + dims[0] (b + dims[1] c) */
    uint8_t *nan;       /* 1 where the brick has a NaN among its samples */
    uint64_t nan_count; /* bricks with one */
} hewn_volume_bricks;

enum { HEWN_BRICK_CELLS = 8 };

/* HEWN_INVALID_ARGUMENT for a volume in blocks; HEWN_OUT_OF_MEMORY; then `*out` is zero. */
HEWN_API hewn_result hewn_volume_find_bricks(const hewn_volume *volume, uint64_t frame, hewn_volume_bricks *out,
                                             hewn_error *error);
HEWN_API void hewn_volume_bricks_destroy(hewn_volume_bricks *bricks);

/* How many finite samples lie in each of `count` equal parts of [lo, hi]; hi itself is in the last part. Samples
 * outside are left out. `lo` < `hi`, `count` > 0. */
typedef struct hewn_volume_histogram {
    double lo, hi; /* in samples */
    uint32_t count;
    uint64_t *bins;
    uint64_t total; /* of all bins */
} hewn_volume_histogram;

/* HEWN_INVALID_ARGUMENT for a range or count that makes none; HEWN_OUT_OF_MEMORY. `*out` is then zero. */
HEWN_API hewn_result hewn_volume_find_histogram(const hewn_volume *volume, uint64_t frame, double lo, double hi,
                                                uint32_t count, hewn_volume_histogram *out, hewn_error *error);
HEWN_API void hewn_volume_histogram_destroy(hewn_volume_histogram *histogram);

/* The value that `percent` of the finite values are not above: of n of them in order, number ceil(percent n / 100),
 * counted from 1, and the first for 0. It is one of the values, exactly. HEWN_BAD_INPUT where none is finite;
 * HEWN_OUT_OF_MEMORY; HEWN_INVALID_ARGUMENT for a percentage outside [0, 100]. */
HEWN_API hewn_result hewn_volume_find_percentile(const hewn_volume *volume, uint64_t frame, double percent, double *out,
                                                 hewn_error *error);

/* --- bodies ------------------------------------------------------------------------------------------------------- */

/* Which parts of what is in a volume to mesh. A body is a piece of what is inside, connected as the mesh is, with the
 * cavities in it: its volume is what its hull encloses, less what its cavities do. In a cavity there may be more
 * bodies; they count for themselves. First the largest are kept, then of these those that are large enough, then
 * cavities are filled. */
typedef struct hewn_body_choice {
    uint64_t largest;    /* keep so many bodies, those of the greatest volume; 0: all */
    double least_volume; /* and of these those of at least this volume, in the mesh's space; 0: all */
    bool fill_cavities;  /* drop the walls of cavities, and the bodies in them, which are swallowed */
} hewn_body_choice;

typedef struct hewn_body_counts {
    uint64_t bodies, cavities;           /* that there are; 0 where no choice was asked for */
    uint64_t kept_bodies, kept_cavities; /* that are meshed */
    double largest_volume;               /* of a body, in the mesh's space */
} hewn_body_counts;

/* --- smoothing ---------------------------------------------------------------------------------------------------- */

typedef enum hewn_volume_filter {
    HEWN_VOLUME_GAUSSIAN, /* `length` is the standard deviation */
    HEWN_VOLUME_MEDIAN    /* `length` is the radius of a ball: the median of the voxels whose centres are in it */
} hewn_volume_filter;

typedef struct hewn_volume_smooth_desc {
    uint64_t frame;
    hewn_volume_filter filter;
    double length;                 /* above 0, in the world's unit, along every axis, whatever the voxels' shape */
    const hewn_progress *progress; /* or NULL; the stage is "filter" */
} hewn_volume_smooth_desc;

/* A frame smoothed, as a volume of that frame alone, in the same place with the same slope and intercept. Neither
 * filter looks beyond the border: weights there are those of the voxels that are inside, made to sum up to 1, so that
 * what is constant stays so. NaN has no weight, nor has infinity in the Gaussian; such voxels themselves stay as they
 * are. The Gaussian is the discrete one, exp(-t) I_n(t), whose deviation is right for less than a voxel too (Lindeberg
 * 1990, 'Scale-space for discrete signals'), along i, j and k in turn, cut off where less than a millionth is left; it
 * gives floats, or doubles for integers of 32 and 64 bits and doubles. The median (of an even number: the lower one)
 * keeps the type, but makes floats of halves and doubles of 64-bit integers. The same bytes for any number of threads.
 * Memory beside the result: a few slices for each thread, and 4 bytes a voxel where there are NaN or infinities.
 *
 * HEWN_INVALID_ARGUMENT for a frame that is not there, a length that is not above 0 and finite or is longer than the
 * volume, and for a ball in which there are no neighbours or more than 32,768 voxels; HEWN_OUT_OF_MEMORY;
 * HEWN_CANCELLED. `*out` is then zero. */
HEWN_API hewn_result hewn_volume_smooth(const hewn_volume *volume, const hewn_volume_smooth_desc *desc,
                                        hewn_volume *out, hewn_error *error);

/* --- iso values --------------------------------------------------------------------------------------------------- */

typedef enum hewn_iso_kind {
    HEWN_ISO_NUMBER = 0, /* the value itself */
    HEWN_ISO_OTSU,       /* threshold `threshold` of the `classes` - 1 that part the values into classes */
    HEWN_ISO_PERCENTILE,
    HEWN_ISO_HOUNSFIELD /* a tissue's surface in CT */
} hewn_iso_kind;

/* How an iso value is chosen. */
typedef struct hewn_iso {
    hewn_iso_kind kind;
    double number; /* the value; the percentage; Hounsfield units */
    uint32_t threshold, classes;
} hewn_iso;

/* Reads what users write: a number; `otsu`, which is `otsu:1/2`; `otsu:K/N`, the K-th threshold from below of those
 * that part the histogram into N classes (2 to 6, K from 1 to N - 1); `pN`, a percentile, 0 to 100; `hu:bone` (300),
 * `hu:skin` (-300), `hu:lung` (-500). HEWN_INVALID_ARGUMENT says what is known. */
HEWN_API hewn_result hewn_iso_parse(const char *text, hewn_iso *out, hewn_error *error);

/* The value that a choice gives for a frame. Otsu (1979), for more classes as Liao, Chen and Chung (2001): of 4,096
 * equal parts of the range (whole numbers: at most one part each) those borders at which the variance between classes
 * is greatest; for whole numbers the value is half way between two, so that no sample is equal to it.
 *
 * HEWN_BAD_INPUT, with the range of the data in the message, where there is no surface at such a value: none of the
 * values is finite, all are the same, or the iso value is not between the least and the greatest; and for `hu:` where a
 * volume that does not say it is in Hounsfield units has no value below 0, so that it cannot be. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_iso_find(const hewn_iso *iso, const hewn_volume *volume, uint64_t frame, double *out,
                                   hewn_error *error);

/* Gives memory back that mapped samples of slices k0 to k1 - 1 take while they were looked at; they are read from the
 * file again when they are next looked at. Does nothing for a volume on the heap. For passes over volumes larger than
 * memory. */
HEWN_API void hewn_volume_forget(const hewn_volume *volume, uint64_t frame, uint32_t k0, uint32_t k1);

#ifdef __cplusplus
}
#endif
#endif
