#include "io/shim/number.h"

#include <charconv>
#include <cmath>
#include <limits>

char *hewn_number_print_float(char *to, float value)
{
    return std::to_chars(to, to + HEWN_NUMBER_ROOM, value).ptr;
}

char *hewn_number_print_unsigned(char *to, uint64_t value)
{
    return std::to_chars(to, to + HEWN_NUMBER_ROOM, value).ptr;
}

namespace
{

/* Past one '+', which from_chars does not take; not past a second sign. */
const char *skip_plus(const char *at, const char *end)
{
    return end - at > 1 && at[0] == '+' && at[1] != '-' && at[1] != '+' ? at + 1 : at;
}

/* from_chars says "out of range" for too large and too small alike, and leaves the value alone. The sign of the decimal
 * exponent of the first digit that is not 0 tells them apart. */
bool is_tiny(const char *at, const char *end)
{
    long shift = 0;
    bool point = false, leading = true;
    for (; at < end && *at != 'e' && *at != 'E'; at++) {
        if (*at == '.') {
            point = true;
        } else if (*at >= '0' && *at <= '9') {
            leading = leading && *at == '0';
            shift += (!leading && !point) - (leading && point);
        }
    }
    long exponent = 0;
    if (at < end) {
        at = skip_plus(at + 1, end);
        if (std::from_chars(at, end, exponent).ec == std::errc::result_out_of_range)
            return *at == '-';
    }
    return shift < -exponent;
}

template <typename Real>
const char *parse_real(const char *at, const char *end, Real *out)
{
    at = skip_plus(at, end);
    auto [next, failure] = std::from_chars(at, end, *out);
    if (failure == std::errc::invalid_argument)
        return nullptr;
    if (failure == std::errc::result_out_of_range)
        *out = std::copysign(is_tiny(at, next) ? Real(0) : std::numeric_limits<Real>::infinity(),
                             *at == '-' ? Real(-1) : Real(1));
    return next;
}

} // namespace

const char *hewn_number_parse_float(const char *at, const char *end, float *out)
{
    return parse_real(at, end, out);
}

const char *hewn_number_parse_double(const char *at, const char *end, double *out)
{
    return parse_real(at, end, out);
}

const char *hewn_number_parse_integer(const char *at, const char *end, int64_t *out)
{
    auto [next, failure] = std::from_chars(skip_plus(at, end), end, *out);
    return failure == std::errc() ? next : nullptr;
}
