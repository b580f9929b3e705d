#include "volume/otsu.h"

#include "base/alloc.h"
#include "base/error.h"

/* The parts that hold anything, `count` of them, and sums up to each. The greatest variance between classes is where
 * the sum over classes of (sum of values)^2 / (number of values) is greatest. */
typedef struct levels {
    uint32_t count;
    uint32_t *bin;        /* which part */
    double *number, *sum; /* of all levels before this one; count + 1 */
    double *best;         /* [class][levels taken]: the greatest sum so far; */
    uint32_t *from;       /* and where its last class begins */
} levels;

static void destroy_levels(levels *all)
{
    hewn_free(all->bin);
    hewn_free(all->number);
    hewn_free(all->sum);
    hewn_free(all->best);
    hewn_free(all->from);
}

static hewn_result make_levels(const hewn_volume_histogram *histogram, uint32_t classes, levels *all, hewn_error *error)
{
    size_t room = (size_t)histogram->count + 1;
    *all = (levels){0};
    all->bin = hewn_alloc(room, sizeof *all->bin);
    all->number = hewn_alloc(room, sizeof *all->number);
    all->sum = hewn_alloc(room, sizeof *all->sum);
    all->best = hewn_alloc(room * classes, sizeof *all->best);
    all->from = hewn_alloc(room * classes, sizeof *all->from);
    if (!all->bin || !all->number || !all->sum || !all->best || !all->from)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for thresholds");
    all->number[0] = all->sum[0] = 0;
    for (uint32_t bin = 0; bin < histogram->count; bin++) {
        if (histogram->bins[bin] == 0)
            continue;
        double number = (double)histogram->bins[bin];
        all->bin[all->count] = bin;
        all->number[all->count + 1] = all->number[all->count] + number;
        all->sum[all->count + 1] = all->sum[all->count] + number * ((double)bin + 0.5);
        all->count++;
    }
    if (all->count < classes)
        return hewn_fail(error, HEWN_BAD_INPUT, "%u different values cannot be parted into %u classes", all->count,
                         classes);
    return HEWN_OK;
}

static double share_of(const levels *all, uint32_t begin, uint32_t end)
{
    double sum = all->sum[end] - all->sum[begin];
    return sum * sum / (all->number[end] - all->number[begin]);
}

/* Dynamic programming: the best partition of the first `end` levels into `class` + 1 classes. */
static void solve(levels *all, uint32_t classes)
{
    uint32_t row = all->count + 1;
    for (uint32_t class = 0; class < classes; class ++) {
        for (uint32_t end = class + 1; end <= all->count; end++) {
            double most = -1;
            uint32_t from = class;
            for (uint32_t begin = class; begin < end && (class > 0 || begin == 0); begin++) {
                double before = class > 0 ? all->best[(size_t)(class - 1) * row + begin] : 0;
                double sum = before + share_of(all, begin, end);
                if (sum > most) {
                    most = sum;
                    from = begin;
                }
            }
            all->best[(size_t) class * row + end] = most;
            all->from[(size_t) class * row + end] = from;
        }
    }
}

hewn_result hewn_otsu(const hewn_volume_histogram *histogram, uint32_t threshold, uint32_t classes, double *out,
                      hewn_error *error)
{
    levels all;
    hewn_result result = make_levels(histogram, classes, &all, error);
    *out = 0;
    if (result == HEWN_OK) {
        solve(&all, classes);
        uint32_t at = all.count;
        for (uint32_t class = classes - 1; class >= threshold; class --)
            at = all.from[(size_t) class * (all.count + 1) + at];
        /* Between the upper end of the level below and the lower end of the one above. */
        double part = (histogram->hi - histogram->lo) / histogram->count;
        *out = histogram->lo + part * (((double)all.bin[at - 1] + 1 + (double)all.bin[at]) / 2);
    }
    destroy_levels(&all);
    return result;
}
