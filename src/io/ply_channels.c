#include "io/ply_channels.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { MOST_COMPONENTS = 16 };

/* --- while they are read ------------------------------------------------------------------------------------------ */

hewn_result hewn_ply_layout_begin(hewn_ply_layout *layout, uint64_t count, hewn_error *error)
{
    for (uint32_t i = 0; i < layout->column_count; i++) {
        hewn_ply_column *column = &layout->columns[i];
        if (column->domain == HEWN_DOMAIN_CORNER)
            continue;
        if (column->domain == HEWN_DOMAIN_VERT)
            layout->item_count = count;
        column->values = hewn_alloc((size_t)count, column->components * column->size);
        if (!column->values)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the values of %llu items",
                             (unsigned long long)count);
        column->value_room = (size_t)count * column->components;
    }
    return HEWN_OK;
}

hewn_result hewn_ply_column_reserve(hewn_ply_column *column, size_t count, hewn_error *error)
{
    void *items = column->values;
    HEWN_TRY(hewn_reserve(&items, &column->value_room, count, column->size, error));
    column->values = items;
    return HEWN_OK;
}

static hewn_result append_zeroes(hewn_ply_column *column, uint64_t count, hewn_error *error)
{
    size_t size = column->size;
    HEWN_TRY(hewn_ply_column_reserve(column, column->value_count + (size_t)count, error));
    memset(column->values + size * column->value_count, 0, size * (size_t)count);
    column->value_count += (size_t)count;
    return HEWN_OK;
}

/* The first list that is not empty says how many values a corner has; the faces before it get zeroes. */
static hewn_result learn_components(hewn_ply_column *column, uint64_t corners_before, uint64_t components,
                                    hewn_error *error)
{
    size_t size = column->size, length = column->value_count;
    column->components = (uint32_t)components;
    HEWN_TRY(append_zeroes(column, corners_before * components, error));
    size_t zeroes = column->value_count - length;
    memmove(column->values + size * zeroes, column->values, size * length);
    memset(column->values, 0, size * zeroes);
    return HEWN_OK;
}

static hewn_result end_list(hewn_ply_column *column, uint64_t corners_before, uint64_t corners, const hewn_scan *scan,
                            hewn_error *error)
{
    uint64_t length = column->value_count - column->value_mark;
    if (length == 0 && column->components > 0)
        HEWN_TRY(append_zeroes(column, corners * column->components, error));
    else if (length > 0 && column->components == 0 && length % corners == 0 && length / corners <= MOST_COMPONENTS)
        HEWN_TRY(learn_components(column, corners_before, length / corners, error));
    else if (length != corners * column->components)
        return hewn_fail_at(
            error, HEWN_BAD_INPUT, scan->name, scan->line,
            "a face of %llu corners has %llu values of its corners' \"%s\", which is not as many for each",
            (unsigned long long)corners, (unsigned long long)length, column->name);
    column->value_mark = column->value_count;
    return HEWN_OK;
}

hewn_result hewn_ply_layout_end_item(hewn_ply_layout *layout, uint64_t corners, const hewn_scan *scan,
                                     hewn_error *error)
{
    for (uint32_t i = 0; i < layout->column_count; i++)
        if (layout->columns[i].domain == HEWN_DOMAIN_CORNER)
            HEWN_TRY(end_list(&layout->columns[i], layout->corner_count, corners, scan, error));
    layout->item_count++;
    layout->corner_count += corners;
    return HEWN_OK;
}

void hewn_ply_layout_drop_item(hewn_ply_layout *layout)
{
    for (uint32_t i = 0; i < layout->column_count; i++)
        if (layout->columns[i].domain == HEWN_DOMAIN_CORNER)
            layout->columns[i].value_count = layout->columns[i].value_mark;
}

void hewn_ply_layout_take_positions(hewn_ply_layout *layout, double **out)
{
    *out = NULL;
    for (uint32_t i = 0; i < layout->column_count; i++)
        if (!layout->columns[i].name) {
            *out = (double *)(void *)layout->columns[i].values;
            layout->columns[i].values = NULL;
        }
}

/* --- channels ----------------------------------------------------------------------------------------------------- */

