#include "io/shim/dicom.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <sstream>
#include <string>
#include <utility>

#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>

struct hewn_dicom {
    gdcm::ImageReader reader;
};

namespace
{

/* GDCM talks to stderr otherwise. */
void keep_silent()
{
    static std::once_flag once;
    std::call_once(once, [] {
        gdcm::Trace::WarningOff();
        gdcm::Trace::DebugOff();
        gdcm::Trace::ErrorOff();
    });
}

hewn_dicom_result fail(char *message, size_t room, const std::string &text)
{
    std::snprintf(message, room, "%s", text.c_str());
    for (char *at = message; *at; at++)
        if (static_cast<unsigned char>(*at) < 0x20 || static_cast<unsigned char>(*at) >= 0x7f)
            *at = '?';
    return HEWN_DICOM_BAD;
}

/* The text of an element, without the blanks and zeroes that make its length even. */
void copy_text(const gdcm::DataSet &from, const gdcm::Tag &tag, char *out, size_t room)
{
    out[0] = '\0';
    if (!from.FindDataElement(tag))
        return;
    const gdcm::ByteValue *value = from.GetDataElement(tag).GetByteValue();
    if (!value || !value->GetPointer())
        return;
    std::string text(value->GetPointer(), value->GetLength());
    while (!text.empty() && (text.back() == ' ' || text.back() == '\0'))
        text.pop_back();
    fail(out, room, text);
}

bool has_value(const gdcm::DataSet &from, const gdcm::Tag &tag)
{
    return from.FindDataElement(tag) && !from.GetDataElement(tag).IsEmpty();
}

/* A decimal string; what is none leaves `out` alone. */
void copy_number(const gdcm::DataSet &from, const gdcm::Tag &tag, double *out)
{
    char text[80];
    double value;
    copy_text(from, tag, text, sizeof text);
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    if (stream >> value)
        *out = value;
}

void tell_header(const gdcm::File &file, hewn_dicom_facts *facts)
{
    const gdcm::DataSet &set = file.GetDataSet();
    double instance = 0;
    *facts = hewn_dicom_facts{};
    copy_text(set, gdcm::Tag(0x0020, 0x000e), facts->series, sizeof facts->series);
    copy_text(set, gdcm::Tag(0x0008, 0x103e), facts->description, sizeof facts->description);
    copy_text(set, gdcm::Tag(0x0008, 0x0060), facts->modality, sizeof facts->modality);
    copy_number(set, gdcm::Tag(0x0020, 0x0013), &instance);
    facts->instance = instance > -1e9 && instance < 1e9 ? int32_t(instance) : 0;
    std::snprintf(facts->transfer, sizeof facts->transfer, "%s",
                  file.GetHeader().GetDataSetTransferSyntax().GetString()
                      ? file.GetHeader().GetDataSetTransferSyntax().GetString()
                      : "");
    facts->has_image = has_value(set, gdcm::Tag(0x0028, 0x0010)) && has_value(set, gdcm::Tag(0x0028, 0x0011));
    facts->has_place = (has_value(set, gdcm::Tag(0x0020, 0x0032)) && has_value(set, gdcm::Tag(0x0020, 0x0037))) ||
                       has_value(set, gdcm::Tag(0x5200, 0x9229)) || has_value(set, gdcm::Tag(0x5200, 0x9230));
}

void tell_image(const gdcm::Image &image, const gdcm::DataSet &set, hewn_dicom_facts *facts)
{
    const gdcm::PixelFormat &format = image.GetPixelFormat();
    for (unsigned axis = 0; axis < 3; axis++) {
        facts->dims[axis] = axis < image.GetNumberOfDimensions() ? image.GetDimension(axis) : 1;
        facts->origin[axis] = image.GetOrigin(axis);
        facts->spacing[axis] = image.GetSpacing(axis);
    }
    for (unsigned i = 0; i < 6; i++)
        facts->directions[i] = image.GetDirectionCosines(i);
    auto type = format.GetScalarType();
    facts->real = type == gdcm::PixelFormat::FLOAT32 || type == gdcm::PixelFormat::FLOAT64;
    facts->is_signed = format.GetPixelRepresentation() != 0;
    facts->bits =
        type == gdcm::PixelFormat::UINT12 || type == gdcm::PixelFormat::INT12 || type == gdcm::PixelFormat::SINGLEBIT
            ? 0
            : format.GetBitsAllocated();
    auto meaning = image.GetPhotometricInterpretation();
    facts->single = format.GetSamplesPerPixel() == 1 && (meaning == gdcm::PhotometricInterpretation::MONOCHROME1 ||
                                                         meaning == gdcm::PhotometricInterpretation::MONOCHROME2);
    /* What the file says: GDCM leaves it out for some kinds of images. Enhanced files have it in a sequence. */
    facts->slope = image.GetSlope();
    facts->intercept = image.GetIntercept();
    copy_number(set, gdcm::Tag(0x0028, 0x1053), &facts->slope);
    copy_number(set, gdcm::Tag(0x0028, 0x1052), &facts->intercept);
}

/* Bytes from the first pixel to the end of the file, whatever the element claims: found by the element's own bytes, in
 * each of the three ways to write it. `length` where it is not found. */
size_t bytes_of_pixels(const char *bytes, size_t length, uint32_t claimed)
{
    auto little = [claimed](int shift) { return char(claimed >> shift & 0xff); };
    const char implicit[] = {'\xe0', '\x7f', '\x10', '\0', little(0), little(8), little(16), little(24)};
    const char plain[] = {'\xe0', '\x7f', '\x10',    '\0',      'O',        'W',
                          '\0',   '\0',   little(0), little(8), little(16), little(24)};
    const char big[] = {'\x7f', '\xe0', '\0',       '\x10',     'O',       'W',
                        '\0',   '\0',   little(24), little(16), little(8), little(0)};
    const std::pair<const char *, size_t> ways[] = {
        {implicit, sizeof implicit}, {plain, sizeof plain}, {big, sizeof big}};
    for (auto [pattern, size] : ways) {
        for (size_t at = 0; at + size <= length; at++) {
            bool same = true;
            for (size_t i = 0; same && i < size; i++) /* VR is OW or OB */
                same = bytes[at + i] == pattern[i] || (pattern[i] == 'W' && bytes[at + i] == 'B');
            if (same)
                return length - at - size;
        }
    }
    return length;
}

/* GDCM fills with zeroes what a file that was cut short lacks. */
bool is_cut_short(const gdcm::Image &image, const char *bytes, size_t length)
{
    const gdcm::TransferSyntax &syntax = image.GetTransferSyntax();
    const gdcm::ByteValue *raw = image.GetDataElement().GetByteValue();
    if (syntax.IsEncapsulated() || syntax == gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian)
        return false; /* unpacking finds it out */
    return !raw || image.GetBufferLength() > bytes_of_pixels(bytes, length, raw->GetLength());
}

/* GDCM makes room for what a header claims; unpacking is not believed to gain more than this. */
bool is_likely(const gdcm::Image &image, size_t length)
{
    uint64_t pixels = 1;
    for (unsigned axis = 0; axis < image.GetNumberOfDimensions(); axis++)
        if (__builtin_mul_overflow(pixels, uint64_t(image.GetDimension(axis)), &pixels))
            return false;
    uint64_t most = image.GetTransferSyntax().IsEncapsulated() ? 8192 : 1;
    return pixels <= UINT64_MAX / 64 && pixels * image.GetPixelFormat().GetPixelSize() <= length * most;
}

hewn_dicom_result glance(const char *bytes, size_t length, hewn_dicom_facts *facts)
try {
    *facts = hewn_dicom_facts{};
    keep_silent();
    std::istringstream stream(std::string(bytes, length));
    gdcm::Reader reader;
    reader.SetStream(stream);
    if (!reader.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0010)))
        return HEWN_DICOM_BAD;
    tell_header(reader.GetFile(), facts);
    return HEWN_DICOM_OK;
} catch (const std::bad_alloc &) {
    return HEWN_DICOM_OUT_OF_MEMORY;
} catch (...) {
    return HEWN_DICOM_BAD;
}

