/// \file
/// Result of every reader of scans.
#pragma once

#include <lefort/image/volume.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// Positions of the slices of a series before conversion to a grid.
struct StackReport {
  Index slices = 0;
  double min_step_mm = 0.0, max_step_mm = 0.0;  ///< Slice distance along the normal.
  double tilt_deg = 0.0;                        ///< Shear angle of the stack (gantry tilt).
  bool resampled = false;                       ///< To a regular grid.
};

/// A head scan in Hounsfield units, in frame L, with warnings for the user.
///
/// It never contains a name, date, identifier or text of the patient.
struct ImportedVolume {
  image::CtVolume ct;
  std::vector<std::string> warnings;   ///< One sentence each: repairs and suspicious values.
  std::optional<StackReport> stack{};  ///< For DICOM files.
  std::string source_kind;             ///< "DICOM series", "NRRD", "NIfTI", "MetaImage", ...
};

}  // namespace lefort::io
