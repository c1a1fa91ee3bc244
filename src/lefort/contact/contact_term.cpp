#include <lefort/contact/contact_term.h>
#include <lefort/contact/penalty.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/mesh/boundary_faces.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace lefort::contact {
namespace {

/// A point of a triangle: its shape functions there, and its share of the area.
struct QuadraturePoint {
  Vec3 N;
  double weight;
};

/// \cite dunavant1985, degree 4.
std::array<QuadraturePoint, 6> dunavant_degree_4() {
  constexpr double kA = 0.445948490915965, kWeightA = 0.223381589678011;
  constexpr double kB = 0.091576213509771, kWeightB = 0.109951743655322;
  std::array<QuadraturePoint, 6> points;
  for (int corner = 0; corner < 3; ++corner) {
    Vec3 N = Vec3::Constant(kA);
    N[corner] = 1.0 - 2.0 * kA;
    points[std::size_t(corner)] = {N, kWeightA};
    N = Vec3::Constant(kB);
    N[corner] = 1.0 - 2.0 * kB;
    points[std::size_t(3 + corner)] = {N, kWeightB};
  }
  return points;
}

const std::array<QuadraturePoint, 6> kRule = dunavant_degree_4();

Vec3 interpolate(const Vec3& N, std::span<const Vec3> x_L) {
  return N[0] * x_L[0] + N[1] * x_L[1] + N[2] * x_L[2];
}

std::array<Vec3, 3> corners(const mesh::Face3& face, std::span<const Vec3> x_L) {
  return {x_L[std::size_t(face[0])], x_L[std::size_t(face[1])], x_L[std::size_t(face[2])]};
}

}  // namespace

ContactTerm::ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face3> faces,
                         BoneObstacle obstacle, const Options& options)
    : faces_(std::move(faces)),
      obstacle_(std::move(obstacle)),
      stiffness_mpa_per_mm_(options.stiffness_mpa_per_mm) {
  LEFORT_CHECK(stiffness_mpa_per_mm_ > 0.0 && options.capture_mm >= 0.0);
  LEFORT_CHECK(options.capture_mm < reach_mm(*obstacle_.field_B, obstacle_.reconstruction));
  area_mm2_.reserve(faces_.size());
  rest_gap_mm_.reserve(faces_.size());
  for (const mesh::Face3& face : faces_) {
    const std::array<Vec3, 3> x = corners(face, nodes_L);
    area_mm2_.push_back(0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm());
    std::array<double, kPoints>& rest = rest_gap_mm_.emplace_back();
    for (std::size_t q = 0; q < kRule.size(); ++q)
      rest[q] = rest_gap_mm(interpolate(kRule[q].N, x), options.capture_mm);
  }
  nodes_ = mesh::nodes_of_faces(faces_);
  for (const std::int32_t node : nodes_)
    node_rest_gap_mm_.push_back(rest_gap_mm(nodes_L[std::size_t(node)], options.capture_mm));
  last_sight_.resize(faces_.size());
  last_clearance_.resize(faces_.size());
  remember(nodes_L);
}

double ContactTerm::rest_gap_mm(const Vec3& rest_L, double capture_mm) const {
  const Gap gap = measure_gap(obstacle_, rest_L, Derivatives::kFirst);
  const bool touches = gap.zone == field::Zone::kBand && std::abs(gap.gap_mm) <= capture_mm;
  return touches ? gap.gap_mm : std::min(gap.gap_mm, 0.0);
}

void ContactTerm::remember(std::span<const Vec3> x_L) {
  tunnelled_area_mm2_ += newly_tunnelled_area_mm2(x_L);
  const Mat3 R_BL = obstacle_.X_LB.linear().transpose();
  parallel_for(Index(faces_.size()), [&](Index face) {
    const std::array<Vec3, 3> x = corners(faces_[std::size_t(face)], x_L);
    Clearance& clearance = last_clearance_[std::size_t(face)];
    clearance.clearance_mm = reach_mm(*obstacle_.field_B, obstacle_.reconstruction);
    for (std::size_t corner = 0; corner < x.size(); ++corner)
      clearance.corners_B[corner] = R_BL * (x[corner] - obstacle_.X_LB.translation());
    for (std::size_t q = 0; q < kRule.size(); ++q) {
      const Gap gap = measure_gap(obstacle_, interpolate(kRule[q].N, x), Derivatives::kFirst);
      const bool is_seen = gap.zone == field::Zone::kBand || gap.zone == field::Zone::kOutside;
      const double touching_at_mm = std::max(rest_gap_mm_[std::size_t(face)][q], 0.0);
      clearance.clearance_mm =
          std::min(clearance.clearance_mm, is_seen ? gap.gap_mm - touching_at_mm : 0.0);
      last_sight_[std::size_t(face)][q] = {R_BL * gap.gradient_L,
                                           gap.zone != field::Zone::kUnknown};
    }
  });
}

