/* What the filters of volumes share. */
#ifndef HEWN_SRC_VOLUME_SMOOTH_H
#define HEWN_SRC_VOLUME_SMOOTH_H

#include "base/progress.h"
#include "hewn/volume.h"

/* What Gaussians and medians give of a frame's samples. `out` has the type and room for all of them. `desc` is right
 * but for what each of them says itself. */
hewn_result hewn_volume_gaussian(const hewn_volume *volume, const hewn_volume_smooth_desc *desc, hewn_volume *out,
                                 hewn_error *error);
hewn_result hewn_volume_median(const hewn_volume *volume, const hewn_volume_smooth_desc *desc, hewn_volume *out,
                               hewn_error *error);

static inline hewn_result hewn_volume_filter_told(const hewn_volume_smooth_desc *desc, double share, hewn_error *error)
{
    return hewn_progress_report(desc->progress, "filter", share, error);
}

#endif
