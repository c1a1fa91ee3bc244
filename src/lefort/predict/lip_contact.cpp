#include <lefort/core/check.h>
#include <lefort/predict/lip_contact.h>

#include <algorithm>
#include <array>
#include <utility>

namespace lefort::predict {

LipContact::LipContact(std::vector<FacingPoint> points, double stiffness_mpa_per_mm,
                       double tone_mpa)
    : points_(std::move(points)), stiffness_mpa_per_mm_(stiffness_mpa_per_mm), tone_mpa_(tone_mpa) {
  LEFORT_CHECK(stiffness_mpa_per_mm > 0.0);
  LEFORT_CHECK(tone_mpa >= 0.0);
}

bool LipContact::replace(const std::vector<FacingPoint>& points) {
  const auto couples_same_nodes = [](const FacingPoint& a, const FacingPoint& b) {
    return a.nodes == b.nodes;
  };
  if (!std::equal(points.begin(), points.end(), points_.begin(), points_.end(), couples_same_nodes))
    return false;
  points_ = points;
  return true;
}

bool LipContact::evaluate(Index item, std::span<const Vec3> x_L, fem::LocalEquations& local) const {
  for (const Vec3& x : x_L)
    if (!x.allFinite()) return false;
  const FacingPoint& point = points_[std::size_t(item)];
  const double e_mm = opening_mm(point, x_L);
  const double tone_mm = tone_mpa_ / stiffness_mpa_per_mm_;  // e_0
  const double k = point.area_mm2 * stiffness_mpa_per_mm_;
  const bool is_open = e_mm >= tone_mm;
  const double force_n = is_open ? point.area_mm2 * tone_mpa_ : k * e_mm;
  local.energy_mj = is_open ? force_n * (e_mm - 0.5 * tone_mm) : 0.5 * force_n * e_mm;
  const std::array<double, 4> N{1.0, -point.weights[0], -point.weights[1], -point.weights[2]};
  for (Index i = 0; i < 4; ++i)
    local.residual_n.segment<3>(3 * i) = N[std::size_t(i)] * force_n * point.normal_L;
  if (is_open) return true;
  local.contacts = e_mm < 0.0 ? 1 : 0;
  local.deepest_mm = std::max(-e_mm, 0.0);
  if (!local.wants_stiffness()) return true;
  const Mat3 K = k * point.normal_L * point.normal_L.transpose();
  for (Index i = 0; i < 4; ++i)
    for (Index j = 0; j < 4; ++j)
      local.stiffness_n_per_mm.block<3, 3>(3 * i, 3 * j) =
          N[std::size_t(i)] * N[std::size_t(j)] * K;
  return true;
}

LipStatistics lip_statistics(const mesh::VolumeMesh& tissue, const LipSlit& lips,
                             std::span<const Vec3> displacement_mm) {
  LipStatistics all;
  double closed_mm2 = 0.0, mm2 = 0.0;
  for (const LipPair& pair : lips.pairs) {
    const Vec3 motion =
        displacement_mm[std::size_t(pair.upper)] - displacement_mm[std::size_t(pair.lower)];
    const double slip_mm = (motion - pair.normal_L.dot(motion) * pair.normal_L).norm();
    all.max_slip_mm = std::max(all.max_slip_mm, slip_mm);
    mm2 += pair.area_mm2;
  }
  std::vector<Vec3> x_L = tissue.nodes_L;
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += displacement_mm[n];
  for (const FacingPoint& point : face_lips(lip_surfaces(tissue, lips), lips.pairs, x_L)) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = x_L[std::size_t(point.nodes[i])];
    const double e_mm = opening_mm(point, x);
    all.max_overlap_mm = std::max(all.max_overlap_mm, -e_mm);
    all.max_opening_mm = std::max(all.max_opening_mm, e_mm);
    if (e_mm <= kLipsClosed_mm) closed_mm2 += point.area_mm2;
  }
  if (mm2 > 0.0) all.closed_fraction = closed_mm2 / mm2;
  return all;
}

}  // namespace lefort::predict
