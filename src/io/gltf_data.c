#include "io/gltf_data.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "io/bytes.h"

/* What a document may take in any case. */
static const uint64_t FREE_BYTES = (uint64_t)64 << 20;

/* --- buffers ------------------------------------------------------------------------------------------------------ */

static int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Undoes %20 and the like, in place. */
static void percent_decode(char *text)
{
    char *to = text;
    for (const char *at = text; *at; at++) {
        int high = *at == '%' ? hex_digit(at[1]) : -1, low = high >= 0 ? hex_digit(at[2]) : -1;
        if (low >= 0 && 16 * high + low != 0) {
            *to++ = (char)(16 * high + low);
            at += 2;
        } else {
            *to++ = *at;
        }
    }
    *to = '\0';
}

static int base64_digit(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* "data:...;base64,..." (RFC 2397). */
static hewn_result read_data_uri(const hewn_gltf_data *data, const char *uri, hewn_gltf_bytes *out, hewn_error *error)
{
    const char *comma = strchr(uri, ',');
    static const char mark[] = ";base64";
    if (!comma || (size_t)(comma - uri) < strlen(mark) || memcmp(comma - strlen(mark), mark, strlen(mark)) != 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "a buffer's data: URI is not in base64");
    size_t length = strlen(comma + 1);
    char *bytes = hewn_alloc(length / 4 * 3 + 3, 1);
    if (!bytes)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, data->name, 0, "out of memory for a buffer");
    uint32_t word = 0;
    int bits = 0;
    uint64_t used = 0;
    for (const char *at = comma + 1; *at && *at != '='; at++) {
        int digit = base64_digit(*at);
        if (digit < 0) {
            hewn_free(bytes);
            return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "a buffer's data: URI is not in base64");
        }
        word = word << 6 | (uint32_t)digit;
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            bytes[used++] = (char)(word >> bits & 0xff);
        }
    }
    *out = (hewn_gltf_bytes){bytes, used, bytes};
    return HEWN_OK;
}

/* A file beside the document. It must not lead out of the document's folder: a model from elsewhere has no business
 * with other files of this machine. */
static hewn_result read_file(const hewn_gltf_data *data, const hewn_gltf_buffer *buffer, hewn_gltf_bytes *out,
                             hewn_error *error)
{
    if (!data->path)
        return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "a buffer is in a file of its own");
    const char *slash = strrchr(data->path, '/');
    size_t folder = slash ? (size_t)(slash - data->path) + 1 : 0, uri = strlen(buffer->uri);
    char *path = hewn_alloc(folder + uri + 1, 1);
    if (!path)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, data->name, 0, "out of memory for a buffer");
    memcpy(path, data->path, folder);
    memcpy(path + folder, buffer->uri, uri + 1);
    char *relative = path + folder;
    percent_decode(relative);
    hewn_result result;
    if (*relative == '\0' || *relative == '/' || strstr(relative, "..") || strchr(relative, ':')) {
        result = hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0,
                              "a buffer's URI does not name a file in the same folder");
    } else {
        size_t length = 0;
        char *bytes = NULL;
        result = hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, error);
        *out = (hewn_gltf_bytes){bytes, length, bytes};
    }
    hewn_free(path);
    return result;
}

static hewn_result read_buffer(hewn_gltf_data *data, size_t index, hewn_error *error)
{
    const hewn_gltf_buffer *buffer = &data->gltf.buffers[index];
    hewn_gltf_bytes *out = &data->buffers[index];
    if (out->bytes)
        return HEWN_OK;
    hewn_gltf_bytes found = {data->chunk, data->chunk_length, NULL};
    if (buffer->uri && strncmp(buffer->uri, "data:", 5) == 0)
        HEWN_TRY(read_data_uri(data, buffer->uri, &found, error));
    else if (buffer->uri)
        HEWN_TRY(read_file(data, buffer, &found, error));
    else if (index != 0 || !data->chunk)
        return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "buffer %zu has no data", index);
    if (found.length < buffer->length) {
        hewn_free(found.owned);
        return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0,
                            "buffer %zu has %llu of the %llu bytes it should have", index,
                            (unsigned long long)found.length, (unsigned long long)buffer->length);
    }
    data->loaded += found.owned ? found.length : 0;
    found.length = buffer->length;
    *out = found;
    return HEWN_OK;
}

/* --- accessors ---------------------------------------------------------------------------------------------------- */

