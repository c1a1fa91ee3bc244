/// \file
/// Where on a line the inside of a level ends.
#pragma once

#include <lefort/core/types.h>

#include <functional>
#include <optional>

namespace lefort::mesh {

/// True for points of the tissue. Called by one thread; gives the same answer for the same point.
using InsidePredicate = std::function<bool(const Vec3&)>;

/// The t nearest to 0 found for which is_inside changes at p + t * direction.
///
/// Looks outwards from inside and inwards from outside, in steps that double from `tolerance_mm`;
/// so a layer thinner than its distance from p may be overlooked.
///
/// \param direction   outward, unit length.
/// \returns t within `tolerance_mm`, -reach_mm <= t <= reach_mm; nothing if there is no change.
[[nodiscard]] std::optional<double> find_zero_crossing(const Vec3& p, const Vec3& direction,
                                                       const InsidePredicate& is_inside,
                                                       double reach_mm, double tolerance_mm);

}  // namespace lefort::mesh
