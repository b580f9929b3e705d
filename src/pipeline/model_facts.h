/* What there is to tell of a model without proving anything. */
#ifndef HEWN_SRC_PIPELINE_MODEL_FACTS_H
#define HEWN_SRC_PIPELINE_MODEL_FACTS_H

#include "base/json.h"
#include "hewn/model.h"

typedef struct hewn_model_facts {
    uint64_t corners;
    uint64_t triangles, quads, polygons; /* faces of three, four and more corners; of fewer: the rest */
    uint64_t most_corners;               /* of a face */
    hewn_box bounds;                     /* of all vertices; zero where there is none */
} hewn_model_facts;

hewn_model_facts hewn_model_facts_of(const hewn_model *model);

/* The least and greatest value of a component, NaN aside; NaN where there is none. */
void hewn_channel_range(const hewn_model *model, const hewn_channel *channel, uint32_t component, double *lo,
                        double *hi);

/* How many elements have each named value: `name_count` entries, the caller's (hewn_free). HEWN_OUT_OF_MEMORY. */
hewn_result hewn_channel_uses(const hewn_model *model, const hewn_channel *channel, uint64_t **out, hewn_error *error);

const char *hewn_domain_name(hewn_domain domain); /* "vertex", "corner", "face" */
const char *hewn_scalar_name(hewn_scalar scalar); /* "float", "double", "uint8", "int32" */

/* "counts", "unit", "up", "bounds" and "attributes" of a model. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_json_model(hewn_json *json, const hewn_model *model, hewn_error *error);

#endif
