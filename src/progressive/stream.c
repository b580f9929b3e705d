#include "progressive/stream.h"

#include <string.h>

#include "base/alloc.h"

void hewn_progressive_destroy(hewn_progressive **progressive)
{
    hewn_progressive *of = *progressive;
    if (!of)
        return;
    hewn_model_destroy(&of->shape);
    hewn_free(of->positions);
    hewn_free(of->vertex_rows);
    hewn_free(of->wedge_vertices);
    hewn_free(of->wedge_rows);
    hewn_free(of->triangles);
    hewn_free(of->triangle_rows);
    hewn_free(of->splits);
    hewn_free(of->changes);
    hewn_free(of->vertex_origins);
    hewn_free(of->triangle_origins);
    hewn_free(of->polygon_first);
    hewn_free(of->polygon_wedges);
    hewn_free(of->polygon_rows);
    hewn_free(of->marks);
    hewn_free(of);
    *progressive = NULL;
}

/* --- room --------------------------------------------------------------------------------------------------------- */

/* One of several arrays that grow together. */
static bool stretch(void **array, size_t room, size_t size)
{
    void *grown = hewn_realloc(*array, room, size > 0 ? size : 1);
    if (grown)
        *array = grown;
    return grown != NULL;
}

static size_t next_room(size_t room, size_t needed)
{
    const size_t twice = 2 * room;
    return needed > twice ? needed : twice;
}

static hewn_result check_limit(size_t needed, hewn_error *error)
{
    if (needed < UINT32_MAX / 4)
        return HEWN_OK;
    return hewn_fail(error, HEWN_LIMIT, "a progressive mesh cannot have %llu vertices, wedges or triangles",
                     (unsigned long long)needed);
}

static hewn_result no_room(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
}

static hewn_result grow_vertices(hewn_progressive *to, size_t needed, hewn_error *error)
{
    if (needed <= to->vertex_room)
        return HEWN_OK;
    HEWN_TRY(check_limit(needed, error));
    const size_t room = next_room(to->vertex_room, needed);
    if (!stretch((void **)&to->positions, room, 3 * sizeof *to->positions) ||
        !stretch((void **)&to->vertex_rows, room, to->row[HEWN_DOMAIN_VERT]))
        return no_room(error);
    to->vertex_room = room;
    return HEWN_OK;
}

static hewn_result grow_wedges(hewn_progressive *to, size_t needed, hewn_error *error)
{
    if (needed <= to->wedge_room)
        return HEWN_OK;
    HEWN_TRY(check_limit(needed, error));
    const size_t room = next_room(to->wedge_room, needed);
    if (!stretch((void **)&to->wedge_vertices, room, sizeof *to->wedge_vertices) ||
        !stretch((void **)&to->wedge_rows, room, to->row[HEWN_DOMAIN_CORNER]))
        return no_room(error);
    to->wedge_room = room;
    return HEWN_OK;
}

static hewn_result grow_triangles(hewn_progressive *to, size_t needed, hewn_error *error)
{
    if (needed <= to->triangle_room)
        return HEWN_OK;
    HEWN_TRY(check_limit(needed, error));
    const size_t room = next_room(to->triangle_room, needed);
    if (!stretch((void **)&to->triangles, room, 3 * sizeof *to->triangles) ||
        !stretch((void **)&to->triangle_rows, room, to->row[HEWN_DOMAIN_FACE]))
        return no_room(error);
    to->triangle_room = room;
    return HEWN_OK;
}

hewn_result hewn_progressive_grow(hewn_progressive *to, size_t vertices, size_t wedges, size_t triangles,
                                  hewn_error *error)
{
    HEWN_TRY(grow_vertices(to, to->vertex_count + vertices, error));
    HEWN_TRY(grow_wedges(to, to->wedge_count + wedges, error));
    return grow_triangles(to, to->triangle_count + triangles, error);
}

