/* The parts of command lines that say how a volume is to be read. */
#ifndef HEWN_SRC_APP_VOLUME_ARGUMENTS_H
#define HEWN_SRC_APP_VOLUME_ARGUMENTS_H

#include "app/options.h"
#include "hewn/volume_extract.h"
#include "hewn/volume_io.h"

#define HEWN_OPTIONS_VOLUME                                                                                            \
    {0, "frame", "N", "Of a volume with several frames, look at this one, counted from 0. Default: 0."},               \
        {0, "iso", "VALUE",                                                                                            \
         "The value of a volume's surface: a number, otsu, otsu:K/N (threshold K of N classes), p0 to p100 (a "        \
         "percentile), hu:bone, hu:skin or hu:lung."},                                                                 \
        {0, "grid", "NAME", "Of a .vdb file, read this grid. Default: its first one of scalars."},                     \
        {0, "series", "UID", "Of a folder of DICOM files, read this series. Needed where there are several."},         \
        {0, "dims", "X,Y,Z", "A raw file has so many voxels; X,Y,Z,N for N frames."},                                  \
        {0, "type", "TYPE",                                                                                            \
         "Its voxels are int8, uint8, int16, uint16, int32, uint32, int64, uint64, half, float or double."},           \
        {0, "spacing", "X,Y,Z", "Its voxels lie so far apart. Default: 1,1,1."},                                       \
        {0, "endian", "ORDER", "Its byte order is little or big. Default: little."},                                   \
    {                                                                                                                  \
        0, "skip", "BYTES", "Its voxels begin after so many bytes. Default: 0."                                        \
    }

/* What the options say; strings are those of the arguments. */
typedef struct hewn_volume_arguments {
    hewn_volume_read_desc read; /* its format is the caller's */
    uint64_t frame;
    hewn_iso iso;
    bool has_iso;
} hewn_volume_arguments;

/* Whether any of the options above is given. */
bool hewn_volume_arguments_any(const hewn_arguments *arguments);

/* Whether the operand is to be read as a volume, and the format that --from names. Who says what a raw file holds means
 * one. */
bool hewn_volume_arguments_wanted(const hewn_arguments *arguments, hewn_volume_format *format);

/* --largest, --min-volume and --fill-cavities. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_body_arguments_read(const hewn_arguments *arguments, hewn_body_choice *out, hewn_error *error);

/* HEWN_INVALID_ARGUMENT. */
hewn_result hewn_volume_arguments_read(const hewn_arguments *arguments, hewn_volume_arguments *out, hewn_error *error);

#endif
