#include <lefort/contact/contact_term.h>
#include <lefort/contact/rest_gap.h>
#include <lefort/contact/step_bound.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/trace.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace lefort::contact {
namespace {

/// Largest fraction of the tissue in the bone that may pass the middle of thin bone in one
/// increment. A bone that jumps through a face takes whole faces with it; over thin edges of a real
/// skull far less passes (study "contact on a real head").
constexpr double kMaxPassedFraction = 0.02;

/// Distances at the points of a rule, in the frame of the bone.
struct RuleDistances {
  Mat3 R_LB;
  std::array<Vec3, kMaxPoints> p_L;
  std::array<SignedDistanceSample, kMaxPoints> samples;

  RuleDistances(const RigidObstacle& obstacle, const FaceQuadrature& rule,
                std::span<const Vec3> x_L, Derivatives derivatives)
      : R_LB(obstacle.X_LB.linear()) {
    const std::size_t count = rule.points.size();
    std::array<Vec3, kMaxPoints> p_B;
    for (std::size_t q = 0; q < count; ++q) {
      p_L[q] = interpolate(rule.points[q], x_L);
      p_B[q] = R_LB.transpose() * (p_L[q] - obstacle.X_LB.translation());
    }
    obstacle.distance_query_B->measure(std::span(p_B).first(count), derivatives,
                                       std::span(samples).first(count));
  }

  /// Only the few points in contact need gradient and Hessian in L.
  [[nodiscard]] Vec3 gradient_L(std::size_t q) const { return R_LB * samples[q].gradient_B; }
  [[nodiscard]] Mat3 hessian_L(std::size_t q) const {
    return R_LB * samples[q].hessian_B * R_LB.transpose();
  }
};

/// \param gap_mm  to a bone; whether another bone is closer.
bool is_closer_to_any(std::span<const RigidObstacle> obstacles, const Vec3& p_L, double gap_mm) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const RigidObstacle& other) {
    const auto& query_B = other.bone_B ? other.bone_B : other.distance_query_B;
    return measure_gap({query_B, other.X_LB, nullptr}, p_L, Derivatives::kFirst).gap_mm < gap_mm;
  });
}

/// Adds residual and stiffness of one point to those of its patch.
void add_point(double area_mm2, std::span<const double> N, const PenaltyResponse& response,
               const Mat3& hessian_mpa_per_mm, fem::LocalEquations& local) {
  const auto nodes = Index(N.size());
  for (Index a = 0; a < nodes; ++a)
    local.residual_n.segment<3>(3 * a) += area_mm2 * N[std::size_t(a)] * response.gradient_mpa;
  if (!local.wants_stiffness()) return;
  for (Index a = 0; a < nodes; ++a)
    for (Index b = 0; b < nodes; ++b)
      local.stiffness_n_per_mm.block<3, 3>(3 * a, 3 * b) +=
          area_mm2 * N[std::size_t(a)] * N[std::size_t(b)] * hessian_mpa_per_mm;
}

}  // namespace

ContactTerm::ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                         RigidObstacle obstacle, const Options& options,
                         std::span<const RigidObstacle> other_obstacles)
    : options_(options),
      obstacle_(std::move(obstacle)),
      faces_(std::move(faces)),
      surface_(nodes_L, faces_),
      rest_gaps_mm_(surface_.point_count(), 0.0),
      has_rest_gap_(surface_.point_count(), 0),
      clearance_(surface_.patches().size()) {
  const auto& [penalty_mpa_per_mm, hardening_mpa_per_mm2, linear_beyond_mm] = options_.law;
  LEFORT_CHECK(obstacle_.distance_query_B != nullptr);
  LEFORT_CHECK(std::isfinite(penalty_mpa_per_mm) && penalty_mpa_per_mm >= 0.0);
  LEFORT_CHECK(std::isfinite(hardening_mpa_per_mm2) && hardening_mpa_per_mm2 >= 0.0);
  LEFORT_CHECK(hardening_mpa_per_mm2 == 0.0 || linear_beyond_mm > 0.0);
  LEFORT_CHECK(penalty_mpa_per_mm + hardening_mpa_per_mm2 > 0.0);
  LEFORT_CHECK(options_.contact_snap_mm >= 0.0);
  LEFORT_CHECK(options_.contact_snap_mm < obstacle_.distance_query_B->max_distance_mm());
  find_rest_gaps(nodes_L, other_obstacles);
  find_dense_rest_gaps(nodes_L, other_obstacles);
  note_clearances(nodes_L);
}