std::optional<std::string> ContactTerm::why_refused(std::span<const Vec3> x_L) const {
  constexpr double kMostTunnelled = 0.02;  // Of the area in contact, in one increment.
  const double tunnelled_mm2 = newly_tunnelled_area_mm2(x_L);
  const double touching_mm2 = summarise(x_L).area_mm2;
  if (tunnelled_mm2 <= kMostTunnelled * touching_mm2) return std::nullopt;
  return fmt::format(
      "{:.1f} of {:.1f} mm^2 of tissue in contact have tunnelled through "
      "the bone in one increment",
      tunnelled_mm2, touching_mm2);
}

double ContactTerm::rest_penetration_mm() const {
  double deepest_mm = 0.0;
  for (const std::array<double, kPoints>& rest : rest_gap_mm_)
    for (const double gap_mm : rest) deepest_mm = std::max(deepest_mm, -gap_mm);
  return deepest_mm;
}

bool ContactTerm::is_out_of_reach(std::size_t face, std::span<const Vec3> corners_L) const {
  constexpr double kSlack_mm = 0.1;  // Errors of the field, many times over.
  constexpr double kSlope = 1.1;     // Likewise for the length of its gradient.
  const Clearance& last = last_clearance_[face];
  if (last.clearance_mm <= kSlack_mm) return false;
  const double allowed_mm = (last.clearance_mm - kSlack_mm) / kSlope;
  const Mat3 R_BL = obstacle_.X_LB.linear().transpose();
  for (std::size_t corner = 0; corner < last.corners_B.size(); ++corner) {
    const Vec3 x_B = R_BL * (corners_L[corner] - obstacle_.X_LB.translation());
    if (!((x_B - last.corners_B[corner]).squaredNorm() < allowed_mm * allowed_mm)) return false;
  }
  return true;
}

bool ContactTerm::has_tunnelled(const Sight& last, const Gap& gap) const {
  // Outside the bone, normals turn freely: across a groove one wall takes over from the other.
  constexpr double kFarSide = -0.5;  // Cosine; an edge of over 60 degrees has no far side.
  return gap.zone == field::Zone::kBand && gap.gap_mm < 0.0 &&
         (obstacle_.X_LB.linear() * last.normal_B).dot(gap.gradient_L) < kFarSide;
}

double ContactTerm::newly_tunnelled_area_mm2(std::span<const Vec3> x_L) const {
  return deterministic_sum(Index(faces_.size()), 0.0, [&](Index face) {
    const std::array<Vec3, 3> x = corners(faces_[std::size_t(face)], x_L);
    double share = 0.0;
    for (std::size_t q = 0; q < kRule.size(); ++q) {
      const Gap gap = measure_gap(obstacle_, interpolate(kRule[q].N, x), Derivatives::kFirst);
      if (has_tunnelled(last_sight_[std::size_t(face)][q], gap)) share += kRule[q].weight;
    }
    return share * area_mm2_[std::size_t(face)];
  });
}

