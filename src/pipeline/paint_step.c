#include "pipeline/paint_step.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/srgb.h"

static const hewn_attribute_info color_info = {"color", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};

static bool has_colors(hewn_mesh_format format)
{
    return format == HEWN_MESH_GLB || format == HEWN_MESH_PLY || format == HEWN_MESH_OBJ || format == HEWN_MESH_OFF;
}

static bool has_labels(hewn_mesh_format format)
{
    return format == HEWN_MESH_GLB || format == HEWN_MESH_PLY;
}

/* --- finding -------------------------------------------------------------------------------------------------------
 */

/* The middle of `corners` corners from `first` on. */
static void middle_of(const hewn_triangles *triangles, const uint32_t *corners, uint32_t count, double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (uint32_t i = 0; i < count; i++)
            out[k] += (double)triangles->positions[3 * (size_t)corners[i] + (size_t)k] / count;
    }
}

static hewn_result find_at_vertices(const hewn_field *field, const hewn_triangles *triangles, hewn_mesh_paint *out,
                                    hewn_error *error)
{
    uint64_t count = triangles->vertex_count;
    int32_t *labels = out->domain == HEWN_DOMAIN_VERT ? out->labels : NULL;
    if (!out->colors && !labels)
        return HEWN_OK;
    double *points = hewn_alloc(count, 3 * sizeof *points);
    if (!points)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for colours");
    for (uint64_t i = 0; i < 3 * count; i++)
        points[i] = (double)triangles->positions[i];
    hewn_result result = hewn_field_paint(field, hewn_field_root(field), points, count, out->colors, labels, error);
    hewn_free(points);
    return result;
}

static hewn_result find_at_faces(const hewn_field *field, const hewn_triangles *triangles, bool quads,
                                 hewn_mesh_paint *out, hewn_error *error)
{
    if (!out->labels || out->domain != HEWN_DOMAIN_FACE)
        return HEWN_OK;
    uint64_t count = triangles->triangle_count / (quads ? 2 : 1);
    double *points = hewn_alloc(count, 3 * sizeof *points);
    if (!points)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for labels");
    for (uint64_t i = 0; i < count; i++) {
        const uint32_t *at = triangles->indices + i * (quads ? 6 : 3);
        const uint32_t corners[4] = {at[0], at[1], at[2], quads ? at[5] : 0};
        middle_of(triangles, corners, quads ? 4 : 3, points + 3 * i);
    }
    hewn_result result = hewn_field_paint(field, hewn_field_root(field), points, count, NULL, out->labels, error);
    hewn_free(points);
    return result;
}

static bool wants_colors(const hewn_field *field, hewn_mesh_format format)
{
    return has_colors(format) && hewn_field_has_colors(field, hewn_field_root(field));
}

static bool wants_labels(const hewn_field *field, hewn_mesh_format format)
{
    return has_labels(format) && hewn_field_has_labels(field, hewn_field_root(field));
}

bool hewn_mesh_paint_wanted(const hewn_field *field, hewn_mesh_format format)
{
    return wants_colors(field, format) || wants_labels(field, format);
}

hewn_result hewn_mesh_paint_find(const hewn_field *field, const hewn_triangles *triangles, bool quads,
                                 hewn_mesh_format format, hewn_mesh_paint *out, hewn_error *error)
{
    bool colors = wants_colors(field, format), labels = wants_labels(field, format);
    uint64_t faces = triangles->triangle_count / (quads ? 2 : 1);
    *out = (hewn_mesh_paint){.domain = format == HEWN_MESH_GLB ? HEWN_DOMAIN_VERT : HEWN_DOMAIN_FACE};
    if (colors)
        out->colors = hewn_alloc(triangles->vertex_count, 3 * sizeof *out->colors);
    if (labels)
        out->labels =
            hewn_alloc(out->domain == HEWN_DOMAIN_VERT ? triangles->vertex_count : faces, sizeof *out->labels);
    hewn_result result = (colors && !out->colors) || (labels && !out->labels)
                             ? hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for colours")
                             : find_at_vertices(field, triangles, out, error);
    if (result == HEWN_OK)
        result = find_at_faces(field, triangles, quads, out, error);
    if (result != HEWN_OK)
        hewn_mesh_paint_destroy(out);
    return result;
}

