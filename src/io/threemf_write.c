/* 3MF: a ZIP archive (OPC) with the model as XML, after the 3MF Consortium's core specification 1.x; triangles, +Z up.
 * libxml2 writes what needs a structure or escapes; vertices and triangles are digits and go in as text. */
#include <libxml/chvalid.h>
#include <libxml/xmlwriter.h>
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/shim/number.h"
#include "io/target.h"
#include "io/zip.h"

#define CORE "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
#define PACKAGE "http://schemas.openxmlformats.org/package/2006/"

static const char content_types[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types xmlns=\"" PACKAGE "content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";

static const char relationships[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"" PACKAGE "relationships\">"
    "<Relationship Id=\"rel0\" Target=\"/3D/3dmodel.model\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

/* What lives from prepare to release. */
typedef struct writer {
    hewn_conversion conversion;
    char *name; /* of the object, as XML can have it */
} writer;

/* --- before the file ---------------------------------------------------------------------------------------------- */

static const struct {
    const char *name, *in_3mf;
} units[] = {{"um", "micron"}, {"mm", "millimeter"}, {"cm", "centimeter"},
             {"in", "inch"},   {"ft", "foot"},       {"m", "meter"}};

static const char *unit_name(const hewn_unit *unit)
{
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (unit && strcmp(units[i].name, unit->name) == 0)
            return units[i].in_3mf;
    return NULL;
}

static hewn_result fits(const hewn_writing *job, hewn_error *error)
{
    if (job->vertex_count > INT32_MAX || job->triangle_count > INT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu triangles are more than 3MF can number",
                         (unsigned long long)job->vertex_count, (unsigned long long)job->triangle_count);
    return HEWN_OK;
}

/* Bytes that are no UTF-8, and characters that XML cannot have, become U+FFFD. */
static char *clean_name(const char *name)
{
    size_t length = strlen(name), used = 0;
    char *clean = hewn_alloc(3 * length + 1, 1);
    for (const char *at = name; clean && *at;) {
        int size = (int)strnlen(at, 4);
        int code = xmlGetUTF8Char((const unsigned char *)at, &size);
        bool good = code > 0 && xmlIsCharQ(code);
        size_t step = code > 0 ? (size_t)size : 1, length_out = good ? step : 3;
        memcpy(clean + used, good ? at : "\xef\xbf\xbd", length_out);
        used += length_out;
        at += step;
    }
    if (clean)
        clean[used] = '\0';
    return clean;
}

static hewn_result check_positions(const hewn_writing *job, const hewn_conversion *conversion, hewn_error *error)
{
    for (uint64_t v = 0; v < job->vertex_count; v++) {
        double given[3], p[3];
        hewn_writing_position(job, v, given);
        hewn_target_convert(conversion, given, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            return hewn_fail(error, HEWN_LIMIT, "vertex %llu lies too far out to be given in %s", (unsigned long long)v,
                             conversion->unit_after->name);
        if ((v + 1) % (16 * HEWN_WRITE_BLOCK) == 0)
            HEWN_TRY(hewn_progress_report(job->progress, "write", 0, error));
    }
    return HEWN_OK;
}

static hewn_result prepare(hewn_writing *job, hewn_error *error)
{
    writer *own = job->own = hewn_alloc_zero(1, sizeof *own);
    if (own)
        own->name = clean_name(job->name);
    if (!own || !own->name)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    /* 3MF has no kilometres, and takes millimetres where nothing else is said. */
    const hewn_unit *unit = unit_name(job->unit) ? job->unit : hewn_unit_find(job->unit ? "m" : "mm");
    HEWN_TRY(hewn_target_find(job, unit, HEWN_AXIS_PLUS_Z, &own->conversion, error));
    return check_positions(job, &own->conversion, error);
}

static void release(hewn_writing *job)
{
    writer *own = job->own;
    if (own)
        hewn_free(own->name);
    hewn_free(own);
    job->own = NULL;
}

/* --- the model's XML ---------------------------------------------------------------------------------------------- */

/* Where libxml2 puts its bytes, and what became of that. */
typedef struct sink {
    hewn_zip *zip;
    hewn_result result;
    hewn_error *error;
} sink;

static int take_bytes(void *context, const char *bytes, int length)
{
    sink *to = context;
    if (to->result == HEWN_OK)
        to->result = hewn_zip_write(to->zip, bytes, (size_t)length, to->error);
    return to->result == HEWN_OK ? length : -1;
}

/* The writer's own failures are of memory; those of the sink are known better. */
static hewn_result status(const sink *to, int state)
{
    if (to->result != HEWN_OK)
        return to->result;
    return state < 0 ? hewn_fail(to->error, HEWN_OUT_OF_MEMORY, "out of memory writing XML") : HEWN_OK;
}

#define TEXT(literal) ((const xmlChar *)(literal))

static char *put_text(char *to, const char *text)
{
    size_t length = strlen(text);
    memcpy(to, text, length);
    return to + length;
}

/* Digits that read back as the same float where that is what was given, else as the same double. */
static char *put_number(const hewn_writing *job, const hewn_conversion *conversion, double value, char *to)
{
    bool whole = conversion->scale_numerator == conversion->scale_denominator;
    return job->all_float && whole ? hewn_number_print_float(to, (float)value) : hewn_number_print_double(to, value);
}

static char *put_vertex(const hewn_writing *job, uint64_t index, char *to)
{
    static const char *const before[] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
    const writer *own = job->own;
    double given[3], p[3];
    hewn_writing_position(job, index, given);
    hewn_target_convert(&own->conversion, given, p);
    for (int axis = 0; axis < 3; axis++)
        to = put_number(job, &own->conversion, p[axis], put_text(to, before[axis]));
    return put_text(to, "\"/>\n");
}

/* Nothing for a triangle that names a vertex twice, which 3MF does not admit. */
static char *put_triangle(const hewn_writing *job, uint64_t index, char *to)
{
    static const char *const before[] = {"<triangle v1=\"", "\" v2=\"", "\" v3=\""};
    uint64_t place[3];
    uint32_t v[3];
    hewn_writing_triangle(job, index, place);
    for (int k = 0; k < 3; k++)
        v[k] = job->corners[place[k]];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
        return to;
    for (int k = 0; k < 3; k++)
        to = hewn_number_print_unsigned(put_text(to, before[k]), v[k]);
    return put_text(to, "\"/>\n");
}

enum { BLOCK = 256, ITEM_ROOM = 192 };

typedef struct items {
    const char *element;
    char *(*put)(const hewn_writing *job, uint64_t index, char *to);
    uint64_t count;
    double begin, span; /* of progress */
} items;

static hewn_result write_items(const hewn_writing *job, const items *of, xmlTextWriterPtr xml, sink *to)
{
    char room[BLOCK * ITEM_ROOM];
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT(of->element))));
    HEWN_TRY(status(to, xmlTextWriterWriteRaw(xml, TEXT("\n"))));
    for (uint64_t first = 0; first < of->count; first += BLOCK) {
        uint64_t end = of->count - first < BLOCK ? of->count : first + BLOCK;
        char *at = room;
        for (uint64_t i = first; i < end; i++)
            at = of->put(job, i, at);
        HEWN_TRY(status(to, xmlTextWriterWriteRawLen(xml, TEXT(room), (int)(at - room))));
        if (first % HEWN_WRITE_BLOCK == 0)
            HEWN_TRY(hewn_progress_report(job->progress, "write",
                                          of->begin + of->span * (double)first / (double)of->count, to->error));
    }
    return status(to, xmlTextWriterEndElement(xml));
}

