/* Numbers on the command line, read strictly: all of the text, no blanks, no hexadecimal, nothing infinite. */
#ifndef HEWN_SRC_APP_NUMBER_H
#define HEWN_SRC_APP_NUMBER_H

#include "hewn/hewn.h"

/* `option` is how messages call it ("--cell"). HEWN_INVALID_ARGUMENT with what was given and what is wanted. */
hewn_result hewn_number_parse(const char *text, const char *option, double *out, hewn_error *error);

/* A whole number from `least` on; UINT32_MAX stands for all that are larger, so that whoever knows the real limit can
 * refuse them. */
hewn_result hewn_count_parse(const char *text, const char *option, uint32_t least, uint32_t *out, hewn_error *error);

/* Bytes, at least 1: a whole number, and K, M or G for so many times 2^10, 2^20 or 2^30. */
hewn_result hewn_bytes_parse(const char *text, const char *option, uint64_t *out, hewn_error *error);

/* "x0,y0,z0,x1,y1,z1" */
hewn_result hewn_bounds_parse(const char *text, const char *option, hewn_box *out, hewn_error *error);

/* "x0,y0,x1,y1", or "x0,y0,z,x1,y1,z" for a plane at z: the box's lower side along z is that, and else 0. */
hewn_result hewn_plane_bounds_parse(const char *text, const char *option, hewn_box *out, hewn_error *error);

/* "x,y,z" at the beginning of `*text`, which is moved behind it. */
hewn_result hewn_triple_parse(const char **text, const char *option, double out[3], hewn_error *error);

/* "WIDTHxHEIGHT", each from 1 to 2^20. */
hewn_result hewn_size_parse(const char *text, const char *option, uint32_t *width, uint32_t *height, hewn_error *error);

/* "name=value"; `name` receives a copy that is owned by the caller (hewn_free). */
hewn_result hewn_setting_parse(const char *text, char **name, double *value, hewn_error *error);

#endif