hewn_result hewn_gltf_spend(hewn_gltf_data *data, uint64_t count, uint64_t bytes, hewn_error *error)
{
    uint64_t most = FREE_BYTES + 64 * (data->length + data->loaded);
    if (count > (most - data->spent) / bytes)
        return hewn_fail_at(error, HEWN_LIMIT, data->name, 0,
                            "the document repeats or promises so much that it is out of proportion to the file");
    data->spent += count * bytes;
    return HEWN_OK;
}

static uint64_t component_size(int type)
{
    switch (type) {
    case HEWN_GLTF_BYTE:
    case HEWN_GLTF_UBYTE: return 1;
    case HEWN_GLTF_SHORT:
    case HEWN_GLTF_USHORT: return 2;
    case HEWN_GLTF_UINT:
    case HEWN_GLTF_FLOAT: return 4;
    default: return 0;
    }
}

static bool is_index_type(int type)
{
    return type == HEWN_GLTF_UBYTE || type == HEWN_GLTF_USHORT || type == HEWN_GLTF_UINT;
}

static hewn_result fail_accessor(const hewn_gltf_data *data, int index, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "accessor %d %s", index, what);
}

/* `count` items of `size` bytes in a view; `index` is of the accessor, for messages. */
static hewn_result open_view(hewn_gltf_data *data, int index, int number, uint64_t offset, uint64_t count,
                             uint64_t size, hewn_gltf_items *out, hewn_error *error)
{
    const hewn_gltf *gltf = &data->gltf;
    if (number < 0 || (size_t)number >= gltf->view_count)
        return fail_accessor(data, index, "names a bufferView that does not exist", error);
    const hewn_gltf_view *view = &gltf->views[number];
    if (view->buffer < 0 || (size_t)view->buffer >= gltf->buffer_count)
        return fail_accessor(data, index, "lies in a buffer that does not exist", error);
    HEWN_TRY(read_buffer(data, (size_t)view->buffer, error));
    const hewn_gltf_bytes *bytes = &data->buffers[view->buffer];
    if (view->offset > bytes->length || view->length > bytes->length - view->offset)
        return fail_accessor(data, index, "has a bufferView that ends past its buffer", error);
    out->stride = view->stride ? view->stride : size;
    if (out->stride < size)
        return fail_accessor(data, index, "has items that overlap", error);
    bool fits = count == 0 || (offset <= view->length && size <= view->length - offset &&
                               count - 1 <= (view->length - offset - size) / out->stride);
    if (!fits)
        return fail_accessor(data, index, "ends past its bufferView", error);
    out->first = count == 0 ? bytes->bytes : bytes->bytes + view->offset + offset;
    out->count = count;
    return HEWN_OK;
}

/* Puts the sparse items over the others. */
static hewn_result scatter(hewn_gltf_data *data, int index, uint64_t size, char *dense, hewn_error *error)
{
    const hewn_gltf_accessor *accessor = &data->gltf.accessors[index];
    const hewn_gltf_sparse *sparse = &accessor->sparse;
    hewn_gltf_items places = {.component_type = sparse->place_type, .components = 1}, values = {0};
    if (!is_index_type(sparse->place_type))
        return fail_accessor(data, index, "is sparse with indices that are not unsigned whole numbers", error);
    HEWN_TRY(open_view(data, index, sparse->place_view, sparse->place_offset, sparse->count,
                       component_size(sparse->place_type), &places, error));
    HEWN_TRY(open_view(data, index, sparse->value_view, sparse->value_offset, sparse->count, size, &values, error));
    for (uint64_t i = 0; i < sparse->count; i++) {
        uint32_t place = hewn_gltf_index(&places, i);
        if (place >= accessor->count)
            return fail_accessor(data, index, "is sparse with an index past its end", error);
        memcpy(dense + size * place, values.first + values.stride * i, size);
    }
    return HEWN_OK;
}

/* The items of an accessor that is sparse or without a view: zeros, or those of the view, and the sparse ones. */
static hewn_result make_dense(hewn_gltf_data *data, int index, uint64_t size, hewn_gltf_items *out, hewn_error *error)
{
    const hewn_gltf_accessor *accessor = &data->gltf.accessors[index];
    if (!data->dense[index]) {
        hewn_gltf_items base = {0};
        if (accessor->view != HEWN_GLTF_NONE)
            HEWN_TRY(open_view(data, index, accessor->view, accessor->offset, accessor->count, size, &base, error));
        HEWN_TRY(hewn_gltf_spend(data, accessor->count, size, error));
        char *dense = hewn_alloc_zero(accessor->count, size);
        if (!dense)
            return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, data->name, 0, "out of memory for accessor %d", index);
        for (uint64_t i = 0; i < base.count; i++)
            memcpy(dense + size * i, base.first + base.stride * i, size);
        hewn_result result = accessor->sparse.count ? scatter(data, index, size, dense, error) : HEWN_OK;
        if (result != HEWN_OK) {
            hewn_free(dense);
            return result;
        }
        data->dense[index] = dense;
    }
    out->first = data->dense[index];
    out->stride = size;
    out->count = accessor->count;
    return HEWN_OK;
}

