#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>

#include <cmath>

namespace lefort::contact {
namespace {

/// Second derivatives of the trilinear interpolant [1/mm]. Along one axis its gradient is linear
/// within a cell, so that a difference across the finest cell around `p_B` is exact; the pure
/// derivatives are zero.
Mat3 trilinear_hessian(const field::DistanceField& field, const Vec3& p_B) {
  constexpr double kInset = 0.01;  // Of a cell: stays clear of its neighbours.
  const field::FieldFrame& frame = field.frame();
  Mat3 hessian_B = Mat3::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    const double cell = std::floor((p_B[axis] - frame.origin_B[axis]) / frame.cell_mm);
    Vec3 low_B = p_B, high_B = p_B;
    low_B[axis] = frame.origin_B[axis] + (cell + kInset) * frame.cell_mm;
    high_B[axis] = frame.origin_B[axis] + (cell + 1.0 - kInset) * frame.cell_mm;
    const field::FieldSample low = field.sample(low_B), high = field.sample(high_B);
    if (low.zone != field::Zone::kBand || high.zone != field::Zone::kBand) return Mat3::Zero();
    const Vec3 change = (high.gradient_B - low.gradient_B) / (high_B[axis] - low_B[axis]);
    for (int other = axis + 1; other < 3; ++other)
      hessian_B(axis, other) = hessian_B(other, axis) = change[other];
  }
  return hessian_B;
}

}  // namespace

Gap measure_gap(const BoneObstacle& obstacle, const Vec3& p_L, Derivatives derivatives) {
  LEFORT_ASSERT(obstacle.field_B != nullptr);
  const Mat3 R_LB = obstacle.X_LB.linear();
  const Vec3 p_B = R_LB.transpose() * (p_L - obstacle.X_LB.translation());
  const auto in_L = [&](const Mat3& hessian_B) -> Mat3 {
    return R_LB * hessian_B * R_LB.transpose();
  };
  const bool second = derivatives == Derivatives::kSecond;
  if (obstacle.reconstruction == Reconstruction::kTrilinear) {
    const field::FieldSample sample = obstacle.field_B->sample(p_B);
    Gap gap{sample.zone, sample.distance_mm, R_LB * sample.gradient_B, Mat3::Zero()};
    if (second && sample.zone == field::Zone::kBand)
      gap.hessian_L = in_L(trilinear_hessian(*obstacle.field_B, p_B));
    return gap;
  }
  const field::SmoothSample sample = obstacle.field_B->sample_smooth(p_B);
  return {sample.zone, sample.distance_mm, R_LB * sample.gradient_B,
          second ? in_L(sample.hessian_B) : Mat3::Zero()};
}

}  // namespace lefort::contact
