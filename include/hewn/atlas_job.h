/* Whole jobs that end in a glyph atlas: a font file in, an image and its description out. */
#ifndef HEWN_ATLAS_JOB_H
#define HEWN_ATLAS_JOB_H

#include "hewn/atlas.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero everywhere but `font` and `output` is a sensible default. */
typedef struct hewn_atlas_job_desc {
    const char *font;
    uint32_t face;               /* of a collection */
    const char *output;          /* a PNG file; "-" is standard output */
    const char *json;            /* or NULL; "-" is standard output */
    const char *const *charsets; /* each "ascii", "latin1", "all", or a file that describes a set (docs/atlas.md) */
    size_t charset_count;
    const char *const *texts; /* each UTF-8 whose characters belong to the set, or "@" and the name of a file of it */
    size_t text_count;        /* where both counts are 0 the set is "ascii" */
    bool y_down;              /* the JSON's y counts from the top, downward */
    hewn_atlas_desc atlas;    /* its characters are set by the job; the last stage of its progress is "write", before
                                 which no file is there */
} hewn_atlas_job_desc;

/* What a job did. Leave it with hewn_atlas_report_destroy(). */
typedef struct hewn_atlas_report {
    char font[256];   /* family and style */
    hewn_atlas atlas; /* without texels */
    double seconds;
} hewn_atlas_report;

HEWN_API void hewn_atlas_report_destroy(hewn_atlas_report *report);

/* Makes an atlas and writes it. Both files appear under their names only when both are complete. The same bytes for the
 * same description. HEWN_INVALID_ARGUMENT for a description that makes no sense, HEWN_IO for a file that cannot be
 * written, HEWN_BAD_INPUT for a font or set of characters that cannot be read or used, naming the file; the errors of
 * hewn_atlas_create(). */
HEWN_API hewn_result hewn_atlas_file(const hewn_atlas_job_desc *desc, hewn_atlas_report *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
