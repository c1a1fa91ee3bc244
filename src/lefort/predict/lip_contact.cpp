#include <lefort/core/check.h>
#include <lefort/predict/lip_contact.h>

#include <algorithm>
#include <utility>

namespace lefort::predict {

LipContact::LipContact(std::vector<LipPair> pairs, double stiffness_mpa_per_mm, double tone_mpa)
    : pairs_(std::move(pairs)), stiffness_mpa_per_mm_(stiffness_mpa_per_mm), tone_mpa_(tone_mpa) {
  LEFORT_CHECK(stiffness_mpa_per_mm > 0.0);
  LEFORT_CHECK(tone_mpa >= 0.0);
  for (const LipPair& pair : pairs_) nodes_.push_back({pair.upper, pair.lower});
}

bool LipContact::evaluate(Index item, std::span<const Vec3> x_L, fem::LocalEquations& local) const {
  if (!x_L[0].allFinite() || !x_L[1].allFinite()) return false;
  const LipPair& pair = pairs_[std::size_t(item)];
  const Vec3& n = pair.normal_L;
  const double opening_mm = n.dot(x_L[0] - x_L[1]);
  const double tone_mm = tone_mpa_ / stiffness_mpa_per_mm_;  // e_0
  if (opening_mm >= tone_mm) {
    local.energy_mj = pair.area_mm2 * tone_mpa_ * (opening_mm - 0.5 * tone_mm);
    local.residual_n.head<3>() = pair.area_mm2 * tone_mpa_ * n;
    local.residual_n.tail<3>() = -local.residual_n.head<3>();
    return true;
  }
  const double k = pair.area_mm2 * stiffness_mpa_per_mm_;
  local.energy_mj = 0.5 * k * opening_mm * opening_mm;
  local.residual_n.head<3>() = k * opening_mm * n;
  local.residual_n.tail<3>() = -k * opening_mm * n;
  local.contacts = opening_mm < 0.0 ? 1 : 0;
  local.deepest_mm = std::max(-opening_mm, 0.0);
  if (!local.wants_stiffness()) return true;
  const Mat3 K = k * n * n.transpose();
  local.stiffness_n_per_mm.topLeftCorner<3, 3>() = K;
  local.stiffness_n_per_mm.bottomRightCorner<3, 3>() = K;
  local.stiffness_n_per_mm.topRightCorner<3, 3>() = -K;
  local.stiffness_n_per_mm.bottomLeftCorner<3, 3>() = -K;
  return true;
}

LipStatistics lip_statistics(const LipSlit& lips, std::span<const Vec3> displacement_mm) {
  LipStatistics all;
  double closed_mm2 = 0.0, mm2 = 0.0;
  for (const LipPair& pair : lips.pairs) {
    const Vec3 motion =
        displacement_mm[std::size_t(pair.upper)] - displacement_mm[std::size_t(pair.lower)];
    const double opening_mm = pair.normal_L.dot(motion);
    all.max_overlap_mm = std::max(all.max_overlap_mm, -opening_mm);
    all.max_opening_mm = std::max(all.max_opening_mm, opening_mm);
    all.max_slip_mm = std::max(all.max_slip_mm, (motion - opening_mm * pair.normal_L).norm());
    mm2 += pair.area_mm2;
    if (opening_mm <= kLipsClosed_mm) closed_mm2 += pair.area_mm2;
  }
  if (mm2 > 0.0) all.closed_fraction = closed_mm2 / mm2;
  return all;
}

}  // namespace lefort::predict
