/* Hewn: implicit shapes into meshes that can be trusted. This header includes all others. */
#ifndef HEWN_H
#define HEWN_H

#include "hewn/base.h"
#include "hewn/check.h"
#include "hewn/device.h"
#include "hewn/distance.h"
#include "hewn/extract.h"
#include "hewn/field.h"
#include "hewn/file_job.h"
#include "hewn/io.h"
#include "hewn/job.h"
#include "hewn/labels.h"
#include "hewn/mesh.h"
#include "hewn/mesh_views.h"
#include "hewn/model.h"
#include "hewn/picture.h"
#include "hewn/query.h"
#include "hewn/render.h"
#include "hewn/render_job.h"
#include "hewn/repair.h"
#include "hewn/scene.h"
#include "hewn/simplify.h"
#include "hewn/smooth.h"
#include "hewn/subdivide.h"
#include "hewn/triangles.h"
#include "hewn/units.h"
#include "hewn/volume.h"
#include "hewn/volume_extract.h"
#include "hewn/volume_io.h"
#include "hewn/volume_job.h"

#endif
