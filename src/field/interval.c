#include "field/interval.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* --- rounding outward ----------------------------------------------------------------------------------------------
 */

static double next_up(double value)
{
    if (!(value < INFINITY))
        return value;
    if (value == 0)
        return DBL_TRUE_MIN;
    int64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits += value > 0 ? 1 : -1;
    memcpy(&value, &bits, sizeof bits);
    return value;
}

static double next_down(double value)
{
    return -next_up(-value);
}

/* A result that is infinite from finite operands is a real number too large to hold: the bound nearer to zero must stay
 * finite. Operands that are infinite themselves lose an infinitely small amount by that, which is still a bound. */
double hewn_lower(double value, double error)
{
    if (isinf(value))
        return value > 0 ? DBL_MAX : value;
    double moved = value - error;
    return isnan(moved) ? -INFINITY : next_down(moved);
}

double hewn_upper(double value, double error)
{
    return -hewn_lower(-value, error);
}

/* What the mathematical library promises is a unit in the last place or so; four leave room for others' libraries. */
static double lower_libm(double value)
{
    return hewn_lower(value, fabs(value) * 0x1p-50);
}

static double upper_libm(double value)
{
    return hewn_upper(value, fabs(value) * 0x1p-50);
}

/* The error of a sum that was rounded to nearest, exactly (Knuth's TwoSum); NaN where something is infinite. */
static double sum_error(double a, double b, double sum)
{
    double part = sum - a;
    return (a - (sum - part)) + (b - part);
}

static double add_lower(double a, double b)
{
    double sum = a + b;
    if (isnan(sum))
        return -INFINITY;
    return sum_error(a, b, sum) >= 0 ? sum : hewn_lower(sum, 0);
}

static double add_upper(double a, double b)
{
    return -add_lower(-a, -b);
}

/* Below this the error of a product or quotient may itself be lost to underflow. */
#define TINY 0x1p-960

/* 0 times infinity counts as 0 here: the bounds of the products around it are found at the other corners. */
static double mul_lower(double a, double b)
{
    if (a == 0 || b == 0)
        return 0;
    double product = a * b;
    if (fabs(product) < TINY)
        return product == 0 && !signbit(product) ? 0 : next_down(product);
    return fma(a, b, -product) >= 0 ? product : hewn_lower(product, 0);
}

static double mul_upper(double a, double b)
{
    return -mul_lower(-a, b);
}

/* For b not 0; infinity over infinity counts as the whole range that it can come from, [0, infinity]. */
static double div_lower(double a, double b)
{
    if (a == 0)
        return 0;
    double quotient = a / b;
    if (isnan(quotient))
        return signbit(a) == signbit(b) ? 0 : -INFINITY;
    if (fabs(quotient) < TINY || fabs(a) < TINY)
        return quotient == 0 && !signbit(quotient) ? 0 : hewn_lower(quotient, 0);
    double rest = fma(-quotient, b, a);
    return (b > 0 ? rest : -rest) >= 0 ? quotient : hewn_lower(quotient, 0);
}

static double div_upper(double a, double b)
{
    return -div_lower(-a, b);
}

static double sqrt_lower(double a)
{
    double root = sqrt(a);
    if (a >= TINY)
        return fma(-root, root, a) >= 0 ? root : hewn_lower(root, 0);
    return a <= 0 ? 0 : next_down(root);
}

static double sqrt_upper(double a)
{
    double root = sqrt(a);
    if (a >= TINY && a < INFINITY)
        return fma(-root, root, a) <= 0 ? root : next_up(root);
    return a <= 0 ? 0 : next_up(root);
}

/* --- making and asking ---------------------------------------------------------------------------------------------
 */

static hewn_interval make(double lo, double hi, bool maybe_nan)
{
    return (hewn_interval){lo, hi, maybe_nan};
}

hewn_interval hewn_interval_of(double value)
{
    return isnan(value) ? hewn_interval_all() : make(value, value, false);
}

