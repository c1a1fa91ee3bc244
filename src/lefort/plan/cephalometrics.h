/// \file
/// Angles and distances between landmarks, as orthodontists and surgeons tell a face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/landmarks.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::plan {

/// One line of the table.
struct Measurement {
  std::string name;             ///< "SNA", "ANS-Me".
  std::string meaning;          ///< One line for people.
  std::string unit;             ///< "deg" or "mm".
  std::optional<double> value;  ///< Nothing if a landmark it needs is not there, or it does not
                                ///< exist, as the angle of a line between two points in one.
};

/// The whole table (docs/guide/landmarks.md gives each definition), always with the same lines.
///
/// Angles, and distances that profiles are judged by, are of the landmarks seen from the side:
/// along patient_left_axis(frame), as on a lateral cephalogram without its magnification. The
/// Frankfurt horizontal is that of `frame`, too. Widths are in space. Sides of a pair are taken at
/// their middle.
///
/// \param frame  landmarks that tell how the head lies; before surgery those of the same head, so
///   that the frame does not move with a bone.
/// \returns kPlanInvalid if sides of `frame` are exchanged (see patient_left_axis()).
[[nodiscard]] Result<std::vector<Measurement>> measure(std::span<const Landmark> landmarks,
                                                       std::span<const Landmark> frame);

/// The same in the frame of the landmarks themselves.
[[nodiscard]] Result<std::vector<Measurement>> measure(std::span<const Landmark> landmarks);

}  // namespace lefort::plan
