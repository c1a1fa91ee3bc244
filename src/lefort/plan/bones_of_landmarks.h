/// \file
/// Finds the bone that each landmark of bone or teeth lies on.
#pragma once

#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lefort::plan {

/// A landmark belongs to the closest bone within 5 mm. A landmark on a cut is almost equally close
/// to both sides: up to a difference of 0.5 mm, half the accuracy of picking, it belongs to the
/// segment; between two segments, to the first one in the plan.
///
/// \param landmarks_L  before surgery.
/// \param cut          the bones before they move.
/// \returns one entry per landmark: the index of the segment; for the remainder, the number of
///   segments; nothing for landmarks of the skin and landmarks that are not on bone.
[[nodiscard]] std::vector<std::optional<std::size_t>> bones_of_landmarks(
    std::span<const Landmark> landmarks_L, const CutSegments& cut);

}  // namespace lefort::plan
