/* What the reports of several jobs have in common. */
#ifndef HEWN_SRC_PIPELINE_JSON_PARTS_H
#define HEWN_SRC_PIPELINE_JSON_PARTS_H

#include "base/json.h"
#include "hewn/file_job.h"
#include "hewn/volume.h"

void hewn_json_vector(hewn_json *json, const char *key, const double vector[3]);
void hewn_json_box(hewn_json *json, const char *key, const hewn_box *box);

/* The fields of a certificate, into an object that is open. */
void hewn_json_certificate(hewn_json *json, const hewn_certificate *certificate);

/* What was found and kept, as an object. */
void hewn_json_bodies(hewn_json *json, const char *key, const hewn_body_counts *counts);

/* "version", "input", "from", "output" and "to", the formats by their names. */
void hewn_json_files(hewn_json *json, const char *input, const char *from, const char *output, const char *to);

/* "peak", of a job that needs no device. */
void hewn_json_host_peak(hewn_json *json, uint64_t bytes);

/* "seconds" and "stages". */
void hewn_json_stages(hewn_json *json, const hewn_report_stage *stages, uint32_t count, double seconds);

/* Writes what was made to a file, "-" is standard output. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_json_finish(const hewn_text *text, const char *path, hewn_error *error);

#endif