void ContactTerm::find_rest_gaps(std::span<const Vec3> nodes_L,
                                 std::span<const RigidObstacle> other_obstacles) {
  std::vector<double> penetrations_mm(faces_.size(), 0.0);
  parallel_for(Index(faces_.size()), [&](Index patch) {
    for_each_point(std::size_t(patch), nodes_L, [&](const PointGap& at) {
      rest_gaps_mm_[at.number] = rest_gaps(at.p_L, at.gap, other_obstacles).obstacle_mm;
      has_rest_gap_[at.number] =
          at.gap.zone == field::Zone::kBand || at.gap.zone == field::Zone::kOutside;
      double& deepest_mm = penetrations_mm[std::size_t(patch)];
      deepest_mm = std::max(deepest_mm, -gap_to_bone(obstacle_, at.p_L, at.gap).gap_mm);
    });
  });
  for (const double one_mm : penetrations_mm)
    rest_penetration_mm_ = std::max(rest_penetration_mm_, one_mm);
}

ContactTerm::RestGaps ContactTerm::rest_gaps(const Vec3& p_L, const Gap& gap,
                                             std::span<const RigidObstacle> other_obstacles) const {
  const Gap to_bone = gap_to_bone(obstacle_, p_L, gap);
  const bool is_on_other = std::abs(to_bone.gap_mm) <= options_.contact_snap_mm &&
                           is_closer_to_any(other_obstacles, p_L, to_bone.gap_mm);
  const double snap_mm = is_on_other ? 0.0 : options_.contact_snap_mm;
  return {rest_gap_mm(gap, to_bone, snap_mm), bone_rest_gap_mm(to_bone, snap_mm)};
}

void ContactTerm::find_dense_rest_gaps(std::span<const Vec3> nodes_L,
                                       std::span<const RigidObstacle> other_obstacles) {
  dense_rest_gaps_.resize(faces_.size());
  parallel_for(Index(faces_.size()), [&](Index n) {
    const DenseFace face = dense_faces(std::span(faces_).subspan(std::size_t(n), 1), nodes_L)[0];
    std::vector<RestGaps>& rest = dense_rest_gaps_[std::size_t(n)];
    rest.reserve(face.points.size());
    for (const DensePoint& point : face.points)
      rest.push_back(rest_gaps(point.x_L, measure_gap(obstacle_, point.x_L, Derivatives::kFirst),
                               other_obstacles));
  });
}

template <class Function>
void ContactTerm::for_each_point(std::size_t patch, std::span<const Vec3> x_L,
                                 const Function& f) const {
  const ContactPatch& of = surface_.patch(patch);
  const PatchPositions x(of.span(), x_L);
  const FaceQuadrature& rule = face_quadrature(of.rule);
  const RuleDistances at(obstacle_, rule, x.span(), Derivatives::kFirst);
  for (std::size_t q = 0; q < rule.points.size(); ++q)
    f(PointGap{.number = of.first_point + q,
               .N = std::span(rule.points[q].N).first(of.count),
               .p_L = at.p_L[q],
               .gap = {.zone = at.samples[q].zone,
                       .gap_mm = at.samples[q].distance_mm,
                       .gradient_L = at.gradient_L(q),
                       .hessian_L = Mat3::Zero()}});
}

PointContact ContactTerm::contact_at(const PointGap& at) const {
  const double depth_mm = rest_gaps_mm_[at.number] - at.gap.gap_mm;
  const bool is_in_band = at.gap.zone == field::Zone::kBand;
  return {.area_mm2 = surface_.area_mm2(at.number),
          .pressure_mpa = is_in_band ? pressure_mpa(depth_mm, options_.law) : 0.0,
          .gradient_L = at.gap.gradient_L,
          .depth_mm = depth_mm};
}

void ContactTerm::note_clearances(std::span<const Vec3> x_L) {
  const double max_distance_mm = obstacle_.distance_query_B->max_distance_mm();
  parallel_for(Index(surface_.patches().size()), [&](Index item) {
    const auto patch = std::size_t(item);
    double clearance_mm = max_distance_mm;
    for_each_point(patch, x_L, [&](const PointGap& at) {
      const bool has_distance =
          at.gap.zone == field::Zone::kBand || at.gap.zone == field::Zone::kOutside;
      const double contact_gap_mm = std::max(rest_gaps_mm_[at.number], 0.0);
      clearance_mm = std::min(clearance_mm, has_distance ? at.gap.gap_mm - contact_gap_mm : 0.0);
    });
    const PatchPositions x(surface_.patch(patch).span(), x_L);
    clearance_.record(patch, obstacle_, x.span(), clearance_mm);
  });
}

