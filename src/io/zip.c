/* As PKWARE's APPNOTE describes the format: local header, data and data descriptor of each part, then the directory. */
#include "io/zip.h"

#include <assert.h>
#include <limits.h>
#include <string.h>
#include <zlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/bytes.h"

enum { MOST_PARTS = 8, MOST_NAME = 64, ROOM = 1 << 16 };
enum { LOCAL_HEADER = 0x04034b50, DESCRIPTOR = 0x08074b50, ENTRY = 0x02014b50, END = 0x06054b50 };
enum { END_64 = 0x06064b50, LOCATOR_64 = 0x07064b50 };
enum { LEVEL = 3 }; /* half the time of the default, 6, for a third more bytes */
enum { DEFLATE = 8, FLAGS = 1 << 3 /* lengths follow */, FIRST_DAY = 0x21 };

static const uint32_t ELSEWHERE = UINT32_MAX; /* the number is in the extra field for 64 bits */

typedef struct part {
    char name[MOST_NAME];
    bool large;
    uint64_t offset, packed, unpacked;
    uint32_t crc;
} part;

struct hewn_zip {
    hewn_output *output;
    z_stream stream;
    bool streaming;
    uint64_t written;
    part parts[MOST_PARTS];
    size_t count;
    unsigned char room[ROOM];
};