hewn_dicom_result open_file(const char *bytes, size_t length, hewn_dicom **out, hewn_dicom_facts *facts, char *message,
                            size_t room)
try {
    *out = nullptr;
    *facts = hewn_dicom_facts{};
    keep_silent();
    std::istringstream stream(std::string(bytes, length));
    auto file = std::make_unique<hewn_dicom>();
    file->reader.SetStream(stream);
    if (!file->reader.Read()) {
        hewn_dicom_facts header;
        if (glance(bytes, length, &header) != HEWN_DICOM_OK || header.transfer[0] == '\0')
            return fail(message, room, "not a DICOM file, or damaged");
        if (!header.has_image)
            return fail(message, room, "a DICOM file without an image");
        return fail(message, room,
                    std::string("its image is damaged, cut short, or in a transfer syntax that is not supported (") +
                        header.transfer + ")");
    }
    const gdcm::Image &image = file->reader.GetImage();
    tell_header(file->reader.GetFile(), facts);
    if (!is_likely(image, length))
        return fail(message, room, "its header tells of more pixels than the file can hold");
    if (is_cut_short(image, bytes, length))
        return fail(message, room, "it ends before its last pixel");
    tell_image(image, file->reader.GetFile().GetDataSet(), facts);
    *out = file.release();
    return HEWN_DICOM_OK;
} catch (const std::bad_alloc &) {
    std::snprintf(message, room, "out of memory");
    return HEWN_DICOM_OUT_OF_MEMORY;
} catch (const std::exception &failure) {
    return fail(message, room, failure.what());
} catch (...) {
    return fail(message, room, "GDCM cannot read it");
}

hewn_dicom_result copy_pixels(const hewn_dicom *file, void *out, size_t length, char *message, size_t room)
try {
    const gdcm::Image &image = file->reader.GetImage();
    if (image.GetBufferLength() != length)
        return fail(message, room, "its pixels are not as many as its header tells");
    const gdcm::ByteValue *raw = image.GetDataElement().GetByteValue();
    bool packed = image.GetTransferSyntax().IsEncapsulated();
    if (!packed && (!raw || raw->GetLength() < length))
        return fail(message, room, "it ends before its last pixel");
    if (!image.GetBuffer(static_cast<char *>(out)))
        return fail(message, room,
                    std::string("its pixels cannot be unpacked (transfer syntax ") +
                        (image.GetTransferSyntax().GetString() ? image.GetTransferSyntax().GetString() : "unknown") +
                        ")");
    return HEWN_DICOM_OK;
} catch (const std::bad_alloc &) {
    std::snprintf(message, room, "out of memory");
    return HEWN_DICOM_OUT_OF_MEMORY;
} catch (const std::exception &failure) {
    return fail(message, room, failure.what());
} catch (...) {
    return fail(message, room, "GDCM cannot unpack its pixels");
}

void close_file(hewn_dicom **file)
{
    delete *file;
    *file = nullptr;
}

} // namespace

/* io/shim/module.h looks for this name. */
extern "C" __attribute__((visibility("default"))) const hewn_dicom_module hewn_module_table;
const hewn_dicom_module hewn_module_table = {glance, open_file, copy_pixels, close_file};