hewn_interval hewn_interval_all(void)
{
    return make(-INFINITY, INFINITY, true);
}

static bool has(hewn_interval a, double value)
{
    return a.lo <= value && value <= a.hi;
}

static bool has_infinity(hewn_interval a)
{
    return isinf(a.lo) || isinf(a.hi);
}

static hewn_interval hull(hewn_interval a, hewn_interval b)
{
    return make(a.lo < b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi, a.maybe_nan || b.maybe_nan);
}

/* --- one operand ---------------------------------------------------------------------------------------------------
 */

hewn_interval hewn_interval_neg(hewn_interval a)
{
    return make(-a.hi, -a.lo, a.maybe_nan);
}

hewn_interval hewn_interval_abs(hewn_interval a)
{
    if (a.lo >= 0)
        return a;
    if (a.hi <= 0)
        return hewn_interval_neg(a);
    return make(0, -a.lo > a.hi ? -a.lo : a.hi, a.maybe_nan);
}

hewn_interval hewn_interval_sqrt(hewn_interval a)
{
    if (a.hi < 0)
        return hewn_interval_all();
    return make(sqrt_lower(a.lo), sqrt_upper(a.hi), a.maybe_nan || a.lo < 0);
}

hewn_interval hewn_interval_square(hewn_interval a)
{
    hewn_interval size = hewn_interval_abs(a);
    return make(mul_lower(size.lo, size.lo), mul_upper(size.hi, size.hi), a.maybe_nan);
}

/* Whether a multiple of `period` plus `phase` may lie in [lo, hi]. The quotient's rounding is allowed for, so that an
 * answer of no can be relied on; far from zero the answer is always yes. */
static bool may_meet(hewn_interval a, double phase, double period)
{
    double first = (a.lo - phase) / period, last = (a.hi - phase) / period;
    double slack = 0x1p-48 * (1 + (fabs(first) > fabs(last) ? fabs(first) : fabs(last)));
    return !(floor(last + slack) < ceil(first - slack));
}

#define PI 3.14159265358979323846

hewn_interval hewn_interval_sin(hewn_interval a)
{
    if (has_infinity(a))
        return make(-1, 1, true);
    double at_lo = sin(a.lo), at_hi = sin(a.hi);
    double lo = lower_libm(fmin(at_lo, at_hi)), hi = upper_libm(fmax(at_lo, at_hi));
    if (lo < -1 || may_meet(a, -0.5 * PI, 2 * PI))
        lo = -1;
    if (hi > 1 || may_meet(a, 0.5 * PI, 2 * PI))
        hi = 1;
    return make(lo, hi, a.maybe_nan);
}

hewn_interval hewn_interval_cos(hewn_interval a)
{
    if (has_infinity(a))
        return make(-1, 1, true);
    double at_lo = cos(a.lo), at_hi = cos(a.hi);
    double lo = lower_libm(fmin(at_lo, at_hi)), hi = upper_libm(fmax(at_lo, at_hi));
    if (lo < -1 || may_meet(a, PI, 2 * PI))
        lo = -1;
    if (hi > 1 || may_meet(a, 0, 2 * PI))
        hi = 1;
    return make(lo, hi, a.maybe_nan);
}

hewn_interval hewn_interval_tan(hewn_interval a)
{
    if (has_infinity(a))
        return hewn_interval_all();
    if (may_meet(a, 0.5 * PI, PI))
        return make(-INFINITY, INFINITY, a.maybe_nan);
    return make(lower_libm(tan(a.lo)), upper_libm(tan(a.hi)), a.maybe_nan);
}

/* [lo, hi] cut to where arcsine and arccosine are defined; false where nothing is left. */
static bool cut_to_unit(hewn_interval *a)
{
    if (a->lo > 1 || a->hi < -1)
        return false;
    a->maybe_nan = a->maybe_nan || a->lo < -1 || a->hi > 1;
    a->lo = a->lo < -1 ? -1 : a->lo;
    a->hi = a->hi > 1 ? 1 : a->hi;
    return true;
}

