#include <lefort/contact/contact_term.h>
#include <lefort/contact/face_quadrature.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/mesh/element_faces.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace lefort::contact {
namespace {

/// The nodes of a patch, picked from all.
struct NodeListBuilder {
  std::array<Vec3, kMaxFaceNodes> x_L;
  std::size_t count = 0;

  NodeListBuilder(std::span<const std::int32_t> nodes, std::span<const Vec3> all_L)
      : count(nodes.size()) {
    for (std::size_t a = 0; a < count; ++a) x_L[a] = all_L[std::size_t(nodes[a])];
  }
  [[nodiscard]] std::span<const Vec3> span() const { return {x_L.data(), count}; }
};

/// Gaps at the points of a rule.
struct RuleGaps {
  std::array<Vec3, kMaxPoints> p_L;
  std::array<Gap, kMaxPoints> gaps;

  RuleGaps(const RigidObstacle& obstacle, const FaceQuadrature& rule, std::span<const Vec3> x_L,
           Derivatives derivatives) {
    const std::size_t count = rule.points.size();
    for (std::size_t q = 0; q < count; ++q) p_L[q] = interpolate(rule.points[q], x_L);
    measure_gaps(obstacle, std::span(p_L).first(count), derivatives, std::span(gaps).first(count));
  }
};

/// What lies behind the `share` of the area that lies deepest.
double depth_at_fraction(std::vector<std::pair<double, double>> depth_and_area, double fraction) {
  std::sort(depth_and_area.begin(), depth_and_area.end(), std::greater<>());
  double total_mm2 = 0.0, passed_mm2 = 0.0;
  for (const auto& [depth_mm, area_mm2] : depth_and_area) total_mm2 += area_mm2;
  for (const auto& [depth_mm, area_mm2] : depth_and_area) {
    passed_mm2 += area_mm2;
    if (passed_mm2 > fraction * total_mm2) return depth_mm;
  }
  return 0.0;
}

}  // namespace

ContactStatistics combine(const ContactStatistics& a, const ContactStatistics& b) {
  const double area_mm2 = a.area_mm2 + b.area_mm2;
  const auto mean = [&](double of_a, double of_b) {
    return area_mm2 > 0.0 ? (a.area_mm2 * of_a + b.area_mm2 * of_b) / area_mm2 : 0.0;
  };
  return {.points = a.points + b.points,
          .nodes = a.nodes + b.nodes,
          .area_mm2 = area_mm2,
          .max_penetration_mm = std::max(a.max_penetration_mm, b.max_penetration_mm),
          .mean_penetration_mm = mean(a.mean_penetration_mm, b.mean_penetration_mm),
          .max_depth_from_rest_mm = std::max(a.max_depth_from_rest_mm, b.max_depth_from_rest_mm),
          .mean_depth_from_rest_mm = mean(a.mean_depth_from_rest_mm, b.mean_depth_from_rest_mm),
          .p99_depth_from_rest_mm = std::max(a.p99_depth_from_rest_mm, b.p99_depth_from_rest_mm),
          .force_L_n = a.force_L_n + b.force_L_n,
          .normal_force_n = a.normal_force_n + b.normal_force_n,
          .tunnelled_area_mm2 = a.tunnelled_area_mm2 + b.tunnelled_area_mm2};
}

struct ContactTerm::PointGap {
  Vec3 p_L;
  Gap measured;  ///< From the nearest surface.
  Gap acting;    ///< From what holds the point off.
};

