/* OFF from memory: whatever the bytes are, reading them gives a model that survives a round trip, or an error and
 * nothing. */
#include "io/formats.h"
#include "round_trip.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const hewn_source source = {.bytes = (const char *)data, .length = size, .name = "fuzz"};
    hewn_model model;
    if (hewn_off_read(&source, &model, NULL) == HEWN_OK)
        demand_round_trip(&model, "off");
    demand_nothing(&model);
    return 0;
}
