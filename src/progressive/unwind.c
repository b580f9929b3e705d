/* What was folded, as a stream from coarse to fine. */
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "progressive/fold.h"

/* Numbers in the stream of the model's vertices, wedges and triangles. */
typedef struct numbers {
    uint32_t *vertices, *wedges, *triangles;
    uint32_t *wedge_first, *wedge_lists; /* the wedges of each vertex, in order */
} numbers;

static void release(numbers *of)
{
    hewn_free(of->vertices);
    hewn_free(of->wedges);
    hewn_free(of->triangles);
    hewn_free(of->wedge_first);
    hewn_free(of->wedge_lists);
}

static hewn_result no_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
}

static hewn_result begin_numbers(const fold *of, numbers *out, hewn_error *error)
{
    out->vertices = hewn_alloc(of->vertex_count, sizeof *out->vertices);
    out->wedges = hewn_alloc(of->wedge_count, sizeof *out->wedges);
    out->triangles = hewn_alloc(of->triangle_count, sizeof *out->triangles);
    out->wedge_first = hewn_alloc_zero((size_t)of->vertex_count + 1, sizeof *out->wedge_first);
    out->wedge_lists = hewn_alloc(of->wedge_count, sizeof *out->wedge_lists);
    if (!out->vertices || !out->wedges || !out->triangles || !out->wedge_first || !out->wedge_lists)
        return no_memory(error);
    for (uint32_t w = 0; w < of->wedge_count; w++)
        out->wedge_first[of->wedge_vertices[w] + 1]++;
    for (uint32_t v = 0; v < of->vertex_count; v++)
        out->wedge_first[v + 1] += out->wedge_first[v];
    for (uint32_t w = of->wedge_count; w-- > 0;) /* backwards, counting down from each end */
        out->wedge_lists[--out->wedge_first[of->wedge_vertices[w] + 1]] = w;
    for (uint32_t v = 0; v < of->vertex_count; v++)
        out->wedge_first[v] = out->wedge_first[v + 1];
    out->wedge_first[of->vertex_count] = of->wedge_count;
    return HEWN_OK;
}

/* --- what comes --------------------------------------------------------------------------------------------------- */

static void add_vertex(const fold *of, uint32_t vertex, numbers *by, hewn_progressive *out)
{
    const size_t to = out->vertex_count++;
    by->vertices[vertex] = (uint32_t)to;
    out->vertex_origins[to] = vertex;
    memcpy(out->positions + 3 * to, of->model->positions + 3 * (size_t)vertex, 3 * sizeof(double));
    if (out->row[HEWN_DOMAIN_VERT] > 0)
        hewn_progressive_row_get(of->model, HEWN_DOMAIN_VERT, vertex,
                                 out->vertex_rows + to * out->row[HEWN_DOMAIN_VERT]);
    for (uint32_t i = by->wedge_first[vertex]; i < by->wedge_first[vertex + 1]; i++) {
        const uint32_t wedge = by->wedge_lists[i];
        const size_t at = out->wedge_count++;
        by->wedges[wedge] = (uint32_t)at;
        out->wedge_vertices[at] = (uint32_t)to;
        if (out->corner_values)
            hewn_progressive_row_get(of->model, HEWN_DOMAIN_CORNER, of->wedge_places[wedge],
                                     out->wedge_rows + at * out->row[HEWN_DOMAIN_CORNER]);
    }
}

static void add_triangle(const fold *of, uint32_t triangle, numbers *by, hewn_progressive *out)
{
    const size_t to = out->triangle_count++;
    by->triangles[triangle] = (uint32_t)to;
    for (size_t k = 0; k < 3; k++)
        out->triangles[3 * to + k] = by->wedges[of->triangles[3 * (size_t)triangle + k]];
    if (out->triangle_origins)
        out->triangle_origins[to] = triangle;
    if (out->row[HEWN_DOMAIN_FACE] > 0)
        hewn_progressive_row_get(of->model, HEWN_DOMAIN_FACE, of->faces[triangle],
                                 out->triangle_rows + to * out->row[HEWN_DOMAIN_FACE]);
}

static void add_base(const fold *of, numbers *by, hewn_progressive *out)
{
    for (uint32_t v = 0; v < of->vertex_count; v++)
        if (of->states[v] != FOLD_GONE)
            add_vertex(of, v, by, out);
    for (uint32_t t = 0; t < of->triangle_count; t++)
        if (!of->removed[t])
            add_triangle(of, t, by, out);
    out->base_vertices = (uint32_t)out->vertex_count;
    out->base_wedges = (uint32_t)out->wedge_count;
    out->base_triangles = (uint32_t)out->triangle_count;
}

