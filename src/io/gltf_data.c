#include "io/gltf_data.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"

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

static uint64_t component_size(int type)
{
    switch (type) {
    case 5120:
    case HEWN_GLTF_UBYTE: return 1;
    case 5122:
    case HEWN_GLTF_USHORT: return 2;
    case HEWN_GLTF_UINT:
    case HEWN_GLTF_FLOAT: return 4;
    default: return 0;
    }
}

static hewn_result fail_accessor(const hewn_gltf_data *data, int index, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, data->name, 0, "accessor %d %s", index, what);
}

hewn_result hewn_gltf_items_of(hewn_gltf_data *data, int index, hewn_gltf_items *out, hewn_error *error)
{
    const hewn_gltf *gltf = &data->gltf;
    if (index < 0 || (size_t)index >= gltf->accessor_count)
        return fail_accessor(data, index, "does not exist", error);
    const hewn_gltf_accessor *accessor = &gltf->accessors[index];
    uint64_t size =
        component_size(accessor->component_type) * (uint64_t)(accessor->components > 0 ? accessor->components : 0);
    if (size == 0)
        return fail_accessor(data, index, "has a type that glTF does not know", error);
    if (accessor->sparse || accessor->view == HEWN_GLTF_NONE)
        return fail_accessor(data, index, "is sparse or without data, which is not supported", error);
    if (accessor->view < 0 || (size_t)accessor->view >= gltf->view_count)
        return fail_accessor(data, index, "names a bufferView that does not exist", error);
    const hewn_gltf_view *view = &gltf->views[accessor->view];
    if (view->buffer < 0 || (size_t)view->buffer >= gltf->buffer_count)
        return fail_accessor(data, index, "lies in a buffer that does not exist", error);
    HEWN_TRY(read_buffer(data, (size_t)view->buffer, error));
    const hewn_gltf_bytes *bytes = &data->buffers[view->buffer];
    if (view->offset > bytes->length || view->length > bytes->length - view->offset)
        return fail_accessor(data, index, "has a bufferView that ends past its buffer", error);
    uint64_t stride = view->stride ? view->stride : size;
    if (stride < size)
        return fail_accessor(data, index, "has items that overlap", error);
    bool fits = accessor->count == 0 || (accessor->offset <= view->length && size <= view->length - accessor->offset &&
                                         accessor->count - 1 <= (view->length - accessor->offset - size) / stride);
    if (!fits)
        return fail_accessor(data, index, "ends past its bufferView", error);
    const char *first = accessor->count == 0 ? bytes->bytes : bytes->bytes + view->offset + accessor->offset;
    *out = (hewn_gltf_items){first, stride, accessor->count, accessor->component_type, accessor->components};
    return HEWN_OK;
}

void hewn_gltf_data_free(hewn_gltf_data *data)
{
    for (size_t i = 0; data->buffers && i < data->gltf.buffer_count; i++)
        hewn_free(data->buffers[i].owned);
    hewn_free(data->buffers);
    data->buffers = NULL;
}