hewn_interval hewn_interval_asin(hewn_interval a)
{
    if (!cut_to_unit(&a))
        return hewn_interval_all();
    return make(lower_libm(asin(a.lo)), upper_libm(asin(a.hi)), a.maybe_nan);
}

hewn_interval hewn_interval_acos(hewn_interval a)
{
    if (!cut_to_unit(&a))
        return hewn_interval_all();
    double lo = lower_libm(acos(a.hi));
    return make(lo < 0 ? 0 : lo, upper_libm(acos(a.lo)), a.maybe_nan);
}

hewn_interval hewn_interval_atan(hewn_interval a)
{
    return make(lower_libm(atan(a.lo)), upper_libm(atan(a.hi)), a.maybe_nan);
}

hewn_interval hewn_interval_exp(hewn_interval a)
{
    double lo = lower_libm(exp(a.lo));
    return make(lo < 0 ? 0 : lo, a.hi == -INFINITY ? 0 : upper_libm(exp(a.hi)), a.maybe_nan);
}

hewn_interval hewn_interval_ln(hewn_interval a)
{
    if (a.hi < 0)
        return hewn_interval_all();
    bool maybe_nan = a.maybe_nan || a.lo < 0;
    double hi = a.hi == 0 ? -INFINITY : upper_libm(log(a.hi));
    return make(a.lo <= 0 ? -INFINITY : lower_libm(log(a.lo)), hi, maybe_nan);
}

hewn_interval hewn_interval_floor(hewn_interval a)
{
    return make(floor(a.lo), floor(a.hi), a.maybe_nan);
}

hewn_interval hewn_interval_ceil(hewn_interval a)
{
    return make(ceil(a.lo), ceil(a.hi), a.maybe_nan);
}

hewn_interval hewn_interval_round(hewn_interval a)
{
    return make(round(a.lo), round(a.hi), a.maybe_nan);
}

hewn_interval hewn_interval_not(hewn_interval a)
{
    bool only_zero = a.lo == 0 && a.hi == 0 && !a.maybe_nan;
    return make(only_zero ? 1 : 0, has(a, 0) ? 1 : 0, false);
}

/* --- two operands --------------------------------------------------------------------------------------------------
 */

hewn_interval hewn_interval_add(hewn_interval a, hewn_interval b)
{
    bool cancels = (a.hi == INFINITY && b.lo == -INFINITY) || (a.lo == -INFINITY && b.hi == INFINITY);
    return make(add_lower(a.lo, b.lo), add_upper(a.hi, b.hi), a.maybe_nan || b.maybe_nan || cancels);
}

hewn_interval hewn_interval_sub(hewn_interval a, hewn_interval b)
{
    return hewn_interval_add(a, hewn_interval_neg(b));
}

hewn_interval hewn_interval_mul(hewn_interval a, hewn_interval b)
{
    bool nan = a.maybe_nan || b.maybe_nan || (has(a, 0) && has_infinity(b)) || (has(b, 0) && has_infinity(a));
    if (a.lo >= 0 && b.lo >= 0)
        return make(mul_lower(a.lo, b.lo), mul_upper(a.hi, b.hi), nan);
    double lo =
        fmin(fmin(mul_lower(a.lo, b.lo), mul_lower(a.lo, b.hi)), fmin(mul_lower(a.hi, b.lo), mul_lower(a.hi, b.hi)));
    double hi =
        fmax(fmax(mul_upper(a.lo, b.lo), mul_upper(a.lo, b.hi)), fmax(mul_upper(a.hi, b.lo), mul_upper(a.hi, b.hi)));
    return make(lo, hi, nan);
}

