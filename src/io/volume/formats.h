/* The formats' own readers, behind hewn_volume_read(). */
#ifndef HEWN_SRC_IO_VOLUME_FORMATS_H
#define HEWN_SRC_IO_VOLUME_FORMATS_H

#include "io/volume/source.h"

hewn_result hewn_inr_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_metaimage_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_nifti_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_npy_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_nrrd_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_raw_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_tiff_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_vdb_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);

/* One DICOM file from memory, */
hewn_result hewn_dicom_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error);

/* and a folder of them. */
hewn_result hewn_dicom_read_folder(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out,
                                   hewn_error *error);

/* What the three above have done in a process of its own (io/volume/apart.h). */
hewn_result hewn_vdb_read_here(const hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_dicom_read_here(const hewn_volume_source *source, hewn_volume *out, hewn_error *error);
hewn_result hewn_dicom_read_folder_here(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out,
                                        hewn_error *error);

/* What the extension of NIfTI's header or samples says of where the other one is: "brain.img" of "brain.hdr" and the
 * way back, to be freed; NULL where `path` is neither or memory is short. */
char *hewn_nifti_twin(const char *path);

#endif