static hewn_result write_metadata(xmlTextWriterPtr xml, const char *name, const char *value, sink *to)
{
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("metadata"))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("name"), TEXT(name))));
    HEWN_TRY(status(to, xmlTextWriterWriteString(xml, TEXT(value))));
    return status(to, xmlTextWriterEndElement(xml));
}

/* Who made it, what it is, and what was done to unit and axes. */
static hewn_result write_remarks(const hewn_writing *job, xmlTextWriterPtr xml, sink *to)
{
    const writer *own = job->own;
    hewn_text text = {0};
    hewn_text_print(&text, "Hewn %s", hewn_version());
    hewn_result result = hewn_text_status(&text, to->error);
    if (result == HEWN_OK)
        result = write_metadata(xml, "Application", text.bytes, to);
    if (result == HEWN_OK)
        result = write_metadata(xml, "Title", own->name, to);
    hewn_text_clear(&text);
    bool converted = hewn_target_changes(&own->conversion);
    if (result == HEWN_OK && (converted || job->space)) {
        if (job->space)
            hewn_text_print(&text, "Space: %s%s", job->space, converted ? ". " : "");
        if (converted) {
            hewn_text_append(&text, "Converted: ");
            hewn_target_print(&own->conversion, &text);
        }
        result = hewn_text_status(&text, to->error);
        if (result == HEWN_OK)
            result = write_metadata(xml, "Description", text.bytes, to);
    }
    hewn_text_clear(&text);
    return result;
}

