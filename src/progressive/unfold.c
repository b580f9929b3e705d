/* Meshes on the way: splits done from the base on. */
#include <string.h>

#include "base/alloc.h"
#include "progressive/stream.h"

/* The wedges of the triangles that are there after so many splits; the caller's. */
static uint32_t *unfold_wedges(const hewn_progressive *from, uint64_t splits)
{
    const size_t corners = 3 * (size_t)progressive_triangles_at(from, splits);
    uint32_t *wedges = hewn_alloc(corners, sizeof *wedges);
    if (!wedges)
        return NULL;
    if (corners > 0)
        memcpy(wedges, from->triangles, corners * sizeof *wedges);
    const uint32_t changes = progressive_changes_at(from, splits);
    for (uint32_t i = 0; i < changes; i++)
        wedges[from->changes[i].corner] = from->changes[i].after;
    return wedges;
}

/* Room for a model of so many elements with the channels of the stream. */
static hewn_result begin_model(const hewn_progressive *from, uint64_t vertices, uint64_t faces, uint64_t corners,
                               hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){.vertex_count = vertices,
                        .face_count = faces,
                        .unit = from->shape.unit,
                        .up = from->shape.up,
                        .up_known = from->shape.up_known};
    out->positions = hewn_alloc(vertices, 3 * sizeof *out->positions);
    out->corners = hewn_alloc(corners, sizeof *out->corners);
    if (!out->positions || !out->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles", (unsigned long long)faces);
    return HEWN_OK;
}

/* Once `first` is there, so that channels of corners get their size. */
static hewn_result add_channels(const hewn_progressive *from, hewn_model *out, hewn_error *error)
{
    for (uint32_t i = 0; i < from->shape.channel_count; i++) {
        const hewn_channel *channel = &from->shape.channels[i];
        hewn_channel *copy;
        int32_t value;
        HEWN_TRY(hewn_model_add_channel(out, &channel->info, &copy, error));
        for (uint32_t n = 0; n < channel->name_count; n++)
            HEWN_TRY(hewn_channel_value(copy, channel->names[n], &value, error));
    }
    return HEWN_OK;
}

static void put_vertex(const hewn_progressive *from, uint32_t v, uint64_t to, hewn_model *out)
{
    memcpy(out->positions + 3 * to, from->positions + 3 * (size_t)v, 3 * sizeof(double));
    if (from->row[HEWN_DOMAIN_VERT] > 0)
        hewn_progressive_row_put(out, HEWN_DOMAIN_VERT, to,
                                 from->vertex_rows + (size_t)v * from->row[HEWN_DOMAIN_VERT]);
}

static void put_corner(const hewn_progressive *from, uint32_t wedge, uint64_t to, hewn_model *out)
{
    if (from->corner_values)
        hewn_progressive_row_put(out, HEWN_DOMAIN_CORNER, to,
                                 from->wedge_rows + (size_t)wedge * from->row[HEWN_DOMAIN_CORNER]);
}

static void put_face(const hewn_progressive *from, const unsigned char *rows, uint64_t row, uint64_t to,
                     hewn_model *out)
{
    if (from->row[HEWN_DOMAIN_FACE] > 0)
        hewn_progressive_row_put(out, HEWN_DOMAIN_FACE, to, rows + row * from->row[HEWN_DOMAIN_FACE]);
}

/* --- in the order of the stream ----------------------------------------------------------------------------------- */

static hewn_result unfold_part(const hewn_progressive *from, uint64_t splits, hewn_model *out, hewn_error *error)
{
    const uint64_t vertices = from->base_vertices + splits, triangles = progressive_triangles_at(from, splits);
    HEWN_TRY(begin_model(from, vertices, triangles, 3 * triangles, out, error));
    HEWN_TRY(add_channels(from, out, error));
    uint32_t *wedges = unfold_wedges(from, splits);
    if (!wedges)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles", (unsigned long long)triangles);
    for (uint32_t v = 0; v < vertices; v++)
        put_vertex(from, v, v, out);
    for (uint64_t c = 0; c < 3 * triangles; c++) {
        out->corners[c] = from->wedge_vertices[wedges[c]];
        put_corner(from, wedges[c], c, out);
    }
    for (uint64_t t = 0; t < triangles; t++)
        put_face(from, from->triangle_rows, t, t, out);
    hewn_free(wedges);
    return HEWN_OK;
}

