/* What was found of a mesh, for people. */
#ifndef HEWN_SRC_APP_CERTIFICATE_H
#define HEWN_SRC_APP_CERTIFICATE_H

#include <stdio.h>

#include "hewn/check.h"
#include "hewn/units.h"

/* A line for each finding, and a table of components where there are several. */
void hewn_certificate_print(const hewn_check *check, FILE *file);

/* Two lines. `unit` may be NULL. */
void hewn_certificate_summarise(const hewn_check *check, const hewn_unit *unit, FILE *file);

/* Why a requirement does not hold: "12 boundary edges". */
void hewn_certificate_explain(const hewn_check *check, hewn_requirement requirement, FILE *file);

#endif