double ContactTerm::passed_fraction(const RigidTransform& from_X_LB, std::span<const Vec3> from_L,
                                    std::span<const Vec3> to_L) const {
  const TraceSpan span("find passages through bone");
  const RigidObstacle at_origin{.distance_query_B = obstacle_.distance_query_B};
  const RigidTransform X_BL = obstacle_.X_LB.inverse(), from_X_BL = from_X_LB.inverse();
  std::vector<double> touching_mm2(faces_.size(), 0.0), passed_mm2(faces_.size(), 0.0);
  parallel_for(Index(faces_.size()), [&](Index n) {
    const ContactPatch& patch = surface_.patch(std::size_t(n));
    const PatchPositions from(patch.span(), from_L), to(patch.span(), to_L);
    const FaceQuadrature& rule = face_quadrature(patch.rule);
    const RuleDistances end(obstacle_, rule, to.span(), Derivatives::kFirst);
    for (std::size_t q = 0; q < rule.points.size(); ++q) {
      if (end.samples[q].distance_mm >= 0.0) continue;
      const double area_mm2 = surface_.area_mm2(patch.first_point + q);
      const Vec3 end_B = X_BL * end.p_L[q];
      const Vec3 start_B = from_X_BL * interpolate(rule.points[q], from.span());
      touching_mm2[std::size_t(n)] += area_mm2;
      if (allowed_fraction(at_origin, start_B, end_B - start_B) < 1.0)
        passed_mm2[std::size_t(n)] += area_mm2;
    }
  });
  const double touching = std::accumulate(touching_mm2.begin(), touching_mm2.end(), 0.0);
  return touching > 0.0 ? std::accumulate(passed_mm2.begin(), passed_mm2.end(), 0.0) / touching
                        : 0.0;
}

std::optional<std::string> ContactTerm::rejection_reason(const RigidTransform& from_X_LB,
                                                         std::span<const Vec3> from_L,
                                                         std::span<const Vec3> to_L) const {
  const double fraction = passed_fraction(from_X_LB, from_L, to_L);
  if (fraction <= kMaxPassedFraction) return std::nullopt;
  return fmt::format("{:.1f} % of the tissue in {} passed through thin bone in one increment",
                     100.0 * fraction, options_.name);
}

bool ContactTerm::evaluate(Index item, std::span<const Vec3> x_L,
                           fem::LocalEquations& local) const {
  const ContactPatch& patch = surface_.patch(std::size_t(item));
  const FaceQuadrature& rule = face_quadrature(patch.rule);
  if (clearance_.is_out_of_range(std::size_t(item), obstacle_, x_L, rule.displacement_bound))
    return true;
  const bool is_projected = local.wants_stiffness() && local.tangent != fem::Tangent::kExact;
  const RuleDistances at(obstacle_, rule, x_L,
                         local.wants_stiffness() ? Derivatives::kSecond : Derivatives::kFirst);
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const std::size_t number = patch.first_point + q;
    const field::Zone zone = at.samples[q].zone;
    const bool is_out_of_range = zone == field::Zone::kInside || zone == field::Zone::kUnknown;
    if (is_out_of_range && has_rest_gap_[number] != 0) return false;
    const double depth_mm = rest_gaps_mm_[number] - at.samples[q].distance_mm;
    if (zone != field::Zone::kBand || !(depth_mm > 0.0)) continue;

    const double area_mm2 = surface_.area_mm2(number);
    const Vec3 gradient_L = at.gradient_L(q);
    const Mat3 hessian_L = local.wants_stiffness() ? at.hessian_L(q) : Mat3::Zero();
    const PenaltyResponse response =
        penalty_response(depth_mm, gradient_L, hessian_L, options_.law);
    local.energy_mj += area_mm2 * response.energy_mj_per_mm2;
    ++local.contacts;
    local.deepest_mm = std::max(local.deepest_mm, depth_mm);
    const Mat3 hessian_mpa_per_mm =
        is_projected ? psd_projected_hessian(depth_mm, gradient_L, hessian_L, options_.law)
                     : response.hessian_mpa_per_mm;
    add_point(area_mm2, std::span(rule.points[q].N).first(x_L.size()), response, hessian_mpa_per_mm,
              local);
  }
  return true;
}

std::string ContactTerm::inadmissible_cause() const {
  return fmt::format(
      "tissue lies deeper in {} than its distance field reaches, {:.2f} mm "
      "(field.band_mm)",
      options_.name, obstacle_.distance_query_B->max_distance_mm());
}

