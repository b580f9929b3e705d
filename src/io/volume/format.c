#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "hewn/volume_io.h"

static const struct {
    const char *extension;
    hewn_volume_format format;
} extensions[] = {{"nii", HEWN_VOLUME_NIFTI},     {"hdr", HEWN_VOLUME_NIFTI}, {"img", HEWN_VOLUME_NIFTI},
                  {"nrrd", HEWN_VOLUME_NRRD},     {"nhdr", HEWN_VOLUME_NRRD}, {"mha", HEWN_VOLUME_METAIMAGE},
                  {"mhd", HEWN_VOLUME_METAIMAGE}, {"raw", HEWN_VOLUME_RAW},   {"npy", HEWN_VOLUME_NPY},
                  {"inr", HEWN_VOLUME_INR},       {"tif", HEWN_VOLUME_TIFF},  {"tiff", HEWN_VOLUME_TIFF},
                  {"vdb", HEWN_VOLUME_VDB},       {"dcm", HEWN_VOLUME_DICOM}, {"dicom", HEWN_VOLUME_DICOM}};

static const char *const names[] = {
    [HEWN_VOLUME_NIFTI] = "nifti", [HEWN_VOLUME_NRRD] = "nrrd", [HEWN_VOLUME_METAIMAGE] = "metaimage",
    [HEWN_VOLUME_RAW] = "raw",     [HEWN_VOLUME_NPY] = "npy",   [HEWN_VOLUME_INR] = "inr",
    [HEWN_VOLUME_TIFF] = "tiff",   [HEWN_VOLUME_VDB] = "vdb",   [HEWN_VOLUME_DICOM] = "dicom"};

hewn_volume_format hewn_volume_format_of(const char *path_or_extension)
{
    if (!path_or_extension)
        return HEWN_VOLUME_UNKNOWN;
    const char *slash = strrchr(path_or_extension, '/'), *base = slash ? slash + 1 : path_or_extension;
    size_t length = strlen(base), begin;
    if (length > 3 && strcasecmp(base + length - 3, ".gz") == 0)
        length -= 3;
    for (begin = length; begin > 0 && base[begin - 1] != '.';)
        begin--;
    if (begin == 0 && slash)
        return HEWN_VOLUME_UNKNOWN; /* "nii" alone is an extension, "out/nii" has none */
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (strlen(extensions[i].extension) == length - begin &&
            strncasecmp(base + begin, extensions[i].extension, length - begin) == 0)
            return extensions[i].format;
    return HEWN_VOLUME_UNKNOWN;
}

/* What a file is that begins so. */
static hewn_volume_format format_of_bytes(const char *bytes, size_t length)
{
    static const struct {
        size_t at, length;
        const char *magic;
        hewn_volume_format format;
    } magics[] = {{0, 7, "NRRD000", HEWN_VOLUME_NRRD},       {0, 6, "\x93NUMPY", HEWN_VOLUME_NPY},
                  {0, 13, "#INRIMAGE-4#{", HEWN_VOLUME_INR}, {0, 4, " BDV", HEWN_VOLUME_VDB},
                  {128, 4, "DICM", HEWN_VOLUME_DICOM},       {344, 4, "n+1", HEWN_VOLUME_NIFTI},
                  {344, 4, "ni1", HEWN_VOLUME_NIFTI},        {4, 4, "n+2", HEWN_VOLUME_NIFTI},
                  {4, 4, "ni2", HEWN_VOLUME_NIFTI},          {0, 4, "II*", HEWN_VOLUME_TIFF},
                  {0, 4, "MM\0*", HEWN_VOLUME_TIFF},         {0, 4, "II+", HEWN_VOLUME_TIFF},
                  {0, 4, "MM\0+", HEWN_VOLUME_TIFF},         {0, 10, "ObjectType", HEWN_VOLUME_METAIMAGE},
                  {0, 5, "NDims", HEWN_VOLUME_METAIMAGE}};
    for (size_t i = 0; i < sizeof magics / sizeof *magics; i++)
        if (length >= magics[i].at + magics[i].length &&
            memcmp(bytes + magics[i].at, magics[i].magic, magics[i].length) == 0)
            return magics[i].format;
    return HEWN_VOLUME_UNKNOWN;
}

hewn_volume_format hewn_volume_format_of_file(const char *path)
{
    char bytes[352];
    struct stat status;
    if (strcmp(path, "-") == 0)
        return HEWN_VOLUME_UNKNOWN;
    bool exists = stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode))
        return HEWN_VOLUME_DICOM;
    hewn_volume_format format = hewn_volume_format_of(path);
    if (format != HEWN_VOLUME_UNKNOWN || !exists || !S_ISREG(status.st_mode))
        return format;
    FILE *file = fopen(path, "rbe");
    size_t length = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    if (file)
        fclose(file);
    return format_of_bytes(bytes, length);
}

const char *hewn_volume_format_name(hewn_volume_format format)
{
    return format > HEWN_VOLUME_UNKNOWN && (size_t)format < sizeof names / sizeof *names ? names[format] : NULL;
}

bool hewn_volume_format_find(const char *name, hewn_volume_format *out)
{
    for (size_t i = 1; i < sizeof names / sizeof *names; i++) {
        if (strcmp(names[i], name) == 0) {
            *out = (hewn_volume_format)i;
            return true;
        }
    }
    return false;
}
