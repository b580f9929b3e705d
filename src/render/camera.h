/* Cameras made ready for rays. */
#ifndef HEWN_SRC_RENDER_CAMERA_H
#define HEWN_SRC_RENDER_CAMERA_H

#include "render/tracer.h"

typedef struct hewn_lens {
    uint32_t width, height;
    bool parallel;
    double half; /* half the picture's height: in units, or for each unit of the way */
    double eye[3], right[3], upward[3], forward[3];
} hewn_lens;

/* HEWN_INVALID_ARGUMENT for a camera or a size that makes no sense. */
hewn_result hewn_lens_create(const hewn_camera *camera, uint32_t width, uint32_t height, hewn_lens *out,
                             hewn_error *error);

/* Sample 0 is the pixel's middle. */
hewn_ray hewn_lens_ray(const hewn_lens *lens, uint32_t x, uint32_t y, uint32_t sample);

/* 0, 1 or 2. */
int hewn_axis_index(hewn_axis axis);

#endif