void hewn_mesh_paint_destroy(hewn_mesh_paint *paint)
{
    hewn_free(paint->colors);
    hewn_free(paint->labels);
    hewn_free(paint->srgb);
    *paint = (hewn_mesh_paint){0};
}

/* --- simplification ------------------------------------------------------------------------------------------------
 */

static hewn_result add(hewn_model *model, const char *name, hewn_domain domain, hewn_scalar scalar, uint32_t components,
                       const void *values, hewn_error *error)
{
    const hewn_attribute_info info = {name, domain, scalar, components};
    hewn_channel *channel;
    if (!values)
        return HEWN_OK;
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    memcpy(channel->values, values, hewn_model_domain_count(model, domain) * components * 4);
    return HEWN_OK;
}

static hewn_result to_model(const hewn_triangles *triangles, const hewn_mesh_paint *paint, hewn_model *out,
                            hewn_error *error)
{
    HEWN_TRY(hewn_model_from_triangles(triangles, out, error));
    HEWN_TRY(add(out, "color", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3, paint->colors, error));
    return add(out, "label", paint->domain, HEWN_SCALAR_INT32, 1, paint->labels, error);
}

/* Takes the values of a channel, which the model then lacks. */
static void *take(hewn_model *model, hewn_domain domain, const char *name)
{
    hewn_channel *channel = hewn_model_find_channel(model, domain, name);
    void *values = channel ? channel->values : NULL;
    if (channel)
        channel->values = NULL;
    return values;
}

hewn_result hewn_mesh_paint_simplify(hewn_triangles *triangles, hewn_mesh_paint *paint, const hewn_simplify_desc *desc,
                                     hewn_simplify_report *report, hewn_error *error)
{
    if (!paint->colors && !paint->labels)
        return hewn_triangles_simplify(triangles, desc, report, error);
    hewn_model model = {0};
    hewn_triangles made = {0};
    hewn_result result = to_model(triangles, paint, &model, error);
    if (result == HEWN_OK)
        result = hewn_model_simplify(&model, desc, report, error);
    if (result == HEWN_OK)
        result = hewn_triangles_from_model(&model, &made, error);
    if (result == HEWN_OK) {
        hewn_domain domain = paint->domain;
        hewn_mesh_paint_destroy(paint);
        *paint = (hewn_mesh_paint){.domain = domain,
                                   .colors = take(&model, HEWN_DOMAIN_VERT, "color"),
                                   .labels = take(&model, domain, "label")};
        hewn_triangles_destroy(triangles);
        *triangles = made;
    }
    hewn_model_destroy(&model);
    return result;
}

/* --- channels ------------------------------------------------------------------------------------------------------
 */

static uint8_t srgb_byte(float linear)
{
    return (uint8_t)lround(255 * hewn_srgb_from_linear(fmin(fmax((double)linear, 0), 1)));
}

hewn_result hewn_mesh_paint_channels(hewn_mesh_paint *paint, hewn_mesh_format format, uint64_t vertex_count,
                                     hewn_channel channels[2], uint32_t *count, hewn_error *error)
{
    *count = 0;
    if (paint->colors) {
        hewn_channel *channel = &channels[(*count)++];
        *channel = (hewn_channel){.info = color_info, .values = paint->colors};
        if (format != HEWN_MESH_GLB) { /* glTF's are linear; elsewhere they are what a screen takes */
            paint->srgb = hewn_alloc(vertex_count, 3);
            if (!paint->srgb)
                return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for colours");
            for (uint64_t i = 0; i < 3 * vertex_count; i++)
                paint->srgb[i] = srgb_byte(paint->colors[i]);
            channel->info.scalar = HEWN_SCALAR_UINT8;
            channel->values = paint->srgb;
        }
    }
    if (paint->labels)
        channels[(*count)++] =
            (hewn_channel){.info = {"label", paint->domain, HEWN_SCALAR_INT32, 1}, .values = paint->labels};
    return HEWN_OK;
}