hewn_result hewn_gltf_items_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error)
{
    *out = (hewn_gltf_items){0};
    if (index < 0 || (size_t)index >= data->gltf.accessor_count)
        return fail_accessor(data, index, "does not exist", error);
    const hewn_gltf_accessor *accessor = &data->gltf.accessors[index];
    uint64_t size =
        component_size(accessor->component_type) * (uint64_t)(accessor->components > 0 ? accessor->components : 0);
    if (size == 0)
        return fail_accessor(data, index, "has a type that glTF does not know", error);
    out->component_type = accessor->component_type;
    out->components = accessor->components;
    out->matrix = accessor->matrix;
    out->normalised = accessor->normalised;
    if (accessor->sparse.count > 0 || accessor->view == HEWN_GLTF_NONE)
        return make_dense(data, index, size, out, error);
    return open_view(data, index, accessor->view, accessor->offset, accessor->count, size, out, error);
}

hewn_result hewn_gltf_indices_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error)
{
    HEWN_TRY(hewn_gltf_items_of(data, index, out, error));
    if (out->components != 1 || !is_index_type(out->component_type))
        return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "indices are not unsigned whole numbers");
    return HEWN_OK;
}

hewn_result hewn_gltf_base_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error)
{
    HEWN_TRY(hewn_gltf_indices_of(data, index, out, error));
    const hewn_gltf_accessor *accessor = &data->gltf.accessors[index];
    uint64_t size = component_size(accessor->component_type);
    if (accessor->view == HEWN_GLTF_NONE || size == 0)
        return fail_accessor(data, index, "has indices that are not in any bufferView", error);
    return open_view(data, index, accessor->view, accessor->offset, accessor->count, size, out, error);
}

uint32_t hewn_gltf_index(const hewn_gltf_items *items, uint64_t index)
{
    const char *at = items->first + index * items->stride;
    switch (items->component_type) {
    case HEWN_GLTF_UBYTE: return (unsigned char)*at;
    case HEWN_GLTF_USHORT: return hewn_get_u16(at);
    default: return hewn_get_u32(at);
    }
}

static double get_whole(const char *at, int type, double *most)
{
    uint32_t byte = (unsigned char)*at;
    switch (type) {
    case HEWN_GLTF_BYTE: *most = 127; return byte < 0x80 ? (double)byte : (double)byte - 0x100;
    case HEWN_GLTF_UBYTE: *most = 255; return byte;
    case HEWN_GLTF_SHORT:
        *most = 32767;
        return hewn_get_u16(at) < 0x8000 ? (double)hewn_get_u16(at) : (double)hewn_get_u16(at) - 0x10000;
    case HEWN_GLTF_USHORT: *most = 65535; return hewn_get_u16(at);
    default: *most = UINT32_MAX; return hewn_get_u32(at);
    }
}

void hewn_gltf_numbers(const hewn_gltf_items *items, uint64_t index, double *out)
{
    const char *at = items->first + index * items->stride;
    uint64_t size = component_size(items->component_type);
    for (int k = 0; k < items->components; k++, at += size) {
        if (items->component_type == HEWN_GLTF_FLOAT) {
            out[k] = (double)hewn_get_float(at);
            continue;
        }
        double most, whole = get_whole(at, items->component_type, &most);
        out[k] = items->normalised ? fmax(whole / most, -1) : whole;
    }
}

hewn_result hewn_gltf_data_open(hewn_gltf_data *data, hewn_error *error)
{
    data->buffers = hewn_alloc_zero(data->gltf.buffer_count, sizeof *data->buffers);
    data->dense = hewn_alloc_zero(data->gltf.accessor_count, sizeof *data->dense);
    if (!data->buffers || !data->dense)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, data->name, 0, "out of memory for buffers");
    return HEWN_OK;
}

void hewn_gltf_data_free(hewn_gltf_data *data)
{
    for (size_t i = 0; data->buffers && i < data->gltf.buffer_count; i++)
        hewn_free(data->buffers[i].owned);
    for (size_t i = 0; data->dense && i < data->gltf.accessor_count; i++)
        hewn_free(data->dense[i]);
    hewn_free(data->buffers);
    hewn_free(data->dense);
    data->buffers = NULL;
    data->dense = NULL;
}
