#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>

namespace lefort::contact {

Gap measure_gap(const BoneObstacle& obstacle, const Vec3& p_L) {
  LEFORT_ASSERT(obstacle.field_B != nullptr);
  const Mat3 R_LB = obstacle.X_LB.linear();
  const Vec3 p_B = R_LB.transpose() * (p_L - obstacle.X_LB.translation());
  if (obstacle.reconstruction == Reconstruction::kTrilinear) {
    const field::FieldSample sample = obstacle.field_B->sample(p_B);
    return {sample.zone, sample.distance_mm, R_LB * sample.gradient_B, Mat3::Zero()};
  }
  const field::SmoothSample sample = obstacle.field_B->sample_smooth(p_B);
  return {sample.zone, sample.distance_mm, R_LB * sample.gradient_B,
          R_LB * sample.hessian_B * R_LB.transpose()};
}

std::vector<ContactPoint> find_contacts(const BoneObstacle& obstacle,
                                        std::span<const Vec3> points_L, double margin_mm) {
  LEFORT_CHECK(margin_mm >= 0.0);
  return parallel_collect<ContactPoint>(Index(points_L.size()), [&](Index point, auto& contacts) {
    const Gap gap = measure_gap(obstacle, points_L[std::size_t(point)]);
    const bool near = gap.zone == field::Zone::kBand && gap.gap_mm < margin_mm;
    if (near || gap.zone == field::Zone::kInside) contacts.push_back({point, gap});
  });
}

}  // namespace lefort::contact
