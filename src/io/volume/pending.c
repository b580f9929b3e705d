#include "base/error.h"
#include "io/volume/formats.h"
#define P(n)                                                                                                           \
    hewn_result n(hewn_volume_source *source, hewn_volume *out, hewn_error *error)                                     \
    {                                                                                                                  \
        *out = (hewn_volume){0};                                                                                       \
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "pending");                                        \
    }
P(hewn_tiff_read)
P(hewn_vdb_read)
P(hewn_dicom_read)
hewn_result hewn_dicom_read_folder(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out,
                                   hewn_error *error)
{
    (void)desc;
    *out = (hewn_volume){0};
    return hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "pending");
}
