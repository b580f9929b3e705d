/* What was found of a mesh, as JSON. */
#ifndef HEWN_SRC_PIPELINE_CHECK_JSON_H
#define HEWN_SRC_PIPELINE_CHECK_JSON_H

#include "base/json.h"
#include "hewn/check.h"

/* An object with the names of the mesh report's certificate, and those that only a check has (docs/files.md). */
void hewn_json_check(hewn_json *json, const char *key, const hewn_check *check);

#endif