/* A divisor that may be 0 may be either zero, and so give either infinity. */
hewn_interval hewn_interval_div(hewn_interval a, hewn_interval b)
{
    bool nan = a.maybe_nan || b.maybe_nan || (has(a, 0) && has(b, 0)) || (has_infinity(a) && has_infinity(b));
    if (has(b, 0))
        return make(-INFINITY, INFINITY, nan);
    double lo =
        fmin(fmin(div_lower(a.lo, b.lo), div_lower(a.lo, b.hi)), fmin(div_lower(a.hi, b.lo), div_lower(a.hi, b.hi)));
    double hi =
        fmax(fmax(div_upper(a.lo, b.lo), div_upper(a.lo, b.hi)), fmax(div_upper(a.hi, b.lo), div_upper(a.hi, b.hi)));
    return make(lo, hi, nan);
}

hewn_interval hewn_interval_min(hewn_interval a, hewn_interval b)
{
    return make(a.lo < b.lo ? a.lo : b.lo, a.hi < b.hi ? a.hi : b.hi, a.maybe_nan || b.maybe_nan);
}

hewn_interval hewn_interval_max(hewn_interval a, hewn_interval b)
{
    return make(a.lo > b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi, a.maybe_nan || b.maybe_nan);
}

static double euclidean_mod(double a, double b)
{
    double rest = fmod(a, b);
    return rest < 0 ? rest + b : rest;
}

hewn_interval hewn_interval_mod(hewn_interval a, hewn_interval b)
{
    hewn_interval size = hewn_interval_abs(b);
    bool nan = a.maybe_nan || b.maybe_nan || has_infinity(a) || size.lo == 0;
    if (size.hi == 0)
        return hewn_interval_all();
    if (a.lo >= 0 && a.hi < size.lo)
        return make(a.lo, a.hi, nan);
    if (size.lo == size.hi && !has_infinity(a) && !isinf(size.hi)) {
        /* Rising by less than a period without falling, the remainder has not wrapped. */
        double lo = euclidean_mod(a.lo, size.hi), hi = euclidean_mod(a.hi, size.hi);
        if (add_upper(a.hi, -a.lo) < size.hi && lo <= hi)
            return make(a.lo < 0 ? fmax(0, next_down(lo)) : lo, a.lo < 0 ? fmin(size.hi, next_up(hi)) : hi, nan);
    }
    return make(0, a.lo >= 0 && a.hi < size.hi ? a.hi : size.hi, nan);
}

hewn_interval hewn_interval_atan2(hewn_interval y, hewn_interval x)
{
    bool nan = y.maybe_nan || x.maybe_nan;
    if (x.lo <= 0 && has(y, 0))
        return make(lower_libm(-PI), upper_libm(PI), nan);
    /* Away from the cut and the origin the angle is monotone along each side: the corners are the extremes. */
    double lo = INFINITY, hi = -INFINITY;
    for (int corner = 0; corner < 4; corner++) {
        double angle = atan2(corner & 1 ? y.hi : y.lo, corner & 2 ? x.hi : x.lo);
        lo = fmin(lo, angle);
        hi = fmax(hi, angle);
    }
    return make(lower_libm(lo), upper_libm(hi), nan);
}

hewn_interval hewn_interval_compare(hewn_interval a, hewn_interval b)
{
    double lo = a.lo < b.hi ? -1 : a.lo == b.hi ? 0 : 1;
    double hi = a.hi > b.lo ? 1 : a.hi == b.lo ? 0 : -1;
    return make(lo, hi, a.maybe_nan || b.maybe_nan);
}

static bool only_zero(hewn_interval a)
{
    return a.lo == 0 && a.hi == 0 && !a.maybe_nan;
}

hewn_interval hewn_interval_and(hewn_interval a, hewn_interval b)
{
    hewn_interval zero = make(0, 0, false);
    if (only_zero(a))
        return zero;
    return has(a, 0) ? hull(zero, b) : b;
}

hewn_interval hewn_interval_or(hewn_interval a, hewn_interval b)
{
    if (only_zero(a))
        return b;
    return has(a, 0) ? hull(a, b) : a;
}
