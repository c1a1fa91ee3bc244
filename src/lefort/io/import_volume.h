/// \file
/// Reads a head scan from any supported source.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/dicom.h>
#include <lefort/io/dicomweb.h>
#include <lefort/io/imported_volume.h>

#include <filesystem>

namespace lefort::io {

struct ImportOptions {
  int series = 0;  ///< Number of the DICOM series in list_scans(), from 1; 0: the only CT.
  Credentials credentials{};  ///< Of a DICOMweb server whose address contains none.
};

/// Reads a folder of DICOM files, a NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage (.mha,
/// .mhd) file, an InVesalius project (.inv3), or a study of a DICOMweb server (dicomweb.h).
///
/// The result is in Hounsfield units and in frame L. Oblique direction cosines are preserved;
/// left-handed ones are converted to a rotation by reversing the order of slices. Values beyond the
/// 12-bit range of a CT are clamped to -1024 ... 3071 and NaN becomes -1024; a warning reports
/// their number.
///
/// Messages do not contain `source` or the names of files, since these often contain patient names.
///
/// \param source    a path or the address of a study.
/// \param options   number of the series, credentials.
/// \param progress  stages, requests to stop.
/// \returns the scan, or
///   - kFileNotFound     `source` does not exist;
///   - kFileUnsupported  ending, number of dimensions, color or modality is not supported;
///   - kFileCorrupt      truncated, damaged, slices missing, or an invalid grid;
///   - kInvalidArgument  several series and none chosen (the message lists them);
///   - kCancelled        `progress` requested a stop;
///   - the errors of read_dicomweb().
[[nodiscard]] Result<ImportedVolume> import_volume(const std::filesystem::path& source,
                                                   const ImportOptions& options,
                                                   Progress& progress = Progress::none());

/// Lists the series of a folder of DICOM files, or of a study of a DICOMweb server.
///
/// \param source    a folder or the address of a study.
/// \param options   credentials.
/// \param progress  stage, requests to stop.
/// \returns the series, or the errors of list_dicom_series() and list_dicomweb().
[[nodiscard]] Result<std::vector<DicomSeriesInfo>> list_scans(
    const std::filesystem::path& source, const ImportOptions& options,
    Progress& progress = Progress::none());

/// As above with default options.
///
/// \param source    a path or the address of a study.
/// \param progress  stages, requests to stop.
/// \returns as above.
[[nodiscard]] Result<ImportedVolume> import_volume(const std::filesystem::path& source,
                                                   Progress& progress = Progress::none());

}  // namespace lefort::io
