/* What a format that fixes unit and axes makes of what it is given. */
#ifndef HEWN_SRC_IO_TARGET_H
#define HEWN_SRC_IO_TARGET_H

#include "base/text.h"
#include "io/formats.h"

/* What hewn_model_convert() would do to bring a job to a unit and an up axis. */
hewn_result hewn_target_find(const hewn_writing *job, const hewn_unit *unit, hewn_axis up, hewn_conversion *out,
                             hewn_error *error);

/* Whether anything changes. */
bool hewn_target_changes(const hewn_conversion *conversion);

/* Does it to a direction, and to a position. */
void hewn_target_turn(const hewn_conversion *conversion, const double in[3], double out[3]);
void hewn_target_convert(const hewn_conversion *conversion, const double in[3], double out[3]);

/* Appends it as a JSON object. */
void hewn_target_print(const hewn_conversion *conversion, hewn_text *text);

#endif
