/// \file
/// What every reader of scans hands back.
#pragma once

#include <lefort/image/volume.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// How the slices of a series lay before they became a grid.
struct StackReport {
  Index slices = 0;
  double min_step_mm = 0.0, max_step_mm = 0.0;  ///< From slice to slice, along the normal.
  double tilt_deg = 0.0;                        ///< By which the stack was sheared.
  bool resampled = false;
};

/// A head scan in Hounsfield units, in L, with what the user should know of it.
///
/// No name, date, identifier or text of the patient is in it, whatever the file held.
struct ImportedVolume {
  image::CtVolume ct;
  std::vector<std::string> warnings;   ///< One sentence each; what was repaired or looks odd.
  std::optional<StackReport> stack{};  ///< Of DICOM files.
  std::string source_kind;             ///< "DICOM series", "NRRD", "NIfTI", "MetaImage", ...
};

}  // namespace lefort::io
