/* GDCM behind a C face, one DICOM file with an image: a module (io/shim/module.h) with one table of functions. No
 * exception leaves it. */
#ifndef HEWN_SRC_IO_SHIM_DICOM_H
#define HEWN_SRC_IO_SHIM_DICOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_dicom_result { HEWN_DICOM_OK, HEWN_DICOM_BAD, HEWN_DICOM_OUT_OF_MEMORY } hewn_dicom_result;

/* What a file says of itself. Lengths are in mm, in the patient's LPS. */
typedef struct hewn_dicom_facts {
    char series[80];       /* UID of the series, or empty */
    char description[128]; /* of the series */
    char modality[20];     /* "CT", "MR" */
    char transfer[80];     /* UID of the transfer syntax */
    int32_t instance;      /* number in the series */
    bool has_image;        /* rows, columns and pixels are there */
    bool has_place;        /* position and directions are told */
    uint32_t dims[3];      /* columns, rows, frames */
    uint32_t bits;         /* of a pixel: 8, 16 or 32; 0: none that can be read */
    bool is_signed, real;  /* real: 32 or 64 bit floats */
    bool single;           /* one number a pixel, not a colour */
    double slope, intercept;
    double origin[3];     /* of the first pixel's centre */
    double directions[6]; /* along a row, then along a column */
    double spacing[3];    /* along a row, along a column, between frames */
} hewn_dicom_facts;

typedef struct hewn_dicom hewn_dicom;

typedef struct hewn_dicom_module {
    /* Reads the header alone: series, description, modality, transfer and has_image. Fails for what is no DICOM. */
    hewn_dicom_result (*glance)(const char *bytes, size_t length, hewn_dicom_facts *facts);

    /* Reads a file from memory, which may go away afterwards. A message of at most `room` bytes says why that failed.
     */
    hewn_dicom_result (*open)(const char *bytes, size_t length, hewn_dicom **out, hewn_dicom_facts *facts,
                              char *message, size_t room);

    /* All pixels, unpacked, in this machine's byte order, frame after frame: exactly `length` bytes. */
    hewn_dicom_result (*pixels)(const hewn_dicom *file, void *out, size_t length, char *message, size_t room);

    void (*close)(hewn_dicom **file);
} hewn_dicom_module;

#ifdef __cplusplus
}
#endif
#endif
