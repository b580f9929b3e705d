#include "io/shim/number.h"

#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

char *hewn_number_print_float(char *to, float value)
{
    return std::to_chars(to, to + HEWN_NUMBER_ROOM, value).ptr;
}

char *hewn_number_print_double(char *to, double value)
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

/* Short numbers without an exponent, which most are: a whole number and a power of ten that are both exact have a
 * quotient that is rounded once (Clinger 1990, 'How to read floating point numbers accurately'). NULL for all others.
 */
template <typename Real>
const char *parse_short(const char *at, const char *end, Real *out)
{
    constexpr bool single = std::numeric_limits<Real>::digits == 24;
    constexpr std::uint64_t most = std::uint64_t(1) << std::numeric_limits<Real>::digits;
    constexpr std::ptrdiff_t most_places = single ? 10 : 18;
    static constexpr Real powers[] = {Real(1e0),  Real(1e1),  Real(1e2),  Real(1e3),  Real(1e4),
                                      Real(1e5),  Real(1e6),  Real(1e7),  Real(1e8),  Real(1e9),
                                      Real(1e10), Real(1e11), Real(1e12), Real(1e13), Real(1e14),
                                      Real(1e15), Real(1e16), Real(1e17), Real(1e18)};
    const bool negative = at < end && *at == '-';
    std::uint64_t whole = 0;
    const char *digits = at += negative;
    for (; at < end && *at >= '0' && *at <= '9' && whole <= most; at++)
        whole = 10 * whole + std::uint64_t(*at - '0');
    std::ptrdiff_t count = at - digits, places = 0;
    if (at < end && *at == '.') {
        const char *point = at++;
        for (; at < end && *at >= '0' && *at <= '9' && whole <= most; at++)
            whole = 10 * whole + std::uint64_t(*at - '0');
        places = at - point - 1;
    }
    bool more = at < end && ((*at >= '0' && *at <= '9') || *at == 'e' || *at == 'E');
    if (FLT_EVAL_METHOD != 0 || more || count + places == 0 || whole > most || places > most_places)
        return nullptr;
    Real value = Real(whole) / powers[places];
    *out = negative ? -value : value;
    return at;
}

template <typename Real>
const char *parse_real(const char *at, const char *end, Real *out)
{
    at = skip_plus(at, end);
    if (const char *after = parse_short(at, end, out))
        return after;
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
