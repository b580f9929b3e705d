/* Mesh files into samplings, doubtful ones better after repair. */
#ifndef HEWN_SRC_PIPELINE_MESH_SAMPLES_H
#define HEWN_SRC_PIPELINE_MESH_SAMPLES_H

#include "hewn/model.h"
#include "hewn/voxelize.h"

hewn_result hewn_mesh_samples(const hewn_model *model, const hewn_mesh_sampling_desc *desc, hewn_sampling **out,
                              hewn_sampling_place *place, hewn_mesh_sampling_report *report, hewn_error *error);

#endif