ContactTerm::ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                         RigidObstacle obstacle, const Options& options,
                         std::span<const RigidObstacle> other_obstacles)
    : name_(options.name),
      obstacle_(std::move(obstacle)),
      stiffness_mpa_per_mm_(options.stiffness_mpa_per_mm),
      penetration_tolerance_mm_(options.penetration_tolerance_mm) {
  LEFORT_CHECK(obstacle_.distance_query_B != nullptr);
  LEFORT_CHECK(stiffness_mpa_per_mm_ > 0.0 && options.capture_mm >= 0.0);
  LEFORT_CHECK(options.penetration_tolerance_mm.value_or(1.0) > 0.0);
  LEFORT_CHECK(options.capture_mm < obstacle_.distance_query_B->max_distance_mm());
  if (options.integration == Integration::kQuadrature)
    add_faces(nodes_L, faces);
  else
    add_nodes(nodes_L, faces);
  for (const Patch& patch : patches_)
    for_each_point(patch, nodes_L, [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
      const bool rests_beside = std::any_of(
          other_obstacles.begin(), other_obstacles.end(), [&](const RigidObstacle& other) {
            return measure_gap(other, at.p_L, Derivatives::kFirst).gap_mm < at.measured.gap_mm;
          });
      points_[k].rest_gap_mm = rest_gap_mm(at.measured, rests_beside ? 0.0 : options.capture_mm);
      points_[k].committed_reference = contact_reference(obstacle_, at.p_L, at.measured);
    });
  last_clearance_.resize(patches_.size());
  note_clearances(nodes_L);
}

void ContactTerm::add_faces(std::span<const Vec3> nodes_L, const std::vector<mesh::Face>& faces) {
  patches_.reserve(faces.size());
  for (const mesh::Face& face : faces) {
    const auto nodes = mesh::nodes_of(face);
    Patch patch{.count = std::uint8_t(nodes.size()),
                .rule = std::uint8_t(face.shape),
                .first_point = points_.size()};
    std::copy(nodes.begin(), nodes.end(), patch.nodes.begin());
    const NodeListBuilder x(nodes, nodes_L);
    for (const QuadraturePoint& point : face_quadrature(patch.rule).points)
      points_.push_back({.area_mm2 = area_mm2(point, x.span())});
    patches_.push_back(patch);
  }
}

void ContactTerm::add_nodes(std::span<const Vec3> nodes_L, const std::vector<mesh::Face>& faces) {
  std::map<std::int32_t, double> fraction_mm2;
  for (const mesh::Face& face : faces) {
    const auto nodes = mesh::nodes_of(face);
    const NodeListBuilder x(nodes, nodes_L);
    double face_mm2 = 0.0;
    for (const QuadraturePoint& point : face_quadrature(std::size_t(face.shape)).points)
      face_mm2 += area_mm2(point, x.span());
    for (std::size_t a = 0; a < nodes.size(); ++a)
      fraction_mm2[nodes[a]] += face_mm2 * lumped_weight(face.shape, a);
  }
  for (const auto& [node, area_mm2] : fraction_mm2) {
    patches_.push_back(
        {.nodes = {node}, .count = 1, .rule = kNodeRule, .first_point = points_.size()});
    points_.push_back({.area_mm2 = area_mm2});
  }
}

template <class Function>
void ContactTerm::for_each_point(const Patch& patch, std::span<const Vec3> x_L,
                                 const Function& f) const {
  const NodeListBuilder x(patch.span(), x_L);
  const FaceQuadrature& rule = face_quadrature(patch.rule);
  const RuleGaps at(obstacle_, rule, x.span(), Derivatives::kFirst);
  for (std::size_t q = 0; q < rule.points.size(); ++q)
    f(patch.first_point + q, rule.points[q],
      PointGap{at.p_L[q], at.gaps[q],
               acting_gap(points_[patch.first_point + q], at.p_L[q], at.gaps[q])});
}

double ContactTerm::pressure_at(const Point& point, const Gap& acting) const {
  if (acting.zone != field::Zone::kBand) return 0.0;
  return pressure_mpa(point.rest_gap_mm - acting.gap_mm, penalty_at(point));
}

Gap ContactTerm::acting_gap(const Point& point, const Vec3& p_L, const Gap& measured) const {
  return point.now.is_plane_constrained
             ? gap_to_tangent_plane(obstacle_, p_L, point.committed_reference)
             : measured;
}

double ContactTerm::rest_gap_mm(const Gap& at_rest, double capture_mm) const {
  const bool touches = at_rest.zone == field::Zone::kBand && std::abs(at_rest.gap_mm) <= capture_mm;
  return touches ? at_rest.gap_mm : std::min(at_rest.gap_mm, 0.0);
}

