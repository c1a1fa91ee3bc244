/// \file
/// Geometry of a CT series: sorts slices into a regular stack.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>
#include <lefort/io/imported_volume.h>
#include <lefort/io/internal/dicom_header.h>

#include <string>
#include <vector>

namespace lefort::io {

/// Sorted slices and their grid.
struct DicomStack {
  std::vector<DicomHeader> slices;
  image::Grid grid;  ///< Of the result; its slice k is slices[k] if `origins_L` is empty.
  std::vector<Vec3> origins_L;  ///< Positions of the slices if they must be resampled to `grid`.
  StackReport report;
  std::vector<std::string> warnings;
};

/// Conversion of stored values to HU: slope * value + intercept.
struct Rescale {
  double slope = 1.0;
  double intercept = 0.0;
};

/// Sorts the slices of one series along their normal and checks that they form a regular grid.
///
/// Copies of a slice and localizers are omitted with a warning. A stack that is evenly sheared
/// (gantry tilt) and one with several slice distances, each over at least three steps, must be
/// resampled, with a warning.
///
/// \param slices  headers of one series, in any order.
/// \returns the stack, or
///   - kFileUnsupported  there are fewer than two slices; position, orientation or pixel spacing is
///                       missing; a file has several frames or colors, or more than 8192 pixels
///                       along a side; slices with several distances are more than 5 mm apart; or
///                       the gantry tilt is more than 45 degrees;
///   - kFileCorrupt      image axes are not orthogonal unit vectors; slices differ in size, spacing
///                       or orientation, have equal positions, are missing, unevenly spaced or
///                       displaced sideways.
/// \note Unless resampled, the slices of the grid are equidistant, with distance and position from
///   a least-squares fit: the deviation of a slice is at most 0.1 slice distances along the normal
///   and half a pixel in its plane.
[[nodiscard]] Result<DicomStack> stack_dicom_slices(std::vector<DicomHeader> slices);

/// Returns the rescaling of each slice. A tag that no slice contains has its default, with a
/// warning.
///
/// \param slices    of one series.
/// \param warnings  to which warnings are appended.
/// \returns one per slice; or kFileCorrupt if only some slices contain a tag, since the default
///   would give the others another scale, or if a value is not finite or a slope is 0.
[[nodiscard]] Result<std::vector<Rescale>> rescales_of(const std::vector<DicomHeader>& slices,
                                                       std::vector<std::string>& warnings);

}  // namespace lefort::io
