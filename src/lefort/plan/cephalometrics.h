/// \file
/// Cephalometric analysis: angles and distances between landmarks.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/landmarks.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::plan {

/// One row of the table.
struct Measurement {
  std::string name;             ///< "SNA", "ANS-Me".
  std::string meaning;          ///< One line for readers.
  std::string unit;             ///< "deg" or "mm".
  std::optional<double> value;  ///< Nothing if a landmark is missing, or the value is undefined,
                                ///< such as the angle of a line between two equal points.
};

/// Computes all measurements (defined in docs/guide/landmarks.md), always with the same rows.
///
/// Angles and distances are computed in lateral projection, along patient_left_axis(frame),
/// as on a lateral cephalogram without magnification. The Frankfurt horizontal is that of `frame`.
/// Widths are three-dimensional distances of pairs, not projected. Otherwise a pair is represented
/// by its midpoint.
///
/// \param landmarks  to be measured.
/// \param frame      landmarks that define the orientation of the head; those before surgery, so
///   that the frame does not move with a segment.
/// \returns the table, or kPlanInvalid if right and left of `frame` are exchanged (see
///   patient_left_axis()).
[[nodiscard]] Result<std::vector<Measurement>> measure(std::span<const Landmark> landmarks,
                                                       std::span<const Landmark> frame);

/// Computes all measurements in the frame of the landmarks themselves.
///
/// \param landmarks  to be measured.
/// \returns as above.
[[nodiscard]] Result<std::vector<Measurement>> measure(std::span<const Landmark> landmarks);

}  // namespace lefort::plan
