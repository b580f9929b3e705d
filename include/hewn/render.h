/* Pictures of fields and triangles. */
#ifndef HEWN_RENDER_H
#define HEWN_RENDER_H

#include "hewn/device.h"
#include "hewn/field.h"
#include "hewn/picture.h"
#include "hewn/triangles.h"
#include "hewn/units.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A pinhole, or a parallel projection. Lengths are in scene units. */
typedef struct hewn_camera {
    double eye[3];
    double target[3]; /* in the middle of the picture */
    double up[3];     /* what is upward in the picture; need not be at right angles to the view */
    double fov;       /* degrees from the bottom to the top of the picture, below 180; 0: parallel */
    double height;    /* of a parallel projection: how much of the scene fits from bottom to top */
} hewn_camera;

typedef enum hewn_view {
    HEWN_VIEW_ISO, /* from the front right, above */
    HEWN_VIEW_FRONT,
    HEWN_VIEW_BACK,
    HEWN_VIEW_LEFT,
    HEWN_VIEW_RIGHT,
    HEWN_VIEW_TOP,
    HEWN_VIEW_BOTTOM
} hewn_view;

/* A camera that sees all of a box from there, in a picture of that width and height. `up` is the axis that points
 * upward; with +Z up the front looks along +Y, with +Y or +X up along -Z. ISO is a pinhole of 30 degrees, the others
 * are parallel projections. */
HEWN_API hewn_camera hewn_camera_of_view(hewn_view view, const hewn_box *box, hewn_axis up, double width,
                                         double height);

/* "iso", "front" and so on; false for any other name. */
HEWN_API bool hewn_view_named(const char *name, hewn_view *out);

typedef enum hewn_render_method {
    HEWN_RENDER_TRACE,  /* lit, with soft shadows, ambient occlusion and a ground */
    HEWN_RENDER_DEPTH,  /* distance from the camera's plane (through its eye, at right angles to the view); NaN: nothing
                         */
    HEWN_RENDER_NORMALS /* unit normals in scene coordinates; 0: nothing */
} hewn_render_method;

/* Zero everywhere but the camera is a sensible default. */
typedef struct hewn_render_desc {
    hewn_camera camera;
    uint32_t width, height; /* 0: 1280 and 720; at most 16,384 each */
    uint32_t samples;       /* of a pixel at most, where the picture changes; 0: 4; at most 64. TRACE only */
    hewn_render_method method;
    hewn_axis up;
    bool no_ground;            /* TRACE only: nothing below, and no shadow on it */
    float colour[3];           /* of the surface, linear; all 0: a light grey */
    const hewn_field *painted; /* or NULL: what has the surface's colours (hewn_color()) where `colour` is all 0, and
                                  its root; for a renderer of a field mostly that field */
    hewn_node painted_root;
    const float *corner_colors; /* or NULL; for a renderer of triangles: their corners' colours, linear, nine numbers a
                                   triangle, where `colour` is all 0 */
    const hewn_progress *progress; /* or NULL; the stage is "render" */
} hewn_render_desc;

typedef struct hewn_render_stats {
    uint64_t rays;    /* from the camera */
    uint64_t hits;    /* that met the surface */
    uint64_t ran_out; /* that took too many steps; they count as hits where they stood */
    bool on_host;     /* rays were followed by the host's processors */
    double prepare_seconds, trace_seconds, shade_seconds;
} hewn_render_stats;

typedef struct hewn_renderer hewn_renderer;

/* For a field inside of a box; where the box cuts the solid it is shown with a flat cap. The field may be changed or
 * destroyed afterwards. The device must outlive the renderer. A field of so many operations that devices would walk
 * over lists of them is rendered on the host, where `device` may be NULL; and where `device` is NULL all are. Serves
 * one thread at a time. HEWN_INVALID_ARGUMENT for a box without inside; device errors. */
HEWN_API hewn_result hewn_renderer_of_field(hewn_device *device, const hewn_field *field, hewn_node root,
                                            const hewn_box *box, hewn_renderer **out, hewn_error *error);

/* For triangles, which must outlive it; both sides are shown. Always on the host. HEWN_BAD_INPUT where there are none,
 * an index is out of range or a position not finite. */
HEWN_API hewn_result hewn_renderer_of_triangles(const hewn_triangles *triangles, hewn_renderer **out,
                                                hewn_error *error);
HEWN_API void hewn_renderer_destroy(hewn_renderer **renderer);

/* The box that was given, or that of the triangles. */
HEWN_API hewn_box hewn_renderer_box(const hewn_renderer *renderer);

/* Renders. The picture is the same on every run on one device, for any number of threads. `stats` may be NULL.
 * HEWN_INVALID_ARGUMENT for a camera or size that makes no sense; HEWN_CANCELLED; HEWN_OUT_OF_MEMORY; device errors. */
HEWN_API hewn_result hewn_render(hewn_renderer *renderer, const hewn_render_desc *desc, hewn_picture *out,
                                 hewn_render_stats *stats, hewn_error *error);

/* A plane of a field, z constant, as a picture: what is inside (value below 0) is white, the rest black, without grey
 * between. Rows from `hi[1]` at the top, samples in the middles of pixels. */
typedef struct hewn_plane_desc {
    double lo[2], hi[2], z;
    uint32_t width, height;
    bool values; /* the field's values as a scalar picture instead */
    const hewn_progress *progress;
} hewn_plane_desc;

/* How much of the field a pixel costs: interval bounds cut it down to what matters in each tile. */
typedef struct hewn_plane_stats {
    uint64_t operations;       /* of the whole field */
    double operations_a_pixel; /* that were evaluated, on average over all pixels */
    double bounds_a_pixel;     /* bounds of operations that were evaluated */
    double filled;             /* share of pixels in tiles that bounds decided */
} hewn_plane_stats;

/* On the host. Every pixel is what evaluating the whole field there in float gives. HEWN_INVALID_ARGUMENT,
 * HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
HEWN_API hewn_result hewn_render_plane(const hewn_field *field, hewn_node root, const hewn_plane_desc *desc,
                                       hewn_picture *out, hewn_plane_stats *stats, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