void ContactTerm::commit(std::span<const Vec3> x_L) {
  tunnelled_area_mm2_ += deterministic_sum(Index(patches_.size()), 0.0, [&](Index item) {
    double lost_mm2 = 0.0;
    for_each_point(
        patches_[std::size_t(item)], x_L,
        [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
          Point& point = points_[k];
          const bool crossed_medial_surface =
              uses_tangent_planes() &&
              has_crossed_medial_surface(obstacle_, at.p_L, at.measured, point.committed_reference);
          if (!crossed_medial_surface && has_tunnelled(point, at.measured))
            lost_mm2 += point.area_mm2;
          point.committed = point.now;
          point.crossed_medial_surface = crossed_medial_surface;
          point.has_returned =
              point.now.is_plane_constrained &&
              has_returned(obstacle_, at.p_L, at.measured, point.committed_reference);
          if (!point.now.is_plane_constrained && !crossed_medial_surface)
            point.committed_reference = contact_reference(obstacle_, at.p_L, at.measured);
        });
    return lost_mm2;
  });
  note_clearances(x_L);
}

Index ContactTerm::activate_tangent_planes(std::span<const Vec3> x_L) {
  if (!uses_tangent_planes()) return 0;
  return deterministic_sum(Index(patches_.size()), Index(0), [&](Index item) {
    Index kept = 0;
    for_each_point(patches_[std::size_t(item)], x_L,
                   [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
                     Point& point = points_[k];
                     if (point.now.is_plane_constrained ||
                         !has_crossed_medial_surface(obstacle_, at.p_L, at.measured,
                                                     point.committed_reference))
                       return;
                     point.now.is_plane_constrained = true;
                     last_clearance_[std::size_t(item)].clearance_mm = 0.0;
                     ++kept;
                   });
    return kept;
  });
}

void ContactTerm::note_clearances(std::span<const Vec3> x_L) {
  const Mat3 R_BL = obstacle_.X_LB.linear().transpose();
  const double max_distance_mm = obstacle_.distance_query_B->max_distance_mm();
  parallel_for(Index(patches_.size()), [&](Index item) {
    const Patch& patch = patches_[std::size_t(item)];
    const NodeListBuilder x(patch.span(), x_L);
    Clearance& clearance = last_clearance_[std::size_t(item)];
    clearance.clearance_mm = max_distance_mm;
    for (std::size_t a = 0; a < x.count; ++a)
      clearance.nodes_B[a] = R_BL * (x.x_L[a] - obstacle_.X_LB.translation());
    for_each_point(patch, x_L, [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
      const Point& point = points_[k];
      const bool is_seen =
          at.measured.zone == field::Zone::kBand || at.measured.zone == field::Zone::kOutside;
      const double touching_at_mm = std::max(point.rest_gap_mm, 0.0);
      const bool may_be_clear =
          is_seen && point.now.multiplier_mpa == 0.0 && !point.now.is_plane_constrained;
      clearance.clearance_mm = std::min(clearance.clearance_mm,
                                        may_be_clear ? at.measured.gap_mm - touching_at_mm : 0.0);
    });
  });
}

void ContactTerm::update_multipliers(std::span<const Vec3> x_L) {
  constexpr double kEnough = 0.5;  // Of the depth before, that one augmentation should leave.
  constexpr double kStiffer = 4.0, kStiffest = 64.0;
  parallel_for(Index(patches_.size()), [&](Index item) {
    for_each_point(patches_[std::size_t(item)], x_L,
                   [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
                     Point& point = points_[k];
                     const double depth_mm = point.rest_gap_mm - at.acting.gap_mm;
                     point.now.multiplier_mpa = pressure_at(point, at.acting);
                     if (!(point.now.multiplier_mpa > 0.0))
                       point.now.penalty_scale = 1.0;
                     else if (depth_mm > penetration_tolerance_mm_.value_or(0.0) &&
                              depth_mm > kEnough * point.now.depth_mm)
                       point.now.penalty_scale =
                           std::min(kStiffer * point.now.penalty_scale, kStiffest);
                     point.now.depth_mm = depth_mm;
                     // A pressure that is borne without depth reaches beyond the clearance.
                     if (point.now.multiplier_mpa > 0.0)
                       last_clearance_[std::size_t(item)].clearance_mm = 0.0;
                   });
  });
}

