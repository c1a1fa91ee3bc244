#include <lefort/core/check.h>
#include <lefort/inverse/fit_preview.h>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::inverse {
namespace {

constexpr double kDifference_mm = 0.5;  ///< Step of the differences.
constexpr int kMaxSteps = 4;
constexpr double kReachedFit_mm = 0.02;  ///< Below what a page shows.
/// Of the squared response: damps motions that hardly move the vertex.
constexpr double kFitDamping = 1e-3;
constexpr double kMinResponse = 0.02;  ///< Motion of the vertex per motion of the segment.

/// The preview at translations s of one segment along axes.
class FittedVertex {
 public:
  FittedVertex(const predict::FacePreview& preview, std::vector<RigidTransform> X_LB,
               std::size_t segment, Index vertex, std::span<const Vec3> axes_L)
      : preview_(preview),
        X_LB_(std::move(X_LB)),
        start_L_(X_LB_[segment].translation()),
        segment_(segment),
        vertex_(vertex),
        axes_L_(axes_L) {}

  /// \returns the displacement of the vertex.
  [[nodiscard]] Result<Vec3> at(const VectorX& s) {
    X_LB_[segment_].translation() = start_L_;
    for (std::size_t a = 0; a < axes_L_.size(); ++a)
      X_LB_[segment_].translation() += s[Index(a)] * axes_L_[a];
    LEFORT_TRY(const std::vector<Vec3> u, preview_.displacement_mm(X_LB_));
    return u[std::size_t(vertex_)];
  }
  [[nodiscard]] const RigidTransform& pose() const { return X_LB_[segment_]; }

 private:
  const predict::FacePreview& preview_;
  std::vector<RigidTransform> X_LB_;
  Vec3 start_L_;
  std::size_t segment_;
  Index vertex_;
  std::span<const Vec3> axes_L_;
};

VectorX along(std::span<const Vec3> axes_L, const Vec3& v) {
  VectorX components{Index(axes_L.size())};
  for (std::size_t a = 0; a < axes_L.size(); ++a) components[Index(a)] = axes_L[a].dot(v);
  return components;
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
  FittedVertex vertex_at(preview, std::move(X_LB), segment, vertex, axes_L);
  VectorX s = VectorX::Zero(count);
  LEFORT_TRY(Vec3 u, vertex_at.at(s));
  Eigen::MatrixXd D(count, count);
  for (Index a = 0; a < count; ++a) {
    LEFORT_TRY(const Vec3 moved, vertex_at.at(s + kDifference_mm * VectorX::Unit(count, a)));
    D.col(a) = along(axes_L, moved - u) / kDifference_mm;
  }
  if (D.norm() < kMinResponse)
    return fail(ErrorCode::kInvalidArgument,
                "the segment does not move the skin at this point: choose a point closer to it");
  Eigen::MatrixXd H = D.transpose() * D;
  H.diagonal().array() += kFitDamping * H.diagonal().maxCoeff();
  for (int n = 0; n < kMaxSteps; ++n) {
    const VectorX r = along(axes_L, u - wanted_mm);
    if (r.norm() <= kReachedFit_mm) break;
    const VectorX next = (s + H.ldlt().solve(-D.transpose() * r)).cwiseMax(lower).cwiseMin(upper);
    if ((next - s).norm() <= 0.1 * kReachedFit_mm) break;
    LEFORT_TRY(const Vec3 reached, vertex_at.at(next));
    if (along(axes_L, reached - wanted_mm).norm() >= r.norm()) break;
    s = next;
    u = reached;
  }
  LEFORT_TRY(u, vertex_at.at(s));
  return PreviewFit{vertex_at.pose(), u, along(axes_L, u - wanted_mm).norm(),
                    (s.array() <= lower.array()).any() || (s.array() >= upper.array()).any()};
}

}  // namespace lefort::inverse