static int compare_changes(const void *a, const void *b)
{
    const progressive_change *one = a, *two = b;
    return (one->corner > two->corner) - (one->corner < two->corner);
}

/* The split that undoes record `i`. */
static void add_split(const fold *of, size_t i, numbers *by, hewn_progressive *out)
{
    const fold_record *record = &of->records[i];
    const bool last = i + 1 == of->record_count;
    const size_t change_end = last ? of->change_count : record[1].first_change;
    const size_t gone_end = last ? of->gone_count : record[1].first_removed;
    progressive_split *split = &out->splits[out->split_count++];
    *split = (progressive_split){.parent = by->vertices[record->into],
                                 .first_wedge = (uint32_t)out->wedge_count,
                                 .first_triangle = (uint32_t)out->triangle_count,
                                 .first_change = (uint32_t)out->change_count,
                                 .error = record->error};
    add_vertex(of, record->vertex, by, out);
    for (size_t k = record->first_removed; k < gone_end; k++)
        add_triangle(of, of->gone[k], by, out);
    progressive_change *changes = out->changes + out->change_count;
    for (size_t k = record->first_change; k < change_end; k++) {
        const progressive_change *from = &of->changes[k];
        out->changes[out->change_count++] = (progressive_change){3 * by->triangles[from->corner / 3] + from->corner % 3,
                                                                 by->wedges[from->before], by->wedges[from->after]};
    }
    qsort(changes, change_end - record->first_change, sizeof *changes, compare_changes);
}

/* --- the input's own order ---------------------------------------------------------------------------------------- */

static hewn_result take_polygons(const fold *of, const numbers *by, hewn_progressive *out, hewn_error *error)
{
    const hewn_model *model = of->model;
    out->polygon_first = hewn_alloc(model->face_count + 1, sizeof *out->polygon_first);
    out->polygon_wedges = hewn_alloc(out->corners, sizeof *out->polygon_wedges);
    out->polygon_rows = hewn_alloc(model->face_count, out->row[HEWN_DOMAIN_FACE]);
    if (!out->polygon_first || !out->polygon_wedges || !out->polygon_rows)
        return no_memory(error);
    if (model->first)
        memcpy(out->polygon_first, model->first, (model->face_count + 1) * sizeof *out->polygon_first);
    for (uint64_t c = 0; c < out->corners; c++)
        out->polygon_wedges[c] = by->wedges[of->corner_wedges[c]];
    for (uint64_t f = 0; out->row[HEWN_DOMAIN_FACE] > 0 && f < model->face_count; f++)
        hewn_progressive_row_get(model, HEWN_DOMAIN_FACE, f, out->polygon_rows + f * out->row[HEWN_DOMAIN_FACE]);
    return HEWN_OK;
}

static hewn_result unwind(const fold *of, numbers *by, hewn_progressive *out, hewn_error *error)
{
    HEWN_TRY(begin_numbers(of, by, error));
    add_base(of, by, out);
    for (size_t i = of->record_count; i-- > 0;)
        add_split(of, i, by, out);
    return out->polygons ? take_polygons(of, by, out, error) : HEWN_OK;
}

hewn_result hewn_fold_unwind(const fold *of, hewn_progressive *out, hewn_error *error)
{
    numbers by = {0};
    HEWN_TRY(hewn_progressive_take_shape(out, of->model, error));
    HEWN_TRY(hewn_progressive_grow(out, of->vertex_count, of->wedge_count, of->triangle_count, error));
    HEWN_TRY(hewn_progressive_grow_splits(out, of->record_count, of->change_count, error));
    out->faces = of->model->face_count;
    out->corners = hewn_model_corner_count(of->model);
    out->polygons = of->model->first != NULL;
    out->vertex_origins = hewn_alloc(of->vertex_count, sizeof *out->vertex_origins);
    out->triangle_origins = out->polygons ? NULL : hewn_alloc(of->triangle_count, sizeof *out->triangle_origins);
    if (!out->vertex_origins || (!out->polygons && !out->triangle_origins))
        return no_memory(error);
    hewn_result result = unwind(of, &by, out, error);
    release(&by);
    out->full_vertices = out->vertex_count;
    out->full_wedges = out->wedge_count;
    out->full_triangles = out->triangle_count;
    out->full_splits = out->split_count;
    out->complete = true;
    return result;
}
