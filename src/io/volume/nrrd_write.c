/* NRRD files of samples: a header of text, an empty line, and floats packed by gzip (teem's format, version 4). */
#include <math.h>
#include <string.h>
#include <zlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/volume/nrrd_header.h"
#include "io/volume/sampling_write.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE, PACKED = 1 << 18 };

static hewn_result put(hewn_sampling_writing *job, const void *bytes, size_t length, hewn_error *error)
{
    job->written += length;
    return hewn_output_write(job->output, bytes, length, error);
}

static hewn_result write_head(hewn_sampling_writing *job, hewn_error *error)
{
    hewn_text text = {0};
    const uint32_t *cells = job->sampling->cells;
    const hewn_sampling_place *p = job->place;
    const uint16_t one = 1;
    hewn_text_print(&text,
                    "NRRD0005\n# written by Hewn: signed distances, negative inside\n"
                    "type: float\ndimension: 3\nspace dimension: 3\nsizes: %u %u %u\n"
                    "space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\nkinds: domain domain domain\n"
                    "centers: node node node\nspace origin: (%.17g,%.17g,%.17g)\n",
                    cells[0] + 1, cells[1] + 1, cells[2] + 1, p->cell, p->cell, p->cell, p->origin[0], p->origin[1],
                    p->origin[2]);
    if (job->unit)
        hewn_text_print(&text, "space units: \"%s\" \"%s\" \"%s\"\n", job->unit->name, job->unit->name,
                        job->unit->name);
    hewn_text_print(&text, "endian: %s\nencoding: gzip\n" HEWN_NRRD_LEVEL_SET ":=signed distances, negative inside\n\n",
                    *(const char *)&one ? "little" : "big");
    hewn_result result = hewn_text_status(&text, error);
    if (result == HEWN_OK)
        result = put(job, text.bytes, text.length, error);
    hewn_text_clear(&text);
    return result;
}

static float shown(const hewn_sampling_writing *job, double value)
{
    double most = job->band;
    if (!job->dense)
        value = value > most ? most : value < -most ? -most : value;
    return (float)(value * job->place->cell);
}

/* Samples of a row from a brick, its last one only at the end of the lattice. */
static void fill_part(const hewn_sampling_writing *job, const uint32_t at[3], uint32_t count, float *out)
{
    const hewn_sampling *s = job->sampling;
    uint32_t b[3];
    for (int i = 0; i < 3; i++)
        b[i] = at[i] / BRICK < s->bricks[i] ? at[i] / BRICK : s->bricks[i] - 1;
    const float *samples =
        hewn_sampling_brick(s, b[0] + (uint64_t)s->bricks[0] * (b[1] + (uint64_t)s->bricks[1] * b[2]));
    for (uint32_t x = 0; x < count; x++) {
        const double cells[3] = {at[0] + x - 0.5 * s->cells[0], at[1] - 0.5 * s->cells[1], at[2] - 0.5 * s->cells[2]};
        uint32_t in[3] = {at[0] + x - BRICK * b[0], at[1] - BRICK * b[1], at[2] - BRICK * b[2]};
        out[x] = shown(job, samples ? (double)samples[in[0] + SIDE * (in[1] + SIDE * in[2])]
                                    : hewn_sampling_value(s, cells, NULL));
    }
}

static void fill_slice(const hewn_sampling_writing *job, uint32_t z, float *slice)
{
    const uint32_t *cells = job->sampling->cells;
#pragma omp parallel for schedule(dynamic, 8)
    for (uint32_t y = 0; y <= cells[1]; y++)
        for (uint32_t x = 0; x < cells[0]; x += BRICK) {
            uint32_t count = x + BRICK == cells[0] ? SIDE : BRICK;
            fill_part(job, (const uint32_t[3]){x, y, z}, count, slice + x + (size_t)(cells[0] + 1) * y);
        }
}

static voidpf zlib_alloc(voidpf user, uInt count, uInt size)
{
    (void)user;
    return hewn_alloc(count, size);
}

static void zlib_free(voidpf user, voidpf block)
{
    (void)user;
    hewn_free(block);
}

static hewn_result pack(hewn_sampling_writing *job, z_stream *stream, const void *bytes, size_t length, bool last,
                        unsigned char *packed, hewn_error *error)
{
    stream->next_in = (Bytef *)bytes;
    while (length > 0 || last) {
        uInt given = length < (1u << 30) ? (uInt)length : 1u << 30;
        stream->avail_in = given;
        length -= given;
        int status;
        do {
            stream->next_out = packed;
            stream->avail_out = PACKED;
            status = deflate(stream, last && length == 0 ? Z_FINISH : Z_NO_FLUSH);
            if (status == Z_STREAM_ERROR)
                return hewn_fail(error, HEWN_INTERNAL, "zlib cannot pack the samples");
            HEWN_TRY(put(job, packed, PACKED - stream->avail_out, error));
        } while (stream->avail_out == 0);
        if (length == 0)
            break;
    }
    return HEWN_OK;
}

static hewn_result write_samples(hewn_sampling_writing *job, float *slice, unsigned char *packed, hewn_error *error)
{
    enum { GZIP = 16 + MAX_WBITS, QUICK = 4 };
    const uint32_t *cells = job->sampling->cells;
    size_t bytes = sizeof *slice * (cells[0] + 1) * (cells[1] + 1);
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    if (deflateInit2(&stream, QUICK, Z_DEFLATED, GZIP, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory packing samples");
    hewn_result result = HEWN_OK;
    for (uint32_t z = 0; z <= cells[2] && result == HEWN_OK; z++) {
        result = hewn_progress_report(job->progress, "write", (double)z / (cells[2] + 1), error);
        if (result != HEWN_OK)
            break;
        fill_slice(job, z, slice);
        result = pack(job, &stream, slice, bytes, z == cells[2], packed, error);
    }
    deflateEnd(&stream);
    return result;
}

hewn_result hewn_nrrd_write(hewn_sampling_writing *job, hewn_sampling_written *out, hewn_error *error)
{
    size_t slice_size = (size_t)out->dims[0] * out->dims[1];
    float *slice = hewn_alloc(slice_size, sizeof *slice);
    unsigned char *packed = hewn_alloc(PACKED, 1);
    hewn_result result = slice && packed ? write_head(job, error)
                                         : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a slice of samples");
    if (result == HEWN_OK)
        result = write_samples(job, slice, packed, error);
    out->active = (uint64_t)slice_size * out->dims[2];
    hewn_free(slice);
    hewn_free(packed);
    return result;
}