hewn_result hewn_zip_create(hewn_output *output, hewn_zip **out, hewn_error *error)
{
    *out = hewn_alloc_zero(1, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an archive");
    (*out)->output = output;
    return HEWN_OK;
}

void hewn_zip_destroy(hewn_zip **zip)
{
    if (*zip && (*zip)->streaming)
        deflateEnd(&(*zip)->stream);
    hewn_free(*zip);
    *zip = NULL;
}

static hewn_result put(hewn_zip *zip, const void *bytes, size_t length, hewn_error *error)
{
    HEWN_TRY(hewn_output_write(zip->output, bytes, length, error));
    zip->written += length;
    return HEWN_OK;
}

static uint32_t version_of(const part *of)
{
    return of->large ? 45 : 20;
}

/* What local header and directory entry have in common, up to the lengths. */
static char *put_common(const part *of, char *to)
{
    to = hewn_put_u16(to, version_of(of));
    to = hewn_put_u16(to, FLAGS);
    to = hewn_put_u16(to, DEFLATE);
    to = hewn_put_u16(to, 0);
    return hewn_put_u16(to, FIRST_DAY);
}

hewn_result hewn_zip_begin(hewn_zip *zip, const char *name, bool large, hewn_error *error)
{
    assert(zip->count < MOST_PARTS && strlen(name) < MOST_NAME && !zip->streaming);
    part *next = &zip->parts[zip->count++];
    *next = (part){.large = large, .offset = zip->written, .crc = (uint32_t)crc32(0, NULL, 0)};
    size_t length = strlen(name);
    memcpy(next->name, name, length + 1);
    char head[64 + MOST_NAME], *at = hewn_put_u32(head, LOCAL_HEADER);
    at = put_common(next, at);
    at = hewn_put_u32(at, 0); /* CRC and lengths come after the data */
    at = hewn_put_u32(at, large ? ELSEWHERE : 0);
    at = hewn_put_u32(at, large ? ELSEWHERE : 0);
    at = hewn_put_u16(at, (uint32_t)length);
    at = hewn_put_u16(at, large ? 20 : 0);
    memcpy(at, name, length);
    at += length;
    if (large) {
        at = hewn_put_u16(at, 1);
        at = hewn_put_u16(at, 16);
        memset(at, 0, 16);
        at += 16;
    }
    HEWN_TRY(put(zip, head, (size_t)(at - head), error));
    zip->stream = (z_stream){0};
    if (deflateInit2(&zip->stream, LEVEL, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an archive");
    zip->streaming = true;
    return HEWN_OK;
}

static hewn_result pump(hewn_zip *zip, int flush, hewn_error *error)
{
    part *now = &zip->parts[zip->count - 1];
    int state = Z_OK;
    do {
        zip->stream.next_out = zip->room;
        zip->stream.avail_out = ROOM;
        state = deflate(&zip->stream, flush);
        if (state == Z_STREAM_ERROR)
            return hewn_fail(error, HEWN_INTERNAL, "zlib refused to compress");
        size_t length = ROOM - zip->stream.avail_out;
        now->packed += length;
        HEWN_TRY(put(zip, zip->room, length, error));
    } while (zip->stream.avail_out == 0);
    return HEWN_OK;
}

hewn_result hewn_zip_write(hewn_zip *zip, const void *bytes, size_t length, hewn_error *error)
{
    part *now = &zip->parts[zip->count - 1];
    const unsigned char *at = bytes;
    while (length > 0) {
        uInt block = (uInt)(length < INT_MAX ? length : INT_MAX);
        zip->stream.next_in = (Bytef *)(uintptr_t)at;
        zip->stream.avail_in = block;
        now->crc = (uint32_t)crc32(now->crc, at, block);
        now->unpacked += block;
        HEWN_TRY(pump(zip, Z_NO_FLUSH, error));
        at += block;
        length -= block;
    }
    return HEWN_OK;
}

hewn_result hewn_zip_end(hewn_zip *zip, hewn_error *error)
{
    part *now = &zip->parts[zip->count - 1];
    zip->stream.avail_in = 0;
    HEWN_TRY(pump(zip, Z_FINISH, error));
    deflateEnd(&zip->stream);
    zip->streaming = false;
    if (!now->large && (now->packed >= ELSEWHERE || now->unpacked >= ELSEWHERE))
        return hewn_fail(error, HEWN_LIMIT, "%s needs more than 4 GiB", now->name);
    char tail[24], *at = hewn_put_u32(tail, DESCRIPTOR);
    at = hewn_put_u32(at, now->crc);
    at = now->large ? hewn_put_u64(at, now->packed) : hewn_put_u32(at, (uint32_t)now->packed);
    at = now->large ? hewn_put_u64(at, now->unpacked) : hewn_put_u32(at, (uint32_t)now->unpacked);
    return put(zip, tail, (size_t)(at - tail), error);
}

static hewn_result put_entry(hewn_zip *zip, const part *of, hewn_error *error)
{
    char entry[96 + MOST_NAME], *at = hewn_put_u32(entry, ENTRY);
    size_t length = strlen(of->name);
    bool far = of->large || of->offset >= ELSEWHERE;
    at = hewn_put_u16(at, far ? 45 : 20);
    at = put_common(of, at);
    at = hewn_put_u32(at, of->crc);
    at = hewn_put_u32(at, far ? ELSEWHERE : (uint32_t)of->packed);
    at = hewn_put_u32(at, far ? ELSEWHERE : (uint32_t)of->unpacked);
    at = hewn_put_u16(at, (uint32_t)length);
    at = hewn_put_u16(at, far ? 28 : 0);
    memset(at, 0, 10); /* no comment, first disk, no attributes */
    at = hewn_put_u32(at + 10, far ? ELSEWHERE : (uint32_t)of->offset);
    memcpy(at, of->name, length);
    at += length;
    if (far) {
        at = hewn_put_u16(at, 1);
        at = hewn_put_u16(at, 24);
        at = hewn_put_u64(at, of->unpacked);
        at = hewn_put_u64(at, of->packed);
        at = hewn_put_u64(at, of->offset);
    }
    return put(zip, entry, (size_t)(at - entry), error);
}

/* The ends of a directory that 32 bits cannot place. */
static char *put_end_64(const hewn_zip *zip, uint64_t begin, char *to)
{
    to = hewn_put_u32(to, END_64);
    to = hewn_put_u64(to, 44);
    to = hewn_put_u16(to, 45);
    to = hewn_put_u16(to, 45);
    to = hewn_put_u64(to, 0);
    to = hewn_put_u64(to, zip->count);
    to = hewn_put_u64(to, zip->count);
    to = hewn_put_u64(to, zip->written - begin);
    to = hewn_put_u64(to, begin);
    to = hewn_put_u32(to, LOCATOR_64);
    to = hewn_put_u32(to, 0);
    to = hewn_put_u64(to, zip->written);
    return hewn_put_u32(to, 1);
}

hewn_result hewn_zip_finish(hewn_zip *zip, hewn_error *error)
{
    uint64_t begin = zip->written;
    for (size_t i = 0; i < zip->count; i++)
        HEWN_TRY(put_entry(zip, &zip->parts[i], error));
    bool far = begin >= ELSEWHERE;
    char tail[128], *at = far ? put_end_64(zip, begin, tail) : tail;
    at = hewn_put_u32(at, END);
    at = hewn_put_u32(at, 0);
    at = hewn_put_u16(at, (uint32_t)zip->count);
    at = hewn_put_u16(at, (uint32_t)zip->count);
    at = hewn_put_u32(at, (uint32_t)(zip->written - begin));
    at = hewn_put_u32(at, far ? ELSEWHERE : (uint32_t)begin);
    at = hewn_put_u16(at, 0);
    return put(zip, tail, (size_t)(at - tail), error);
}
