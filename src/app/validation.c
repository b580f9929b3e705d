#include "app/validation.h"

#include <stdlib.h>
#include <string.h>

bool hewn_validation_wanted(void)
{
    const char *value = getenv("HEWN_VALIDATION");
    return value && value[0] && strcmp(value, "0") != 0;
}