hewn_result hewn_progressive_grow_splits(hewn_progressive *to, size_t splits, size_t changes, hewn_error *error)
{
    const size_t split_need = to->split_count + splits, change_need = to->change_count + changes;
    if (split_need > to->split_room) {
        const size_t room = next_room(to->split_room, split_need);
        if (!stretch((void **)&to->splits, room, sizeof *to->splits))
            return no_room(error);
        to->split_room = room;
    }
    if (change_need > to->change_room) {
        if (change_need >= UINT32_MAX)
            return hewn_fail(error, HEWN_LIMIT, "a progressive mesh cannot change more than 2^32 - 2 corners");
        const size_t room = next_room(to->change_room, change_need);
        if (!stretch((void **)&to->changes, room, sizeof *to->changes))
            return no_room(error);
        to->change_room = room;
    }
    return HEWN_OK;
}

/* --- channels as rows --------------------------------------------------------------------------------------------- */

static size_t value_bytes(const hewn_channel *channel)
{
    return channel->info.components * hewn_scalar_size(channel->info.scalar);
}

void hewn_progressive_find_rows(hewn_progressive *to)
{
    memset(to->row, 0, sizeof to->row);
    to->corner_values = false;
    for (uint32_t i = 0; i < to->shape.channel_count; i++) {
        const hewn_channel *channel = &to->shape.channels[i];
        to->row[channel->info.domain] += (uint32_t)value_bytes(channel);
        to->corner_values |= channel->info.domain == HEWN_DOMAIN_CORNER;
    }
}

static hewn_result take_channel(hewn_model *to, const hewn_channel *channel, hewn_error *error)
{
    hewn_channel *copy;
    int32_t value;
    HEWN_TRY(hewn_model_add_channel(to, &channel->info, &copy, error));
    for (uint32_t i = 0; i < channel->name_count; i++)
        HEWN_TRY(hewn_channel_value(copy, channel->names[i], &value, error));
    return HEWN_OK;
}

hewn_result hewn_progressive_take_shape(hewn_progressive *to, const hewn_model *model, hewn_error *error)
{
    to->shape.unit = model->unit;
    to->shape.up = model->up;
    to->shape.up_known = model->up_known;
    for (uint32_t i = 0; i < model->channel_count; i++)
        HEWN_TRY(take_channel(&to->shape, &model->channels[i], error));
    hewn_progressive_find_rows(to);
    return HEWN_OK;
}

void hewn_progressive_row_get(const hewn_model *model, hewn_domain domain, uint64_t index, unsigned char *row)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        if (channel->info.domain != domain)
            continue;
        const size_t bytes = value_bytes(channel);
        memcpy(row, (const unsigned char *)channel->values + index * bytes, bytes);
        row += bytes;
    }
}

void hewn_progressive_row_put(hewn_model *model, hewn_domain domain, uint64_t index, const unsigned char *row)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        if (channel->info.domain != domain)
            continue;
        const size_t bytes = value_bytes(channel);
        memcpy((unsigned char *)channel->values + index * bytes, row, bytes);
        row += bytes;
    }
}

/* --- questions ---------------------------------------------------------------------------------------------------- */

hewn_progressive_info hewn_progressive_about(const hewn_progressive *progressive)
{
    return (hewn_progressive_info){.base_vertices = progressive->base_vertices,
                                   .base_triangles = progressive->base_triangles,
                                   .vertices = progressive->full_vertices,
                                   .triangles = progressive->full_triangles,
                                   .faces = progressive->faces,
                                   .splits = progressive->full_splits,
                                   .splits_there = progressive->split_count,
                                   .complete = progressive->complete,
                                   .mark_count = progressive->mark_count,
                                   .marks = progressive->marks};
}

uint64_t hewn_progressive_triangles_at(const hewn_progressive *progressive, uint64_t splits)
{
    return progressive_triangles_at(progressive, splits);
}

/* Triangles only become more, so the last number of splits with few enough is found by halving. */
uint64_t hewn_progressive_splits_for(const hewn_progressive *progressive, uint64_t triangles)
{
    uint64_t lo = 0, hi = progressive->split_count;
    while (lo < hi) {
        const uint64_t middle = lo + (hi - lo + 1) / 2;
        if (progressive_triangles_at(progressive, middle) <= triangles)
            lo = middle;
        else
            hi = middle - 1;
    }
    return lo;
}

uint64_t hewn_progressive_splits_within(const hewn_progressive *progressive, double error)
{
    for (uint32_t i = 0; i < progressive->mark_count; i++)
        if (progressive->marks[i].error <= error && progressive->marks[i].splits <= progressive->split_count)
            return progressive->marks[i].splits;
    return progressive->split_count;
}
