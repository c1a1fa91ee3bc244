/// \file
/// Reads a head scan from whatever the user has.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/dicom.h>
#include <lefort/io/dicomweb.h>
#include <lefort/io/imported_volume.h>

#include <filesystem>

namespace lefort::io {

struct ImportOptions {
  int series = 0;             ///< Of DICOM: counted from 1 as list_scans() does; 0: the only CT.
  Credentials credentials{};  ///< Of a DICOMweb server, unless its address has them.
};

/// Reads a folder of DICOM files, a NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage (.mha,
/// .mhd) file, an InVesalius project (.inv3), or a study of a DICOMweb server (dicomweb.h).
///
/// The result is in Hounsfield units and in L. Oblique direction cosines are kept; left-handed
/// ones are made a rotation by reversing the order of slices. Values beyond the 12-bit range of a
/// CT, and those that are no numbers, are brought to -1024 ... 3071 and counted in a warning.
///
/// Messages name neither `source` nor a file in it, since people name these after patients.
///
/// \returns the scan, or
///   - kFileNotFound     there is nothing at `source`;
///   - kFileUnsupported  not a scan we read: ending, number of dimensions, color, modality;
///   - kFileCorrupt      truncated, damaged, slices missing, or a grid that cannot be;
///   - kInvalidArgument  several series and none chosen (the message lists them);
///   - kCancelled        `progress` asked to stop;
///   - those of fetch_dicomweb().
[[nodiscard]] Result<ImportedVolume> import_volume(const std::filesystem::path& source,
                                                   const ImportOptions& options,
                                                   Progress& progress = Progress::none());

/// The series of a folder of DICOM files, or of a study of a DICOMweb server.
[[nodiscard]] Result<std::vector<DicomSeriesInfo>> list_scans(
    const std::filesystem::path& source, const ImportOptions& options,
    Progress& progress = Progress::none());

/// The same with the options' defaults.
[[nodiscard]] Result<ImportedVolume> import_volume(const std::filesystem::path& source,
                                                   Progress& progress = Progress::none());

}  // namespace lefort::io
