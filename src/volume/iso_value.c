/* Iso values as users name them. */
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "volume/otsu.h"

enum { LEAST_CLASSES = 2, MOST_CLASSES = 6, PARTS = 4096 };

/* Where bone begins to outweigh soft tissue; between air and skin; and between lung and what is around it. */
static const struct {
    const char *name;
    double number;
} tissues[] = {{"bone", 300}, {"skin", -300}, {"lung", -500}};

/* All of `text` as a finite number, whatever the locale. */
static bool parse_number(const char *text, double *out)
{
    char *end;
    if (!((*text >= '0' && *text <= '9') || *text == '-' || *text == '+' || *text == '.'))
        return false; /* strtod() would take blanks, "inf" and "nan" */
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain)
        return false;
    *out = strtod_l(text, &end, plain);
    freelocale(plain);
    return end > text && *end == '\0' && isfinite(*out);
}

static bool parse_count(const char *text, const char **after, uint32_t *out)
{
    *out = 0;
    const char *at = text;
    for (; *at >= '0' && *at <= '9' && *out < 1000; at++)
        *out = 10 * *out + (uint32_t)(*at - '0');
    *after = at;
    return at > text;
}

static hewn_result parse_otsu(const char *text, hewn_iso *out, hewn_error *error)
{
    const char *after = text;
    *out = (hewn_iso){.kind = HEWN_ISO_OTSU, .threshold = 1, .classes = 2};
    if (*text == '\0')
        return HEWN_OK;
    if (*text == ':' && parse_count(text + 1, &after, &out->threshold) && *after == '/' &&
        parse_count(after + 1, &after, &out->classes) && *after == '\0' && out->classes >= LEAST_CLASSES &&
        out->classes <= MOST_CLASSES && out->threshold >= 1 && out->threshold < out->classes)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "otsu:K/N takes the K-th threshold of N classes, N from %d to %d and K from 1 to N - 1, not '%s'",
                     LEAST_CLASSES, MOST_CLASSES, text);
}

static hewn_result parse_tissue(const char *text, hewn_iso *out, hewn_error *error)
{
    for (size_t i = 0; i < sizeof tissues / sizeof *tissues; i++) {
        if (strcmp(text, tissues[i].name) == 0) {
            *out = (hewn_iso){.kind = HEWN_ISO_HOUNSFIELD, .number = tissues[i].number};
            return HEWN_OK;
        }
    }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hu: takes bone, skin or lung, not '%s'", text);
}

hewn_result hewn_iso_parse(const char *text, hewn_iso *out, hewn_error *error)
{
    double number;
    *out = (hewn_iso){0};
    hewn_iso found = {0};
    if (strncmp(text, "otsu", 4) == 0) {
        HEWN_TRY(parse_otsu(text + 4, &found, error));
    } else if (strncmp(text, "hu:", 3) == 0) {
        HEWN_TRY(parse_tissue(text + 3, &found, error));
    } else if (*text == 'p' && parse_number(text + 1, &number)) {
        if (number < 0 || number > 100)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a percentile is from p0 to p100, not '%s'", text);
        found = (hewn_iso){.kind = HEWN_ISO_PERCENTILE, .number = number};
    } else if (parse_number(text, &number)) {
        found = (hewn_iso){.kind = HEWN_ISO_NUMBER, .number = number};
    } else {
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "an iso value is a number, otsu, otsu:K/N, p0 to p100, hu:bone, hu:skin or hu:lung, not '%s'",
                         text);
    }
    *out = found;
    return HEWN_OK;
}

/* Parts that hold whole numbers each; their borders are half way between two. */
static hewn_result find_otsu(const hewn_iso *iso, const hewn_volume *volume, uint64_t frame,
                             const hewn_volume_range *range, double *out, hewn_error *error)
{
    hewn_volume_histogram histogram;
    double lo = range->sample_lo, hi = range->sample_hi;
    uint32_t count = PARTS;
    if (hewn_voxel_is_integer(volume->type)) {
        double width = ceil((hi - lo + 1) / PARTS);
        count = (uint32_t)ceil((hi - lo + 1) / width);
        lo -= 0.5;
        hi = lo + width * count;
    }
    HEWN_TRY(hewn_volume_find_histogram(volume, frame, lo, hi, count, &histogram, error));
    /* A negative slope turns the classes around. */
    uint32_t threshold = volume->slope < 0 ? iso->classes - iso->threshold : iso->threshold;
    hewn_result result = hewn_otsu(&histogram, threshold, iso->classes, out, error);
    hewn_volume_histogram_destroy(&histogram);
    *out = volume->slope * *out + volume->intercept;
    return result;
}

hewn_result hewn_iso_find(const hewn_iso *iso, const hewn_volume *volume, uint64_t frame, double *out,
                          hewn_error *error)
{
    double value = iso->number;
    hewn_volume_range range = hewn_volume_find_range(volume, frame);
    *out = 0;
    if (range.finite_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "no value of the volume is finite, so it has no surface");
    if (range.sample_lo == range.sample_hi)
        return hewn_fail(error, HEWN_BAD_INPUT, "all values of the volume are %g, so it has no surface", range.lo);
    if (iso->kind == HEWN_ISO_HOUNSFIELD && !volume->hounsfield && range.lo >= 0)
        return hewn_fail(error, HEWN_BAD_INPUT,
                         "values from %g to %g are not in Hounsfield units: air would be at -1000", range.lo, range.hi);
    if (iso->kind == HEWN_ISO_OTSU)
        HEWN_TRY(find_otsu(iso, volume, frame, &range, &value, error));
    if (iso->kind == HEWN_ISO_PERCENTILE)
        HEWN_TRY(hewn_volume_find_percentile(volume, frame, iso->number, &value, error));
    if (!(value > range.lo && value < range.hi))
        return hewn_fail(error, HEWN_BAD_INPUT,
                         "the iso value %g gives no surface: the values are from %g to %g, and it must lie between",
                         value, range.lo, range.hi);
    *out = value;
    return HEWN_OK;
}
