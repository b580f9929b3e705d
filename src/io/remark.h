/* The remark by which Hewn's own files say unit and axes, where the format has no place for them. */
#ifndef HEWN_SRC_IO_REMARK_H
#define HEWN_SRC_IO_REMARK_H

#include "base/text.h"
#include "hewn/model.h"

/* Appends "1 unit = 0.001 m, +Z up", with question marks for what is not known (NULL), and of a patient's space (or
 * NULL)
 * ", SPACE=RAS", as 3D Slicer reads it. */
void hewn_remark_print(hewn_text *text, const hewn_unit *unit, const hewn_axis *up, const char *space);

/* Looks for such a remark in one line and takes what it says into the model, where that knows nothing yet; passes over
 * remarks of units that Hewn does not know. */
void hewn_remark_read(const char *begin, const char *end, hewn_model *model);

#endif