/* Unsigned numbers that all are good as INT32 become that. */
static void narrow(hewn_ply_column *column, size_t count)
{
    if (!column->is_unsigned || column->scalar != HEWN_SCALAR_DOUBLE)
        return;
    for (size_t i = 0; i < count; i++) {
        double value;
        memcpy(&value, column->values + i * sizeof value, sizeof value);
        if (value > INT32_MAX)
            return;
    }
    for (size_t i = 0; i < count; i++) { /* they only move down */
        double value;
        memcpy(&value, column->values + i * sizeof value, sizeof value);
        int32_t whole = (int32_t)value;
        memcpy(column->values + i * sizeof whole, &whole, sizeof whole);
    }
    column->scalar = HEWN_SCALAR_INT32;
    column->size = sizeof(int32_t);
}

static hewn_result add_channel(hewn_model *model, hewn_ply_column *column, uint64_t first, uint64_t count,
                               hewn_error *error)
{
    narrow(column, (size_t)count * column->components);
    hewn_attribute_info info = {column->name, column->domain, column->scalar, column->components};
    size_t size = info.components * hewn_scalar_size(info.scalar);
    hewn_channel *channel;
    HEWN_TRY(hewn_model_add_channel(model, &info, &channel, error));
    if (count > 0 && count == hewn_model_domain_count(model, info.domain)) {
        void *smaller = hewn_realloc(column->values, (size_t)count, size);
        hewn_free(channel->values);
        channel->values = smaller ? smaller : column->values;
        column->values = NULL;
    } else if (count > 0) {
        memcpy((char *)channel->values + first * size, column->values, (size_t)count * size);
    }
    return HEWN_OK;
}

hewn_result hewn_ply_channels_add(hewn_model *model, hewn_ply_layout *layout, uint64_t first, hewn_error *error)
{
    uint64_t first_corner = model->first ? model->first[first] : 3 * first;
    for (uint32_t i = 0; i < layout->column_count; i++) {
        hewn_ply_column *column = &layout->columns[i];
        bool corner = column->domain == HEWN_DOMAIN_CORNER;
        if (column->name && column->components > 0)
            HEWN_TRY(add_channel(model, column, corner ? first_corner : first,
                                 corner ? layout->corner_count : layout->item_count, error));
    }
    return HEWN_OK;
}

/* --- names of values ---------------------------------------------------------------------------------------------- */

const char *hewn_ply_domain_name(hewn_domain domain)
{
    return domain == HEWN_DOMAIN_VERT ? "vertex" : domain == HEWN_DOMAIN_CORNER ? "corner" : "face";
}

static hewn_channel *find_channel(const hewn_model *model, hewn_word domain, hewn_word name)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        hewn_channel *channel = &model->channels[i];
        if (hewn_word_is(domain, hewn_ply_domain_name(channel->info.domain)) && hewn_word_is(name, channel->info.name))
            return channel->info.scalar == HEWN_SCALAR_INT32 ? channel : NULL;
    }
    return NULL;
}

hewn_result hewn_ply_channels_name(hewn_model *model, hewn_word comment, hewn_error *error)
{
    hewn_scan scan = {comment.begin, comment.end, "", 1};
    if (!hewn_word_is(hewn_scan_word_in_line(&scan), "value"))
        return HEWN_OK;
    hewn_word domain = hewn_scan_word_in_line(&scan), name = hewn_scan_word_in_line(&scan);
    hewn_word number = hewn_scan_word_in_line(&scan), equals = hewn_scan_word_in_line(&scan);
    hewn_channel *channel = find_channel(model, domain, name);
    int64_t expected;
    if (!channel || !hewn_word_integer(number, &expected) || expected != channel->name_count ||
        !hewn_word_is(equals, "="))
        return HEWN_OK;
    scan.at += scan.at < scan.end;
    size_t length = (size_t)(scan.end - scan.at);
    char *text = hewn_alloc(length + 1, 1);
    if (!text)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a name");
    memcpy(text, scan.at, length);
    text[length] = '\0';
    int32_t value;
    hewn_result result = hewn_channel_value(channel, text, &value, error);
    hewn_free(text);
    return result;
}
