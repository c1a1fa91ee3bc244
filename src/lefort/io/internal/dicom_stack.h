/// \file
/// Slices in any order to a regular stack: the geometry of a CT series.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>
#include <lefort/io/imported_volume.h>
#include <lefort/io/internal/dicom_header.h>

#include <string>
#include <vector>

namespace lefort::io {

/// Slices from one end to the other, and the grid they make.
struct DicomStack {
  std::vector<DicomHeader> slices;
  image::Grid grid;  ///< Of the result. Slice k of it is slices[k], unless `origins_L` has entries.
  std::vector<Vec3> origins_L;  ///< Where the slices lie if they must be resampled to `grid`.
  StackReport report;
  std::vector<std::string> warnings;
};

/// What turns the stored values of a slice into HU: slope * value + intercept.
struct Rescale {
  double slope = 1.0;
  double intercept = 0.0;
};

/// Sorts the slices of one series along their normal and checks that they make a regular grid.
///
/// Copies of a slice and localizers are left out with a warning. A stack that slides sideways
/// evenly, as a tilted gantry makes it, and one of several distances, each of at least three steps,
/// are to be resampled, with a warning.
///
/// \returns the stack, or
///   - kFileUnsupported  a tag that places the slices is missing, several frames or colors in a
///                       file, or a gantry tilted by more than any can be;
///   - kFileCorrupt      slices that differ in size, spacing or orientation, lie at one place, are
///                       missing, are unevenly spaced, or lie beside the others.
/// \note Unless resampled, the grid's slices lie evenly where least squares puts them: a slice is
///   at most 0.1 slice distances away along the normal, and half a pixel across it from the first.
[[nodiscard]] Result<DicomStack> stack_dicom_slices(std::vector<DicomHeader> slices);

/// The rescaling of each slice. A tag that no slice carries has its default, with a warning.
///
/// \returns kFileCorrupt when only some slices carry a tag, or one is not finite or a slope is 0:
///   the default would put those slices onto another scale than their neighbors.
[[nodiscard]] Result<std::vector<Rescale>> rescales_of(const std::vector<DicomHeader>& slices,
                                                       std::vector<std::string>& warnings);

}  // namespace lefort::io
