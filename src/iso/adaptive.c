#include "iso/adaptive.h"

#include <math.h>

#include "base/progress.h"
#include "iso/cluster_passes.h"

/* What solving and rounding leave on a plane face, in cells. */
#define ROUNDING 1e-4

static hewn_result collapse(hewn_clusters *clusters, const hewn_progress *progress, hewn_triangles *out,
                            hewn_adaptive_stats *stats, hewn_error *error)
{
    HEWN_TRY(hewn_clusters_merge_octree(clusters, progress, stats, error));
    HEWN_TRY(hewn_progress_report(progress, "collapse", 0.6, error));
    HEWN_TRY(hewn_clusters_merge_pairs(clusters, progress, stats, error));
    HEWN_TRY(hewn_progress_report(progress, "collapse", 0.9, error));
    return hewn_clusters_triangulate(clusters, out, stats, error);
}

hewn_result hewn_adaptive_collapse(const hewn_dual_surface *surface, double error_length, const hewn_progress *progress,
                                   hewn_triangles *out, hewn_adaptive_stats *stats, hewn_error *error)
{
    hewn_adaptive_stats unwanted;
    hewn_clusters clusters;
    stats = stats ? stats : &unwanted;
    *stats = (hewn_adaptive_stats){0};
    *out = (hewn_triangles){0};
    if (!(error_length >= 0) || !isfinite(error_length))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an error of %g makes no sense; it is a length, at least 0",
                         error_length);
    HEWN_TRY(hewn_progress_report(progress, "collapse", 0, error));
    if (surface->quad_count == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_clusters_create(surface, error_length + ROUNDING * (double)surface->grid.cell, &clusters, error));
    hewn_result result = collapse(&clusters, progress, out, stats, error);
    hewn_clusters_free(&clusters);
    return result;
}