static hewn_result write_object(const hewn_writing *job, xmlTextWriterPtr xml, sink *to)
{
    const writer *own = job->own;
    const items vertices = {"vertices", put_vertex, job->vertex_count, 0, 0.5};
    const items triangles = {"triangles", put_triangle, job->triangle_count, 0.5, 0.5};
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("object"))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("id"), TEXT("1"))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("name"), TEXT(own->name))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("type"), TEXT("model"))));
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("mesh"))));
    HEWN_TRY(write_items(job, &vertices, xml, to));
    HEWN_TRY(write_items(job, &triangles, xml, to));
    HEWN_TRY(status(to, xmlTextWriterEndElement(xml)));
    return status(to, xmlTextWriterEndElement(xml));
}

/* A mesh needs triangles; without any the model is empty. */
static hewn_result write_model(const hewn_writing *job, xmlTextWriterPtr xml, sink *to)
{
    const writer *own = job->own;
    HEWN_TRY(status(to, xmlTextWriterStartDocument(xml, "1.0", "UTF-8", NULL)));
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("model"))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("unit"), TEXT(unit_name(own->conversion.unit_after)))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("xml:lang"), TEXT("en-US"))));
    HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("xmlns"), TEXT(CORE))));
    HEWN_TRY(write_remarks(job, xml, to));
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("resources"))));
    if (job->triangle_count > 0)
        HEWN_TRY(write_object(job, xml, to));
    HEWN_TRY(status(to, xmlTextWriterEndElement(xml)));
    HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("build"))));
    if (job->triangle_count > 0) {
        HEWN_TRY(status(to, xmlTextWriterStartElement(xml, TEXT("item"))));
        HEWN_TRY(status(to, xmlTextWriterWriteAttribute(xml, TEXT("objectid"), TEXT("1"))));
        HEWN_TRY(status(to, xmlTextWriterEndElement(xml)));
    }
    return status(to, xmlTextWriterEndDocument(xml));
}

static hewn_result write_xml(const hewn_writing *job, hewn_zip *zip, hewn_error *error)
{
    sink to = {zip, HEWN_OK, error};
    xmlOutputBufferPtr buffer = xmlOutputBufferCreateIO(take_bytes, NULL, &to, NULL);
    xmlTextWriterPtr xml = buffer ? xmlNewTextWriter(buffer) : NULL; /* which then owns the buffer */
    if (!xml) {
        if (buffer)
            xmlOutputBufferClose(buffer);
        return status(&to, -1);
    }
    hewn_result result = write_model(job, xml, &to);
    if (result == HEWN_OK)
        result = status(&to, xmlTextWriterFlush(xml));
    xmlFreeTextWriter(xml);
    return result == HEWN_OK ? to.result : result;
}

/* --- the package -------------------------------------------------------------------------------------------------- */

static hewn_result write_part(hewn_zip *zip, const char *name, const char *text, hewn_error *error)
{
    HEWN_TRY(hewn_zip_begin(zip, name, false, error));
    HEWN_TRY(hewn_zip_write(zip, text, strlen(text), error));
    return hewn_zip_end(zip, error);
}

static hewn_result write_parts(const hewn_writing *job, hewn_zip *zip, hewn_error *error)
{
    bool large = (job->vertex_count + job->triangle_count) * ITEM_ROOM > UINT32_MAX / 2;
    HEWN_TRY(write_part(zip, "[Content_Types].xml", content_types, error));
    HEWN_TRY(write_part(zip, "_rels/.rels", relationships, error));
    HEWN_TRY(hewn_zip_begin(zip, "3D/3dmodel.model", large, error));
    HEWN_TRY(write_xml(job, zip, error));
    HEWN_TRY(hewn_zip_end(zip, error));
    return hewn_zip_finish(zip, error);
}

static hewn_result write(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    hewn_zip *zip;
    HEWN_TRY(hewn_zip_create(output, &zip, error));
    hewn_result result = write_parts(job, zip, error);
    hewn_zip_destroy(&zip);
    return result == HEWN_OK ? hewn_progress_report(job->progress, "write", 1, error) : result;
}

const hewn_format_writer hewn_3mf_writer = {
    .triangles = true, .fits = fits, .prepare = prepare, .write = write, .release = release};