bool ContactTerm::may_touch(const DenseFace& face, std::span<const RestGaps> rest) const {
  const Vec3& first_L = face.points.front().x_L;
  double radius_mm = 0.0, max_rest_mm = rest.front().obstacle_mm;
  for (const DensePoint& point : face.points)
    radius_mm = std::max(radius_mm, (point.x_L - first_L).norm());
  for (const RestGaps& one : rest) max_rest_mm = std::max(max_rest_mm, one.obstacle_mm);
  const double gap_mm = measure_gap(obstacle_, first_L, Derivatives::kFirst).gap_mm;
  return gap_mm - kMaxGapSlope * radius_mm <= max_rest_mm;
}

std::vector<DepthSample> ContactTerm::depths_of_face(std::size_t face,
                                                     std::span<const Vec3> x_L) const {
  std::vector<DepthSample> depths;
  const DenseFace dense = dense_faces(std::span(faces_).subspan(face, 1), x_L)[0];
  if (!may_touch(dense, dense_rest_gaps_[face])) return depths;
  double area_mm2 = 0.0;  // Of the reference surface.
  for (std::size_t q = 0; q < face_quadrature(surface_.patch(face).rule).points.size(); ++q)
    area_mm2 += surface_.area_mm2(surface_.patch(face).first_point + q);
  std::vector<Vec3> points_L(dense.points.size());
  std::ranges::transform(dense.points, points_L.begin(), &DensePoint::x_L);
  std::vector<Gap> gaps(points_L.size());
  measure_gaps(obstacle_, points_L, Derivatives::kFirst, gaps);
  for (std::size_t n = 0; n < points_L.size(); ++n) {
    const Vec3& p_L = points_L[n];
    const Gap& gap = gaps[n];
    const RestGaps& rest = dense_rest_gaps_[face][n];
    const double depth_mm = rest.obstacle_mm - gap.gap_mm;
    const bool has_depth = gap.zone == field::Zone::kBand || gap.zone == field::Zone::kInside;
    if (!has_depth || !(depth_mm > 0.0)) continue;
    depths.push_back({.area_mm2 = area_mm2 / double(dense.points.size()),
                      .gap_mm = gap.gap_mm,
                      .depth_mm = depth_mm,
                      .bone_depth_mm = bone_depth_mm(obstacle_, p_L, gap, rest.bone_mm)});
  }
  return depths;
}

ContactStatistics ContactTerm::summarize(std::span<const Vec3> x_L) const {
  const TraceSpan span("measure depths");
  std::vector<std::vector<DepthSample>> depths(faces_.size());
  std::vector<std::vector<PointContact>> points(faces_.size());
  parallel_for(Index(faces_.size()), [&](Index n) {
    const auto face = std::size_t(n);
    depths[face] = depths_of_face(face, x_L);
    const PatchPositions x(surface_.patch(face).span(), x_L);
    const double bound = face_quadrature(surface_.patch(face).rule).displacement_bound;
    if (!clearance_.is_out_of_range(face, obstacle_, x.span(), bound))
      for_each_point(face, x_L,
                     [&](const PointGap& at) { points[face].push_back(contact_at(at)); });
  });
  ContactStatisticsSum sum;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    for (const PointContact& point : points[face]) sum.add(point, surface_.patch(face).span());
    for (const DepthSample& sample : depths[face]) sum.add(sample);
  }
  return std::move(sum).finish();
}

std::vector<ContactPoint> ContactTerm::contact_points(std::span<const Vec3> x_L) const {
  std::vector<ContactPoint> points;
  for (std::size_t patch = 0; patch < surface_.patches().size(); ++patch)
    for_each_point(patch, x_L, [&](const PointGap& at) {
      const PointContact contact = contact_at(at);
      const Vec3 traction_mpa = contact.pressure_mpa * contact.gradient_L;
      if (traction_mpa.isZero(0.0)) return;
      points.push_back({.x_L = at.p_L,
                        .pressure_mpa = traction_mpa.norm(),
                        .force_n = contact.area_mm2 * traction_mpa});
    });
  return points;
}

std::vector<NodalContact> ContactTerm::at_nodes(std::span<const Vec3> x_L) const {
  NodalContactSum sum;
  for (std::size_t patch = 0; patch < surface_.patches().size(); ++patch)
    for_each_point(patch, x_L, [&](const PointGap& at) {
      sum.add(contact_at(at), surface_.patch(patch).span(), at.N);
    });
  return std::move(sum).finish(obstacle_, x_L);
}

}  // namespace lefort::contact
