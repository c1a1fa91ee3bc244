/// \file
/// Scans in: from a file, a folder of DICOM or a server, and the synthetic head.
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
  int series = 0;                  ///< Of a DICOM folder or study; 0: the only CT there is.
  std::string user{}, password{};  ///< Of a DICOMweb server, unless its address has them.
};
/// Scan in any format -> volume in HU and L.
[[nodiscard]] Result<Summary> import_scan(const ImportJob& job, Progress& progress);

/// DICOM folder or study -> what series there are; the job's output is not used.
[[nodiscard]] Result<Summary> list_scans(const ImportJob& job, Progress& progress);

/// How the scanner takes the synthetic head.
enum class PhantomVariant { kPlain, kTilted, kShuffled, kOblique, kFeetFirst };
struct PhantomJob {
  std::filesystem::path output;  ///< A folder; made if missing.
  PhantomVariant variant = PhantomVariant::kPlain;
  double voxel_mm = 1.4;
  double noise_hu = 12.0;
};
/// Nothing -> DICOM files of a synthetic head (anatomy/synthetic_head.h), and its true labels.
[[nodiscard]] Result<Summary> make_phantom(const PhantomJob& job, Progress& progress);

}  // namespace lefort::pipeline
