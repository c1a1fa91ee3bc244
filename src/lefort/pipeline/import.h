/// \file
/// Import of scans from a file, a DICOM folder or a server, and the synthetic head.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <string>

namespace lefort::pipeline {

struct ImportJob {
  std::filesystem::path source;
  std::filesystem::path output;    ///< .nrrd, .nii.gz or .mha.
  int series = 0;                  ///< Of a DICOM folder or study; 0: the only CT.
  std::string user{}, password{};  ///< Of a DICOMweb server, unless they are in its address.
};

/// Reads a scan in any format; writes a volume in HU and frame L.
[[nodiscard]] Result<Summary> import_scan(const ImportJob& job, Progress& progress);

/// Lists the series of a DICOM folder or study. The output of the job is not used.
[[nodiscard]] Result<Summary> list_scans(const ImportJob& job, Progress& progress);

/// How the synthetic head is scanned: axial slices; with gantry tilt; names of files not
/// in the order of slices; oblique to the axes of the patient; feet first.
enum class PhantomVariant { kPlain, kTilted, kShuffled, kOblique, kFeetFirst };
struct PhantomJob {
  std::filesystem::path output;  ///< A folder; made if missing.
  PhantomVariant variant = PhantomVariant::kPlain;
  double voxel_mm = 1.4;
  double noise_hu = 12.0;  ///< Standard deviation.
};

/// Writes DICOM files of a synthetic head (anatomy/synthetic_head.h), and its true labels.
[[nodiscard]] Result<Summary> make_phantom(const PhantomJob& job, Progress& progress);

}  // namespace lefort::pipeline
