/// \file
/// The translation of a segment for which the preview of the face brings one point of the skin to a
/// wanted position: interactive inverse planning.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/predict/face_preview.h>

#include <cstddef>
#include <span>
#include <vector>

namespace lefort::inverse {

struct PreviewFit {
  RigidTransform X_LB;       ///< New pose of the segment.
  Vec3 displacement_mm;      ///< Of the vertex by the preview at this pose.
  double residual_mm = 0.0;  ///< Distance from the wanted displacement along the axes.
  bool is_at_limit = false;  ///< The translation is limited by kMaxFit_mm.
};

/// Max translation of the segment from its present pose along each axis.
inline constexpr double kMaxFit_mm = 20.0;

/// Minimizes the distance along `axes_L` between the displacement of a vertex and the wanted one by
/// translations of one segment along the same axes: damped Gauss-Newton steps with the derivatives
/// of the equilibrium, which are halved if they fail. Costs up to eight equilibria.
///
/// \param preview    of the face.
/// \param X_LB       present pose of each segment.
/// \param segment    that moves.
/// \param vertex     of the skin.
/// \param wanted_mm  its wanted displacement from the position before surgery.
/// \param axes_L     one to three orthonormal directions.
/// \returns the fit; kInvalidArgument if segment or vertex does not exist, a number is not finite,
///   or the segment does not move the vertex; or the error of the preview.
[[nodiscard]] Result<PreviewFit> fit_preview(const predict::FacePreview& preview,
                                             std::vector<RigidTransform> X_LB, std::size_t segment,
                                             Index vertex, const Vec3& wanted_mm,
                                             std::span<const Vec3> axes_L);

}  // namespace lefort::inverse
