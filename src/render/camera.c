#include "render/camera.h"

#include <math.h>
#include <string.h>

#include "base/error.h"

enum { MOST_PIXELS = 16384 };

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static bool normalise(double v[3])
{
    double length = sqrt(dot(v, v));
    if (!(length > 0) || !isfinite(length))
        return false;
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return true;
}

int hewn_axis_index(hewn_axis axis)
{
    return axis == HEWN_AXIS_PLUS_X ? 0 : axis == HEWN_AXIS_PLUS_Y ? 1 : 2;
}

/* --- views ----------------------------------------------------------------------------------------------------------
 */

static const char *const names[] = {"iso", "front", "back", "left", "right", "top", "bottom"};

bool hewn_view_named(const char *name, hewn_view *out)
{
    for (int i = 0; i < (int)(sizeof names / sizeof *names); i++)
        if (strcmp(name, names[i]) == 0) {
            *out = (hewn_view)i;
            return true;
        }
    return false;
}

/* Where the viewer is, seen from the middle, and what is upward in the picture. */
static void choose_direction(hewn_view view, hewn_axis axis, double back[3], double up[3])
{
    double top[3] = {0, 0, 0}, front[3] = {0, 0, 0}, right[3];
    top[hewn_axis_index(axis)] = 1;
    front[axis == HEWN_AXIS_PLUS_Z ? 1 : 2] = axis == HEWN_AXIS_PLUS_Z ? -1 : 1;
    cross(top, front, right);
    for (int i = 0; i < 3; i++) {
        up[i] = view == HEWN_VIEW_TOP ? -front[i] : view == HEWN_VIEW_BOTTOM ? front[i] : top[i];
        switch (view) {
        case HEWN_VIEW_FRONT: back[i] = front[i]; break;
        case HEWN_VIEW_BACK: back[i] = -front[i]; break;
        case HEWN_VIEW_LEFT: back[i] = -right[i]; break;
        case HEWN_VIEW_RIGHT: back[i] = right[i]; break;
        case HEWN_VIEW_TOP: back[i] = top[i]; break;
        case HEWN_VIEW_BOTTOM: back[i] = -top[i]; break;
        default: back[i] = 0.62 * right[i] + front[i] + 0.72 * top[i];
        }
    }
    (void)normalise(back);
}

/* Where a box's corners lie in the picture: `side` and `height` of its middle, for each unit of the way of a pinhole.
 */
typedef struct frame {
    double lo[2], hi[2]; /* sideways, upward */
} frame;

static frame frame_of(const hewn_box *box, const hewn_camera *camera, const double right[3], const double upward[3],
                      const double back[3])
{
    frame out = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int i = 0; i < 3; i++)
            p[i] = (corner >> i & 1 ? box->hi[i] : box->lo[i]) - camera->eye[i];
        double way = camera->fov > 0 ? -dot(p, back) : 1;
        const double at[2] = {dot(p, right) / way, dot(p, upward) / way};
        for (int i = 0; i < 2; i++) {
            out.lo[i] = fmin(out.lo[i], at[i]);
            out.hi[i] = fmax(out.hi[i], at[i]);
        }
    }
    return out;
}

