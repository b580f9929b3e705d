/* The report of a job that ends in a volume file, as JSON. */
#ifndef HEWN_SRC_PIPELINE_VOXELIZE_REPORT_H
#define HEWN_SRC_PIPELINE_VOXELIZE_REPORT_H

#include "hewn/voxelize_job.h"

hewn_result hewn_voxelize_report_write(const hewn_voxelize_report *report, const char *path, hewn_error *error);

#endif