void ContactTerm::rollback() {
  for (Point& point : points_) point.now = point.committed;
}

void ContactTerm::begin_step() {
  for (Point& point : points_)
    point.now = {
        .multiplier_mpa = point.committed.multiplier_mpa,
        .is_plane_constrained = point.committed.is_plane_constrained && !point.has_returned,
        .penalty_scale = point.committed.penalty_scale};
}

ContactTerm::Checkpoint ContactTerm::checkpoint() const {
  Checkpoint checkpoint{.multipliers_mpa = {},
                        .penalty_scales = {},
                        .tangent_planes = {},
                        .tunnelled_area_mm2 = tunnelled_area_mm2_};
  for (const Point& point : points_) {
    checkpoint.multipliers_mpa.push_back(point.committed.multiplier_mpa);
    checkpoint.penalty_scales.push_back(point.committed.penalty_scale);
    checkpoint.tangent_planes.push_back(
        {.foot_B = point.committed_reference.foot_B,
         .normal_B = point.committed_reference.normal_B,
         .is_plane_constrained = point.committed.is_plane_constrained});
  }
  return checkpoint;
}

void ContactTerm::restore(const Checkpoint& checkpoint, std::span<const Vec3> x_L) {
  LEFORT_CHECK(checkpoint.multipliers_mpa.size() == points_.size());
  LEFORT_CHECK(checkpoint.penalty_scales.size() == points_.size());
  LEFORT_CHECK(checkpoint.tangent_planes.size() == points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Checkpoint::TangentPlane& tangent_plane = checkpoint.tangent_planes[k];
    points_[k].now = {.multiplier_mpa = checkpoint.multipliers_mpa[k],
                      .is_plane_constrained = tangent_plane.is_plane_constrained,
                      .penalty_scale = checkpoint.penalty_scales[k]};
    points_[k].committed_reference = {tangent_plane.foot_B, tangent_plane.normal_B, true};
  }
  commit(x_L);
  tunnelled_area_mm2_ = checkpoint.tunnelled_area_mm2;
}

std::optional<std::string> ContactTerm::rejection_reason(std::span<const Vec3> x_L) const {
  constexpr double kMaxTunnelledFraction = 0.02;  // Of the area in contact, in one increment.
  const double tunnelled_mm2 = newly_tunnelled_area_mm2(x_L);
  const double touching_mm2 = summarize(x_L).area_mm2;
  if (tunnelled_mm2 <= kMaxTunnelledFraction * touching_mm2) return std::nullopt;
  return fmt::format(
      "{:.1f} of {:.1f} mm^2 of tissue in contact have tunnelled through {} in one increment",
      tunnelled_mm2, touching_mm2, name_);
}

double ContactTerm::rest_penetration_mm() const {
  double deepest_mm = 0.0;
  for (const Point& point : points_) deepest_mm = std::max(deepest_mm, -point.rest_gap_mm);
  return deepest_mm;
}

bool ContactTerm::is_out_of_range(std::size_t patch, std::span<const Vec3> x_L) const {
  constexpr double kSlack = 0.2;  // Of what the detector resolves: its jumps, many times over.
  constexpr double kSlope = 1.1;  // Likewise for the length of its gradient.
  const double slack_mm = kSlack * obstacle_.distance_query_B->resolution_mm();
  const Clearance& last = last_clearance_[patch];
  if (last.clearance_mm <= slack_mm) return false;
  const double allowed_mm =
      (last.clearance_mm - slack_mm) / (kSlope * face_quadrature(patches_[patch].rule).reach);
  const Mat3 R_BL = obstacle_.X_LB.linear().transpose();
  for (std::size_t a = 0; a < x_L.size(); ++a) {
    const Vec3 x_B = R_BL * (x_L[a] - obstacle_.X_LB.translation());
    if (!((x_B - last.nodes_B[a]).squaredNorm() < allowed_mm * allowed_mm)) return false;
  }
  return true;
}

