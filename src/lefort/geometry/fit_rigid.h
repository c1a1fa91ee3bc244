/// \file
/// The rigid motion that best maps points to their targets.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <span>

namespace lefort::geometry {

struct RigidFit {
  RigidTransform X_to_from = RigidTransform::Identity();  ///< Maps `from` to `to`.
  double rms_mm = 0.0;           ///< Root mean square of the residual distances.
  double max_residual_mm = 0.0;  ///< Largest residual distance.
  Index max_residual_index = 0;  ///< Number of the point with this distance.
};

/// Least-squares fit over rotations and translations, without reflections \cite umeyama1991.
///
/// \param from, to  equally many points, three or more, in the same order [mm].
/// \returns the fit, or kInvalidArgument if there are fewer than three points, the sizes of `from`
///   and `to` differ, a point is not finite, or `from` or `to` are collinear within 1 % of their
///   spread, so that the rotation is not determined.
[[nodiscard]] Result<RigidFit> fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to);

}  // namespace lefort::geometry