bool ContactTerm::evaluate(Index item, std::span<const Vec3> x_L,
                           fem::LocalEquations& local) const {
  if (is_out_of_reach(std::size_t(item), x_L)) return true;
  const double area_mm2 = area_mm2_[std::size_t(item)];
  for (std::size_t q = 0; q < kRule.size(); ++q) {
    const Vec3& N = kRule[q].N;
    const Gap gap =
        measure_gap(obstacle_, interpolate(N, x_L),
                    local.wants_stiffness() ? Derivatives::kSecond : Derivatives::kFirst);
    const double depth_mm = rest_gap_mm_[std::size_t(item)][q] - gap.gap_mm;
    if (gap.zone == field::Zone::kInside) return false;
    if (gap.zone == field::Zone::kUnknown && last_sight_[std::size_t(item)][q].knows_side)
      return false;
    if (gap.zone != field::Zone::kBand || !(depth_mm > 0.0)) continue;

    ++local.contacts;
    const double weight_mm2 = kRule[q].weight * area_mm2;
    const PenaltyResponse response =
        penalty_response(depth_mm, gap.gradient_L, gap.hessian_L, stiffness_mpa_per_mm_);
    local.energy_mj += weight_mm2 * response.energy_mj_per_mm2;
    for (int a = 0; a < 3; ++a)
      local.residual_n.segment<3>(3 * a) += weight_mm2 * N[a] * response.gradient_mpa;
    if (!local.wants_stiffness()) continue;
    const Mat3 hessian_mpa_per_mm =
        local.tangent == fem::Tangent::kExact
            ? response.hessian_mpa_per_mm
            : convex_hessian(depth_mm, gap.gradient_L, gap.hessian_L, stiffness_mpa_per_mm_);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        local.stiffness_n_per_mm.block<3, 3>(3 * a, 3 * b) +=
            weight_mm2 * N[a] * N[b] * hessian_mpa_per_mm;
  }
  return true;
}

ContactSummary ContactTerm::summarise(std::span<const Vec3> x_L) const {
  ContactSummary summary;
  std::set<std::int32_t> nodes;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const std::array<Vec3, 3> x = corners(faces_[face], x_L);
    for (std::size_t q = 0; q < kRule.size(); ++q) {
      const Gap gap = measure_gap(obstacle_, interpolate(kRule[q].N, x), Derivatives::kFirst);
      const double penetration_mm = std::max(-gap.gap_mm, 0.0);
      const double depth_mm = rest_gap_mm_[face][q] - gap.gap_mm;
      if (gap.zone != field::Zone::kBand || !(depth_mm > 0.0)) continue;
      const double weight_mm2 = kRule[q].weight * area_mm2_[face];
      const Vec3 force_n = -weight_mm2 * penalty_response(depth_mm, gap.gradient_L, gap.hessian_L,
                                                          stiffness_mpa_per_mm_)
                                             .gradient_mpa;
      ++summary.points;
      nodes.insert(faces_[face].begin(), faces_[face].end());
      summary.area_mm2 += weight_mm2;
      summary.max_penetration_mm = std::max(summary.max_penetration_mm, penetration_mm);
      summary.mean_penetration_mm += weight_mm2 * penetration_mm;
      summary.max_depth_from_rest_mm = std::max(summary.max_depth_from_rest_mm, depth_mm);
      summary.mean_depth_from_rest_mm += weight_mm2 * depth_mm;
      summary.force_L_n += force_n;
      summary.normal_force_n += force_n.norm();
    }
  }
  summary.nodes = Index(nodes.size());
  summary.tunnelled_area_mm2 = tunnelled_area_mm2_;
  if (summary.area_mm2 > 0.0) {
    summary.mean_penetration_mm /= summary.area_mm2;
    summary.mean_depth_from_rest_mm /= summary.area_mm2;
  }
  return summary;
}

std::vector<NodalContact> ContactTerm::at_nodes(std::span<const Vec3> x_L) const {
  std::vector<NodalContact> touched(nodes_.size());
  parallel_for(Index(nodes_.size()), [&](Index n) {
    const auto i = std::size_t(n);
    const Gap gap = measure_gap(obstacle_, x_L[std::size_t(nodes_[i])], Derivatives::kFirst);
    touched[i].node = nodes_[i];
    touched[i].gap_mm =
        gap.zone == field::Zone::kUnknown ? std::numeric_limits<double>::quiet_NaN() : gap.gap_mm;
    if (gap.zone == field::Zone::kBand)
      touched[i].pressure_mpa = penalty_response(node_rest_gap_mm_[i] - gap.gap_mm, gap.gradient_L,
                                                 gap.hessian_L, stiffness_mpa_per_mm_)
                                    .gradient_mpa.norm();
  });
  return touched;
}

}  // namespace lefort::contact
