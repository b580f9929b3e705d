#include <string.h>
#include <sys/stat.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/volume/formats.h"

static hewn_volume_format_read reader_of(hewn_volume_format format)
{
    switch (format) {
    case HEWN_VOLUME_NIFTI: return hewn_nifti_read;
    case HEWN_VOLUME_NRRD: return hewn_nrrd_read;
    case HEWN_VOLUME_METAIMAGE: return hewn_metaimage_read;
    case HEWN_VOLUME_RAW: return hewn_raw_read;
    case HEWN_VOLUME_NPY: return hewn_npy_read;
    case HEWN_VOLUME_INR: return hewn_inr_read;
    case HEWN_VOLUME_TIFF: return hewn_tiff_read;
    case HEWN_VOLUME_VDB: return hewn_vdb_read;
    case HEWN_VOLUME_DICOM: return hewn_dicom_read;
    case HEWN_VOLUME_UNKNOWN: break;
    }
    return NULL;
}

static bool is_folder(const char *path)
{
    struct stat status;
    return strcmp(path, "-") != 0 && stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* Whether `path` is the samples of a pair of NIfTI: then its header is what must be read. */
static bool is_image(const char *path)
{
    const char *twin_of[] = {".img", ".IMG", ".img.gz", ".IMG.GZ"};
    size_t length = strlen(path);
    for (size_t i = 0; i < sizeof twin_of / sizeof *twin_of; i++)
        if (length > strlen(twin_of[i]) && strcmp(path + length - strlen(twin_of[i]), twin_of[i]) == 0)
            return true;
    return false;
}

static hewn_result read_file(const char *path, const hewn_volume_read_desc *desc, hewn_volume_format_read read,
                             hewn_volume *out, hewn_error *error)
{
    hewn_volume_source source;
    HEWN_TRY(hewn_volume_source_open(path, desc, &source, error));
    hewn_result result = read(&source, out, error);
    hewn_volume_source_close(&source);
    return result;
}

static hewn_result read_pair(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out, hewn_error *error)
{
    char *header = hewn_nifti_twin(path);
    if (!header)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, path, 0, "out of memory for a file's name");
    hewn_result result = read_file(header, desc, hewn_nifti_read, out, error);
    hewn_free(header);
    return result;
}

hewn_result hewn_volume_read(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out, hewn_error *error)
{
    static const hewn_volume_read_desc defaults;
    hewn_volume_read_desc wanted = desc ? *desc : defaults;
    *out = (hewn_volume){0};
    wanted.format = wanted.format != HEWN_VOLUME_UNKNOWN ? wanted.format : hewn_volume_format_of_file(path);
    hewn_volume_format_read read = reader_of(wanted.format);
    if (!read)
        return hewn_fail_at(
            error, HEWN_INVALID_ARGUMENT, path, 0,
            "no format of volumes that can be read; known extensions are .nii, .hdr, .nrrd, .nhdr, .mha, "
            ".mhd, .raw, .npy, .inr, .tif, .vdb and .dcm, also with .gz, and folders of DICOM");
    if (is_folder(path) && wanted.format == HEWN_VOLUME_DICOM)
        return hewn_dicom_read_folder(path, &wanted, out, error);
    if (wanted.format == HEWN_VOLUME_NIFTI && is_image(path))
        return read_pair(path, &wanted, out, error);
    return read_file(path, &wanted, read, out, error);
}
