/// \file
/// The rigid motion that brings points nearest to their targets.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <span>

namespace lefort::geometry {

struct RigidFit {
  RigidTransform X_to_from = RigidTransform::Identity();
  double rms_mm = 0.0;           ///< Of the distances that remain.
  double max_residual_mm = 0.0;  ///< The largest of them.
  Index max_residual_index = 0;  ///< Which point it is.
};

/// Least squares over all rotations and translations, never a mirror image \cite umeyama1991.
///
/// \param from, to  as many points each, three or more, in the same order.
/// \returns the fit, or kInvalidArgument if there are fewer points, their numbers differ, one is
///   not finite, or the points of a side lie on one line within 1 % of their spread, so that a turn
///   about it is left open.
[[nodiscard]] Result<RigidFit> fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to);

}  // namespace lefort::geometry