bool ContactTerm::has_tunnelled(const Point& point, const Gap& gap) const {
  // Outside the bone, normals turn freely: across a groove one wall takes over from the other.
  constexpr double kFarSide = -0.5;  // Cosine; an edge of over 60 degrees has no far side.
  return !point.now.is_plane_constrained && !point.crossed_medial_surface &&
         gap.zone == field::Zone::kBand && gap.gap_mm < 0.0 &&
         (obstacle_.X_LB.linear() * point.committed_reference.normal_B).dot(gap.gradient_L) <
             kFarSide;
}

double ContactTerm::newly_tunnelled_area_mm2(std::span<const Vec3> x_L) const {
  return deterministic_sum(Index(patches_.size()), 0.0, [&](Index item) {
    double tunnelled_mm2 = 0.0;
    for_each_point(patches_[std::size_t(item)], x_L,
                   [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
                     if (has_tunnelled(points_[k], at.measured))
                       tunnelled_mm2 += points_[k].area_mm2;
                   });
    return tunnelled_mm2;
  });
}

bool ContactTerm::evaluate(Index item, std::span<const Vec3> x_L,
                           fem::LocalEquations& local) const {
  if (is_out_of_range(std::size_t(item), x_L)) return true;
  const Patch& patch = patches_[std::size_t(item)];
  const FaceQuadrature& rule = face_quadrature(patch.rule);
  const RuleGaps measured(obstacle_, rule, x_L,
                          local.wants_stiffness() ? Derivatives::kSecond : Derivatives::kFirst);
  const auto nodes = Index(x_L.size());
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const Point& point = points_[patch.first_point + q];
    const auto& N = rule.points[q].N;
    const field::Zone zone = measured.gaps[q].zone;
    if (zone == field::Zone::kInside) return false;
    if (zone == field::Zone::kUnknown && point.committed_reference.is_side_known) return false;

    const Gap gap = acting_gap(point, measured.p_L[q], measured.gaps[q]);
    const double depth_mm = point.rest_gap_mm - gap.gap_mm;
    const PenaltyParameters penalty = penalty_at(point);
    const PenaltyResponse response =
        penalty_response(depth_mm, gap.gradient_L, gap.hessian_L, penalty);
    local.energy_mj += point.area_mm2 * response.energy_mj_per_mm2;
    if (gap.zone != field::Zone::kBand || !(pressure_mpa(depth_mm, penalty) > 0.0)) continue;

    ++local.contacts;
    local.deepest_mm = std::max(local.deepest_mm, depth_mm);
    for (Index a = 0; a < nodes; ++a)
      local.residual_n.segment<3>(3 * a) +=
          point.area_mm2 * N[std::size_t(a)] * response.gradient_mpa;
    if (!local.wants_stiffness()) continue;
    const Mat3 hessian_mpa_per_mm =
        local.tangent == fem::Tangent::kExact
            ? response.hessian_mpa_per_mm
            : psd_projected_hessian(depth_mm, gap.gradient_L, gap.hessian_L, penalty);
    for (Index a = 0; a < nodes; ++a)
      for (Index b = 0; b < nodes; ++b)
        local.stiffness_n_per_mm.block<3, 3>(3 * a, 3 * b) +=
            point.area_mm2 * N[std::size_t(a)] * N[std::size_t(b)] * hessian_mpa_per_mm;
  }
  return true;
}

