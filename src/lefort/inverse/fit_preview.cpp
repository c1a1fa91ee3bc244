#include <lefort/core/check.h>
#include <lefort/inverse/fit_preview.h>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::inverse {
namespace {

constexpr int kMaxSteps = 6;
constexpr double kReachedFit_mm = 0.02;  ///< Below what a page shows.
/// Of the squared response: damps motions that hardly move the vertex.
constexpr double kFitDamping = 1e-3;
constexpr double kMinResponse = 0.02;  ///< Motion of the vertex per motion of the segment.

VectorX along(std::span<const Vec3> axes_L, const Vec3& v) {
  VectorX components{Index(axes_L.size())};
  for (std::size_t a = 0; a < axes_L.size(); ++a) components[Index(a)] = axes_L[a].dot(v);
  return components;
}

/// The derivative of the components along the axes by translations along the same axes.
Eigen::MatrixXd response_along(std::span<const Vec3> axes_L, const Mat3& by_translation) {
  Eigen::MatrixXd D(Index(axes_L.size()), Index(axes_L.size()));
  for (std::size_t a = 0; a < axes_L.size(); ++a)
    D.col(Index(a)) = along(axes_L, by_translation * axes_L[a]);
  return D;
}

}  // namespace

Result<PreviewFit> fit_preview(const predict::FacePreview& preview,
                               std::vector<RigidTransform> X_LB, std::size_t segment, Index vertex,
                               const Vec3& wanted_mm, std::span<const Vec3> axes_L) {
  LEFORT_CHECK(!axes_L.empty() && axes_L.size() <= 3);
  if (segment >= X_LB.size() || X_LB.size() != preview.segment_count())
    return fail(ErrorCode::kInvalidArgument, "the preview has no such segment");
  if (vertex < 0 || vertex >= preview.vertex_count())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the skin has no vertex {}, only {}", vertex, preview.vertex_count()));
  if (!wanted_mm.allFinite())
    return fail(ErrorCode::kInvalidArgument, "the wanted displacement is not finite");
  const auto count = Index(axes_L.size());
  const VectorX lower = VectorX::Constant(count, -kMaxFit_mm);
  const VectorX upper = VectorX::Constant(count, kMaxFit_mm);
  const Vec3 start_L = X_LB[segment].translation();
  const auto motion_at = [&](const VectorX& s) {
    X_LB[segment].translation() = start_L;
    for (Index a = 0; a < count; ++a) X_LB[segment].translation() += s[a] * axes_L[std::size_t(a)];
    return preview.vertex_motion(X_LB, segment, vertex);
  };
  VectorX s = VectorX::Zero(count);
  LEFORT_TRY(predict::VertexMotion motion, motion_at(s));
  if (response_along(axes_L, motion.by_translation).norm() < kMinResponse)
    return fail(ErrorCode::kInvalidArgument,
                "the segment does not move the skin at this point: choose a point closer to it");
  double shortened = 1.0;  // Part of the step that is taken.
  for (int n = 0; n < kMaxSteps; ++n) {
    const VectorX r = along(axes_L, motion.displacement_mm - wanted_mm);
    if (r.norm() <= kReachedFit_mm) break;
    const Eigen::MatrixXd D = response_along(axes_L, motion.by_translation);
    Eigen::MatrixXd H = D.transpose() * D;
    H.diagonal().array() += kFitDamping * H.diagonal().maxCoeff();
    const VectorX step = shortened * H.ldlt().solve(-D.transpose() * r);
    const VectorX next = (s + step).cwiseMax(lower).cwiseMin(upper);
    if (!((next - s).norm() > 0.1 * kReachedFit_mm)) break;
    const auto reached = motion_at(next);
    if (reached && along(axes_L, reached->displacement_mm - wanted_mm).norm() < r.norm()) {
      s = next;
      motion = *reached;
      shortened = 1.0;
    } else {
      shortened *= 0.5;
    }
  }
  LEFORT_TRY(motion, motion_at(s));  // The last pose may be one that was not taken.
  X_LB[segment].translation() = start_L;
  for (Index a = 0; a < count; ++a) X_LB[segment].translation() += s[a] * axes_L[std::size_t(a)];
  return PreviewFit{X_LB[segment], motion.displacement_mm,
                    along(axes_L, motion.displacement_mm - wanted_mm).norm(),
                    (s.array() <= lower.array()).any() || (s.array() >= upper.array()).any()};
}

}  // namespace lefort::inverse