hewn_result hewn_progressive_gather(const hewn_progressive *from, const uint32_t *wedges, const uint8_t *marked,
                                    hewn_model *out, hewn_error *error)
{
    uint32_t *numbers = hewn_alloc(from->vertex_count, sizeof *numbers);
    uint64_t vertices = 0, triangles = 0;
    if (!numbers)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a refined mesh");
    memset(numbers, 0xff, from->vertex_count * sizeof *numbers);
    for (size_t t = 0; t < from->triangle_count; t++) {
        for (size_t k = 0; marked[t] && k < 3; k++)
            numbers[from->wedge_vertices[wedges[3 * t + k]]] = 0;
        triangles += marked[t];
    }
    for (size_t v = 0; v < from->vertex_count; v++)
        if (numbers[v] == 0)
            numbers[v] = (uint32_t)vertices++;
    hewn_result result = begin_model(from, vertices, triangles, 3 * triangles, out, error);
    if (result == HEWN_OK)
        result = add_channels(from, out, error);
    for (uint32_t v = 0; result == HEWN_OK && v < from->vertex_count; v++)
        if (numbers[v] != HEWN_NONE)
            put_vertex(from, v, numbers[v], out);
    for (size_t t = 0, to = 0; result == HEWN_OK && t < from->triangle_count; t++) {
        if (!marked[t])
            continue;
        for (size_t k = 0; k < 3; k++) {
            out->corners[3 * to + k] = numbers[from->wedge_vertices[wedges[3 * t + k]]];
            put_corner(from, wedges[3 * t + k], 3 * to + k, out);
        }
        put_face(from, from->triangle_rows, t, to++, out);
    }
    hewn_free(numbers);
    return result;
}

/* --- in the input's own order ------------------------------------------------------------------------------------- */

static void put_polygons(const hewn_progressive *from, hewn_model *out)
{
    for (uint64_t c = 0; c < from->corners; c++) {
        const uint32_t wedge = from->polygon_wedges[c];
        out->corners[c] = from->vertex_origins[from->wedge_vertices[wedge]];
        put_corner(from, wedge, c, out);
    }
    for (uint64_t f = 0; f < from->faces; f++)
        put_face(from, from->polygon_rows, f, f, out);
}

static hewn_result put_triangles(const hewn_progressive *from, hewn_model *out, hewn_error *error)
{
    uint32_t *wedges = unfold_wedges(from, from->split_count);
    if (!wedges)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles",
                         (unsigned long long)from->triangle_count);
    for (size_t t = 0; t < from->triangle_count; t++) {
        const uint64_t to = from->triangle_origins[t];
        for (size_t k = 0; k < 3; k++) {
            out->corners[3 * to + k] = from->vertex_origins[from->wedge_vertices[wedges[3 * t + k]]];
            put_corner(from, wedges[3 * t + k], 3 * to + k, out);
        }
        put_face(from, from->triangle_rows, t, to, out);
    }
    hewn_free(wedges);
    return HEWN_OK;
}

static hewn_result unfold_all(const hewn_progressive *from, hewn_model *out, hewn_error *error)
{
    HEWN_TRY(begin_model(from, from->vertex_count, from->faces, from->corners, out, error));
    if (from->polygons) {
        out->first = hewn_alloc(from->faces + 1, sizeof *out->first);
        if (!out->first)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu faces",
                             (unsigned long long)from->faces);
        memcpy(out->first, from->polygon_first, (from->faces + 1) * sizeof *out->first);
    }
    HEWN_TRY(add_channels(from, out, error));
    for (uint32_t v = 0; v < from->vertex_count; v++)
        put_vertex(from, v, from->vertex_origins[v], out);
    if (!from->polygons)
        return put_triangles(from, out, error);
    put_polygons(from, out);
    return HEWN_OK;
}

static hewn_result check_splits(const hewn_progressive *from, uint64_t splits, hewn_error *error)
{
    if (splits <= from->split_count)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there are %llu splits, not %llu",
                     (unsigned long long)from->split_count, (unsigned long long)splits);
}

hewn_result hewn_progressive_model(const hewn_progressive *progressive, uint64_t splits, hewn_model *out,
                                   hewn_error *error)
{
    *out = (hewn_model){0};
    HEWN_TRY(check_splits(progressive, splits, error));
    const bool all = progressive->complete && splits == progressive->full_splits;
    hewn_result result = all ? unfold_all(progressive, out, error) : unfold_part(progressive, splits, out, error);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}

hewn_result hewn_progressive_geomorph(const hewn_progressive *progressive, uint64_t coarse, uint64_t fine,
                                      hewn_model *out, uint32_t **ancestors, hewn_error *error)
{
    *out = (hewn_model){0};
    *ancestors = NULL;
    HEWN_TRY(check_splits(progressive, fine, error));
    if (coarse > fine)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a geomorph goes from coarse to fine, not from %llu to %llu",
                         (unsigned long long)coarse, (unsigned long long)fine);
    const size_t kept = progressive->base_vertices + (size_t)coarse, all = progressive->base_vertices + (size_t)fine;
    hewn_result result = unfold_part(progressive, fine, out, error);
    if (result == HEWN_OK && !(*ancestors = hewn_alloc(all, sizeof **ancestors)))
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a geomorph");
    if (result != HEWN_OK) {
        hewn_model_destroy(out);
        return result;
    }
    for (size_t v = 0; v < all; v++) /* parents come before their children */
        (*ancestors)[v] =
            v < kept ? (uint32_t)v : (*ancestors)[progressive->splits[v - progressive->base_vertices].parent];
    return HEWN_OK;
}

void hewn_progressive_ancestors_free(uint32_t *ancestors)
{
    hewn_free(ancestors);
}
