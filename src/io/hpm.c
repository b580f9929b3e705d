/* Progressive meshes as files. */
#include "base/alloc.h"
#include "base/progress.h"
#include "io/formats.h"
#include "io/unpack.h"

static const uint64_t UNPACKED_LIMIT = (uint64_t)16 << 30;

hewn_result hewn_hpm_read(const hewn_source *source, hewn_model *out, hewn_error *error)
{
    hewn_progressive *read;
    *out = (hewn_model){0};
    HEWN_TRY(hewn_progressive_decode(source->bytes, source->length, source->name, false, &read, error));
    hewn_result result = hewn_progressive_model(read, hewn_progressive_about(read).splits, out, error);
    hewn_progressive_destroy(&read);
    return result;
}

hewn_result hewn_progressive_read(const char *path, bool partial, const hewn_progress *progress, hewn_progressive **out,
                                  hewn_error *error)
{
    char *bytes, *unpacked = NULL;
    size_t length, unpacked_length = 0;
    hewn_result result = HEWN_OK;
    *out = NULL;
    HEWN_TRY(hewn_progress_report(progress, "load", 0, error));
    HEWN_TRY(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, error));
    if (hewn_is_packed(bytes, length)) {
        result = hewn_unpack(bytes, length, UNPACKED_LIMIT, path, progress, &unpacked, &unpacked_length, error);
        hewn_free(bytes);
        bytes = result == HEWN_OK ? unpacked : NULL;
        length = unpacked_length;
    }
    if (result == HEWN_OK)
        result = hewn_progressive_decode(bytes, length, path, partial, out, error);
    hewn_free(bytes);
    return result;
}

hewn_result hewn_progressive_write(const hewn_progressive *progressive, const char *path, hewn_error *error)
{
    char *bytes;
    size_t length;
    hewn_output *output = NULL;
    HEWN_TRY(hewn_progressive_encode(progressive, &bytes, &length, error));
    hewn_result result = hewn_output_create(path, &output, error);
    if (result == HEWN_OK)
        result = hewn_output_write(output, bytes, length, error);
    if (result == HEWN_OK)
        result = hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    hewn_progressive_bytes_free(bytes);
    return result;
}
