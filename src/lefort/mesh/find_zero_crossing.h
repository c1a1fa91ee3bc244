/// \file
/// The zero crossing of a level-set function on a line.
#pragma once

#include <lefort/core/types.h>

#include <functional>
#include <optional>

namespace lefort::mesh {

/// True for points of the tissue. Called by one thread; returns the same value for the same point.
using InsidePredicate = std::function<bool(const Vec3&)>;

/// Finds a t close to 0 at which is_inside changes at p + t * direction.
///
/// Searches outwards if p is inside, inwards if it is outside. The first step is `tolerance_mm`;
/// steps double until the value changes, then bisection follows. A layer that is thinner than its
/// distance from p may be missed.
///
/// \param p                start of the search [mm].
/// \param direction        outward, unit length.
/// \param is_inside        the tissue.
/// \param max_distance_mm  largest |t|.
/// \param tolerance_mm     accuracy of t, > 0.
/// \returns t [mm], > 0 if p is inside, else < 0; nothing if is_inside does not change within
///   max_distance_mm in this direction.
[[nodiscard]] std::optional<double> find_zero_crossing(const Vec3& p, const Vec3& direction,
                                                       const InsidePredicate& is_inside,
                                                       double max_distance_mm, double tolerance_mm);

}  // namespace lefort::mesh
