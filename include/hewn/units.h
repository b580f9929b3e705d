/* Units of length, and which way is up. */
#ifndef HEWN_UNITS_H
#define HEWN_UNITS_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_axis { HEWN_AXIS_PLUS_Y = 0, HEWN_AXIS_PLUS_Z, HEWN_AXIS_PLUS_X } hewn_axis;

/* One of a unit is exactly numerator / denominator metres. */
typedef struct hewn_unit {
    const char *name; /* "mm" */
    uint32_t numerator, denominator;
} hewn_unit;

/* The units there are: m, cm, mm, um, km, in, ft. NULL past the last one. Static storage; safe from any thread. */
HEWN_API const hewn_unit *hewn_unit_at(size_t index);

/* The unit of a name; NULL for any other. */
HEWN_API const hewn_unit *hewn_unit_find(const char *name);

/* The double that is nearest to the unit's length in metres. */
HEWN_API double hewn_unit_metres(const hewn_unit *unit);

/* All names with commas between, for messages. */
HEWN_API const char *hewn_unit_names(void);

/* "+Y", "+Z" or "+X", and the way back: false for any other name. */
HEWN_API const char *hewn_axis_name(hewn_axis axis);
HEWN_API bool hewn_axis_find(const char *name, hewn_axis *out);

#ifdef __cplusplus
}
#endif
#endif
