#include <math.h>

#include "base/error.h"
#include "base/progress.h"
#include "mesh/soup.h"

hewn_repair_desc hewn_repair_desc_default(void)
{
    return (hewn_repair_desc){.opposite = HEWN_OPPOSITE_ONE, .outward = HEWN_OUTWARD_TURNED};
}

static hewn_result check_desc(const hewn_repair_desc *desc, hewn_error *error)
{
    if (!(desc->weld_distance >= 0) || !isfinite(desc->weld_distance))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a weld distance of %g", desc->weld_distance);
    if (!(desc->least_share >= 0 && desc->least_share <= 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a least share of the box of %g is not from 0 to 1",
                         desc->least_share);
    if (desc->fill_edges > HEWN_FILL_LIMIT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "holes of up to %u edges can be filled, not %u", HEWN_FILL_LIMIT,
                         desc->fill_edges);
    if ((unsigned)desc->opposite >= HEWN_OPPOSITE_COUNT || (unsigned)desc->outward >= HEWN_OUTWARD_COUNT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an unknown rule for faces that lie on each other or point out");
    return HEWN_OK;
}

hewn_result hewn_soup_repair(hewn_soup *soup, const hewn_repair_desc *desc, hewn_repair_report *report,
                             hewn_error *error)
{
    HEWN_TRY(check_desc(desc, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "repair", 0, error));
    if (desc->weld)
        HEWN_TRY(hewn_soup_weld(soup, desc->weld_distance, report, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "repair", 0.1, error));
    HEWN_TRY(hewn_soup_clean(soup, desc->drop_flat, desc->strict, report, error));
    HEWN_TRY(hewn_soup_drop_duplicates(soup, desc->opposite, desc->strict, report, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "repair", 0.2, error));
    if (!desc->keep_directions)
        HEWN_TRY(hewn_soup_orient(soup, desc->strict, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "repair", 0.3, error));
    HEWN_TRY(hewn_soup_stitch(soup, desc->strict, report, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "repair", 0.4, error));
    if (desc->least_faces > 0 || desc->least_share > 0)
        HEWN_TRY(hewn_soup_drop_islands(soup, desc->least_faces, desc->least_share, desc->strict, report, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "repair", 0.5, error));
    if (desc->fill_edges > 0)
        HEWN_TRY(hewn_soup_fill(soup, desc->fill_edges, desc->fill_flat, desc->strict, desc->progress, report, error));
    HEWN_TRY(hewn_soup_turn_outward(soup, desc->outward, report, error));
    for (uint32_t f = 0; f < soup->face_count; f++)
        report->turned_faces += soup->turned[f];
    if (!desc->keep_isolated)
        HEWN_TRY(hewn_soup_drop_isolated(soup, report, error));
    return hewn_progress_report(desc->progress, "repair", 1, error);
}
