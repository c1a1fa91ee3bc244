/// \file
/// Which movements a target determines: singular values and vectors of the derivatives of its
/// residuals (\cite hansen1998).
#pragma once

#include <lefort/core/types.h>

#include <vector>

namespace lefort::inverse {

/// One direction of the variables.
struct MotionDirection {
  VectorX direction;          ///< Unit length in mm and degrees.
  double face_mm = 0.0;       ///< Weighted root mean square change of the targets by one unit.
  bool is_determined = true;  ///< face_mm >= kDetermined_mm.
};

/// A movement of 1 mm or 1 degree that changes the targets by less than this is not determined: the
/// error of a face surface, 0.1 mm or more, would change the movement by 5 mm.
inline constexpr double kDetermined_mm = 0.02;

/// \param target_hessian  D^T D of the weighted residuals of the targets.
/// \returns the right singular vectors of D, best determined first.
[[nodiscard]] std::vector<MotionDirection> determined_motions(
    const Eigen::MatrixXd& target_hessian);

}  // namespace lefort::inverse
