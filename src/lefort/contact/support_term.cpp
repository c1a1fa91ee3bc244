#include <lefort/contact/measure_gap.h>
#include <lefort/contact/support_term.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::contact {

SupportTerm::SupportTerm(std::span<const Vec3> nodes_L, std::vector<NodalSupport> supports,
                         RigidObstacle obstacle)
    : supports_(std::move(supports)), obstacle_(std::move(obstacle)) {
  const RigidTransform X_BL = obstacle_.X_LB.inverse();
  for (NodalSupport& support : supports_) {
    LEFORT_CHECK(support.area_mm2 > 0.0);
    const Vec3& x_L = nodes_L[std::size_t(support.node)];
    rest_B_.push_back(X_BL * x_L);
    rest_L_.push_back(x_L);
    rest_gap_mm_.push_back(0.0);
    if (!support.follows_surface) continue;
    LEFORT_CHECK(obstacle_.distance_query_B != nullptr);
    rest_gap_mm_.back() = measure_gap(obstacle_, x_L, Derivatives::kFirst).gap_mm;
  }
}

SupportTerm::Opening SupportTerm::opening_of(std::size_t support, const Vec3& x_L) const {
  const NodalSupport& of = supports_[support];
  Vec3 target_L = obstacle_.X_LB * rest_B_[support], normal_L = of.normal_B;
  if (of.motion_fraction == 1.0)
    normal_L = obstacle_.X_LB.linear() * of.normal_B;
  else
    target_L = rest_L_[support] + of.motion_fraction * (target_L - rest_L_[support]);
  const Vec3 slip_L = x_L - target_L;
  Opening opening{.tangential_L = slip_L,
                  .normal_L = normal_L,
                  .gradient_L = Vec3::Zero(),
                  .hessian_L = Mat3::Zero()};
  opening.mm = opening.normal_L.dot(slip_L);
  opening.tangential_L -= opening.mm * opening.normal_L;
  opening.gradient_L = opening.normal_L;
  if (!of.follows_surface) return opening;
  const Gap gap = measure_gap(obstacle_, x_L, Derivatives::kSecond);
  opening.mm = gap.gap_mm - rest_gap_mm_[support];
  opening.gradient_L = gap.gradient_L;
  opening.hessian_L = gap.hessian_L;
  return opening;
}

bool SupportTerm::evaluate(Index item, std::span<const Vec3> x_L,
                           fem::LocalEquations& local) const {
  const NodalSupport& support = supports_[std::size_t(item)];
  const Opening opening = opening_of(std::size_t(item), x_L[0]);
  if (!x_L[0].allFinite() || !std::isfinite(opening.mm)) return false;
  const double A = support.area_mm2, k_t = support.tangential_mpa_per_mm;
  const double k_n = opening.mm > 0.0 ? support.tension_mpa_per_mm : support.normal_mpa_per_mm;
  local.energy_mj =
      0.5 * A * (k_n * opening.mm * opening.mm + k_t * opening.tangential_L.squaredNorm());
  local.residual_n = A * (k_n * opening.mm * opening.gradient_L + k_t * opening.tangential_L);
  if (!local.wants_stiffness()) return true;
  const Vec3 &n = opening.normal_L, &m = opening.gradient_L;
  Mat3 K = k_n * m * m.transpose() + k_t * (Mat3::Identity() - n * n.transpose());
  if (local.tangent == fem::Tangent::kExact) K += k_n * opening.mm * opening.hessian_L;
  local.stiffness_n_per_mm = A * K;
  return true;
}

bool SupportTerm::is_conservative(const fem::DofMap& /*dofs*/) const {
  return std::ranges::none_of(supports_, &NodalSupport::follows_surface) ||
         obstacle_.distance_query_B->has_exact_derivatives();
}

SupportStatistics SupportTerm::summarize(std::span<const Vec3> x_L) const {
  SupportStatistics all;
  for (std::size_t s = 0; s < supports_.size(); ++s) {
    if (supports_[s].motion_fraction < 1.0) continue;
    ++all.nodes;
    const Opening opening = opening_of(s, x_L[std::size_t(supports_[s].node)]);
    all.max_slip_mm = std::max(all.max_slip_mm, opening.tangential_L.norm());
    all.max_opening_mm = std::max(all.max_opening_mm, opening.mm);
    all.max_compression_mm = std::max(all.max_compression_mm, -opening.mm);
  }
  return all;
}

}  // namespace lefort::contact