hewn_camera hewn_camera_of_view(hewn_view view, const hewn_box *box, hewn_axis up, double width, double height)
{
    enum { ROUNDS = 24 };
    const double rim = 0.9, fov = view == HEWN_VIEW_ISO ? 30 : 0, steep = tan(fov / 2 * M_PI / 180);
    double back[3], right[3], upward[3], size = 0;
    hewn_camera camera = {.fov = fov};
    choose_direction(view, up, back, camera.up);
    cross(camera.up, back, right);
    (void)normalise(right);
    cross(back, right, upward);
    for (int i = 0; i < 3; i++) {
        camera.target[i] = 0.5 * (box->lo[i] + box->hi[i]);
        size += (box->hi[i] - box->lo[i]) * (box->hi[i] - box->lo[i]);
    }
    double distance = sqrt(size) * (fov > 0 ? 1 / steep : 1);
    for (int round = 0; round <= ROUNDS; round++) {
        for (int i = 0; i < 3; i++)
            camera.eye[i] = camera.target[i] + distance * back[i];
        frame seen = frame_of(box, &camera, right, upward, back);
        double side = seen.hi[0] - seen.lo[0], rise = seen.hi[1] - seen.lo[1];
        double fills = fmax(side * height / width, rise) / 2;
        camera.height = 2 * fills / rim;
        if (fov == 0 || round == ROUNDS)
            break;
        /* To the middle of what is seen, and as near as all of it fits. */
        for (int i = 0; i < 3; i++)
            camera.target[i] +=
                distance * (0.5 * (seen.lo[0] + seen.hi[0]) * right[i] + 0.5 * (seen.lo[1] + seen.hi[1]) * upward[i]);
        distance = fmax(distance * fmin(fills / (rim * steep), 1.2), 0.51 * sqrt(size) * (1 + steep));
    }
    return camera;
}

/* --- rays -----------------------------------------------------------------------------------------------------------
 */

static bool is_finite(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

hewn_result hewn_lens_create(const hewn_camera *camera, uint32_t width, uint32_t height, hewn_lens *out,
                             hewn_error *error)
{
    *out = (hewn_lens){.width = width, .height = height};
    if (width < 1 || height < 1 || width > MOST_PIXELS || height > MOST_PIXELS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a picture has 1 to %d pixels a side, not %u x %u", MOST_PIXELS,
                         width, height);
    if (!is_finite(camera->eye) || !is_finite(camera->target) || !is_finite(camera->up))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the camera's place is not finite");
    if (!(camera->fov >= 0 && camera->fov < 180))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a field of view of %g degrees makes no sense", camera->fov);
    if (camera->fov == 0 && !(camera->height > 0 && isfinite(camera->height)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a parallel projection of height %g makes no sense",
                         camera->height);
    for (int i = 0; i < 3; i++) {
        out->eye[i] = camera->eye[i];
        out->forward[i] = camera->target[i] - camera->eye[i];
    }
    if (!normalise(out->forward))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the camera's eye is at its target");
    cross(out->forward, camera->up, out->right);
    if (!normalise(out->right))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the camera looks along its own up direction");
    cross(out->right, out->forward, out->upward);
    out->parallel = camera->fov == 0;
    out->half = out->parallel ? 0.5 * camera->height : tan(camera->fov / 2 * M_PI / 180);
    return HEWN_OK;
}

/* Sample k's place in a pixel: its middle, and then points that fill it evenly (Roberts 2018, the R2 sequence). */
static void place_sample(uint32_t k, double *x, double *y)
{
    double a = 0.5 + k * 0.7548776662466927, b = 0.5 + k * 0.5698402909980532;
    *x = a - floor(a);
    *y = b - floor(b);
}

/* Not 0, so that one can divide by it. */
static float component(double value)
{
    return fabs(value) < 1e-12 ? 1e-12F : (float)value;
}

hewn_ray hewn_lens_ray(const hewn_lens *lens, uint32_t x, uint32_t y, uint32_t sample)
{
    double dx, dy, along[3];
    place_sample(sample, &dx, &dy);
    double u = lens->half * (2 * (x + dx) - lens->width) / lens->height;
    double v = lens->half * (lens->height - 2 * (y + dy)) / lens->height;
    hewn_ray ray = {.begin = 0, .end = 1e30F};
    for (int i = 0; i < 3; i++) {
        double aside = u * lens->right[i] + v * lens->upward[i];
        along[i] = lens->forward[i] + (lens->parallel ? 0 : aside);
        ray.from[i] = (float)(lens->eye[i] + (lens->parallel ? aside : 0));
    }
    (void)normalise(along);
    for (int i = 0; i < 3; i++)
        ray.along[i] = component(along[i]);
    return ray;
}
