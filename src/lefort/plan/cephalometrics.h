/// \file
/// Angles and distances between landmarks, as orthodontists and surgeons tell a face.
#pragma once

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
  std::optional<double> value;  ///< Nothing if a landmark it needs is not there.
};

/// The whole table (docs/landmarks.md gives each definition), always with the same lines.
///
/// Angles, and distances that profiles are judged by, are of the landmarks seen from the side:
/// along left_of(landmarks), as on a lateral cephalogram without its magnification. Widths are in
/// space. Sides of a pair are taken at their middle.
[[nodiscard]] std::vector<Measurement> measure(std::span<const Landmark> landmarks);

}  // namespace lefort::plan