ContactStatistics ContactTerm::summarize(std::span<const Vec3> x_L) const {
  constexpr double kDeepest = 0.01;  // Of the area in contact: what lies beyond the P99.
  ContactStatistics summary;
  std::set<std::int32_t> nodes;
  std::vector<std::pair<double, double>> depth_and_area;
  for (const Patch& patch : patches_) {
    for_each_point(patch, x_L, [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
      const Point& point = points_[k];
      const double p_mpa = pressure_at(point, at.acting);
      if (!(p_mpa > 0.0)) return;
      // Of a point that is held off by a wall, too, the nearest surface tells what is left.
      const double gap_mm = std::min(at.acting.gap_mm, at.measured.gap_mm);
      const double penetration_mm = std::max(-gap_mm, 0.0);
      const double depth_mm = point.rest_gap_mm - gap_mm;
      const Vec3 force_n = point.area_mm2 * p_mpa * at.acting.gradient_L;
      ++summary.points;
      nodes.insert(patch.span().begin(), patch.span().end());
      summary.area_mm2 += point.area_mm2;
      summary.max_penetration_mm = std::max(summary.max_penetration_mm, penetration_mm);
      summary.mean_penetration_mm += point.area_mm2 * penetration_mm;
      summary.max_depth_from_rest_mm = std::max(summary.max_depth_from_rest_mm, depth_mm);
      summary.mean_depth_from_rest_mm += point.area_mm2 * depth_mm;
      depth_and_area.emplace_back(depth_mm, point.area_mm2);
      summary.force_L_n += force_n;
      summary.normal_force_n += force_n.norm();
    });
  }
  summary.p99_depth_from_rest_mm =
      std::max(depth_at_fraction(std::move(depth_and_area), kDeepest), 0.0);
  summary.nodes = Index(nodes.size());
  summary.tunnelled_area_mm2 = tunnelled_area_mm2_;
  if (summary.area_mm2 > 0.0) {
    summary.mean_penetration_mm /= summary.area_mm2;
    summary.mean_depth_from_rest_mm /= summary.area_mm2;
  }
  return summary;
}

std::vector<TouchedPoint> ContactTerm::touched_points(std::span<const Vec3> x_L) const {
  std::vector<TouchedPoint> touched;
  for (const Patch& patch : patches_)
    for_each_point(patch, x_L, [&](std::size_t k, const QuadraturePoint&, const PointGap& at) {
      const Vec3 traction_mpa = pressure_at(points_[k], at.acting) * at.acting.gradient_L;
      if (traction_mpa.isZero(0.0)) return;
      touched.push_back({.x_L = at.p_L,
                         .pressure_mpa = traction_mpa.norm(),
                         .force_n = points_[k].area_mm2 * traction_mpa});
    });
  return touched;
}

std::vector<NodalContact> ContactTerm::at_nodes(std::span<const Vec3> x_L) const {
  // Not the pressure at the node itself: flat faces around a ball touch it in their middles alone.
  std::map<std::int32_t, NodalContact> of_node;
  std::map<std::int32_t, double> fraction_mm2;
  for (const Patch& patch : patches_) {
    for_each_point(patch, x_L, [&](std::size_t k, const QuadraturePoint& rule, const PointGap& at) {
      const Point& point = points_[k];
      const double p_mpa = pressure_at(point, at.acting) * at.acting.gradient_L.norm();
      const double depth_mm =
          p_mpa > 0.0 ? point.rest_gap_mm - std::min(at.acting.gap_mm, at.measured.gap_mm) : 0.0;
      for (std::size_t a = 0; a < patch.count; ++a) {
        const double weight_mm2 = point.area_mm2 * std::abs(rule.N[a]);
        NodalContact& node = of_node[patch.nodes[a]];
        node.pressure_mpa += weight_mm2 * p_mpa;
        node.depth_mm = std::max(node.depth_mm, depth_mm);
        fraction_mm2[patch.nodes[a]] += weight_mm2;
      }
    });
  }
  std::vector<NodalContact> touched;
  for (auto& [node, contact] : of_node) {
    const Gap gap = measure_gap(obstacle_, x_L[std::size_t(node)], Derivatives::kFirst);
    contact.node = node;
    contact.pressure_mpa /= fraction_mm2.at(node);
    contact.gap_mm =
        gap.zone == field::Zone::kUnknown ? std::numeric_limits<double>::quiet_NaN() : gap.gap_mm;
    touched.push_back(contact);
  }
  return touched;
}

}  // namespace lefort::contact
