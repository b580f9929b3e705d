#include "base/srgb.h"

#include <math.h>

double hewn_srgb_to_linear(double share)
{
    return share <= 0.04045 ? share / 12.92 : pow((share + 0.055) / 1.055, 2.4);
}

double hewn_srgb_from_linear(double share)
{
    return share <= 0.0031308 ? 12.92 * share : 1.055 * pow(share, 1 / 2.4) - 0.055;
}
