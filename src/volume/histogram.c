#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "volume/voxel.h"

void hewn_volume_histogram_destroy(hewn_volume_histogram *histogram)
{
    hewn_free(histogram->bins);
    *histogram = (hewn_volume_histogram){0};
}

/* The stretches of one of `parts` shares of the frame, into bins of its own. */
static void count_share(const hewn_volume *volume, uint64_t frame, uint64_t part, uint64_t parts,
                        const hewn_volume_histogram *wanted, uint64_t *bins)
{
    uint64_t stretches = hewn_volume_stretches(volume);
    double lo = wanted->lo, hi = wanted->hi, width = hi - lo, scale = wanted->count;
    for (uint64_t index = stretches * part / parts; index < stretches * (part + 1) / parts; index++) {
        double samples[HEWN_VOXEL_STRETCH];
        uint64_t weight;
        size_t count = hewn_volume_stretch(volume, frame, index, samples, &weight);
        for (size_t i = 0; i < count; i++) {
            if (!(samples[i] >= lo && samples[i] <= hi))
                continue;
            uint32_t bin = (uint32_t)((samples[i] - lo) / width * scale);
            bins[bin < wanted->count ? bin : wanted->count - 1] += weight;
        }
    }
}

hewn_result hewn_volume_find_histogram(const hewn_volume *volume, uint64_t frame, double lo, double hi, uint32_t count,
                                       hewn_volume_histogram *out, hewn_error *error)
{
    enum { PARTS = 4 }; /* a table each; sums of whole numbers do not depend on how many */
    *out = (hewn_volume_histogram){0};
    if (!(lo < hi) || !isfinite(hi - lo) || count == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a histogram of %u parts from %g to %g is none", count, lo, hi);
    uint64_t *tables = hewn_alloc_zero((size_t)PARTS * count, sizeof *tables);
    out->bins = hewn_alloc_zero(count, sizeof *out->bins);
    if (!tables || !out->bins) {
        hewn_free(tables);
        hewn_volume_histogram_destroy(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a histogram of %u parts", count);
    }
    out->lo = lo;
    out->hi = hi;
    out->count = count;
#pragma omp parallel for schedule(static) if (hewn_volume_stretches(volume) >= HEWN_VOXEL_ALONE)
    for (int part = 0; part < PARTS; part++)
        count_share(volume, frame, (uint64_t)part, PARTS, out, tables + (size_t)part * count);
    for (uint32_t bin = 0; bin < count; bin++) {
        for (size_t part = 0; part < PARTS; part++)
            out->bins[bin] += tables[part * count + bin];
        out->total += out->bins[bin];
    }
    hewn_free(tables);
    return HEWN_OK;
}
