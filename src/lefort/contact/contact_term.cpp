#include <lefort/contact/contact_term.h>
#include <lefort/contact/penalty.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/fem/faces/all_faces.h>
#include <lefort/mesh/element_faces.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace lefort::contact {
namespace {

constexpr std::size_t kMaxFaceNodes = 8;

/// A point of a reference face.
struct RulePoint {
  double weight = 0.0;
  std::array<double, kMaxFaceNodes> N{};
  Eigen::Matrix<double, 2, kMaxFaceNodes> dN_dxi = Eigen::Matrix<double, 2, kMaxFaceNodes>::Zero();
};

/// Where a face of one shape is asked for its gap.
struct Rule {
  std::vector<RulePoint> points;
  double reach = 1.0;  ///< How much further a point may move than the nodes do, at most.
};

/// Gaps are no polynomials, and the denser the points the less an edge slips between them: six
/// points of a triangle, of degree 4 (\cite dunavant1985), and 3 x 3 of a quadrilateral.
template <class Shape>
Rule rule_of() {
  Rule rule;
  const auto add = [&](const auto& points) {
    for (const auto& known : fem::at_points<Shape>(points)) {
      RulePoint& point = rule.points.emplace_back();
      point.weight = known.weight;
      for (int a = 0; a < Shape::kNodes; ++a) point.N[std::size_t(a)] = known.N[a];
      point.dN_dxi.template leftCols<Shape::kNodes>() = known.dN_dxi;
      rule.reach = std::max(rule.reach, known.N.cwiseAbs().sum());
    }
  };
  if constexpr (mesh::corner_count(Shape::kShape) == 3)
    add(fem::triangle_6());
  else
    add(fem::product(fem::gauss_3(), fem::gauss_3()));
  return rule;
}

const Rule& rule_of(mesh::FaceShape shape) {
  static const std::array<Rule, 4> rules{rule_of<fem::Tri3>(), rule_of<fem::Quad4>(),
                                         rule_of<fem::Tri6>(), rule_of<fem::Quad8>()};
  return rules[std::size_t(shape)];
}

/// Where a point is, its face's nodes being at x.
Vec3 interpolate(const RulePoint& point, std::span<const Vec3> x_L) {
  Vec3 p_L = point.N[0] * x_L[0];
  for (std::size_t a = 1; a < x_L.size(); ++a) p_L += point.N[a] * x_L[a];
  return p_L;
}

/// The area a point stands for.
double area_mm2(const RulePoint& point, std::span<const Vec3> x_L) {
  Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t a = 0; a < x_L.size(); ++a)
    tangents += x_L[a] * point.dN_dxi.col(Index(a)).transpose();
  return point.weight * tangents.col(0).cross(tangents.col(1)).norm();
}

/// The nodes of a face, picked from all.
struct FaceNodes {
  std::array<Vec3, kMaxFaceNodes> x_L;
  std::size_t count = 0;

  FaceNodes(const mesh::Face& face, std::span<const Vec3> all_L)
      : count(std::size_t(mesh::node_count(face.shape))) {
    for (std::size_t a = 0; a < count; ++a) x_L[a] = all_L[std::size_t(face.nodes[a])];
  }
  [[nodiscard]] std::span<const Vec3> span() const { return {x_L.data(), count}; }
};

}  // namespace

ContactTerm::ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                         BoneObstacle obstacle, const Options& options)
    : faces_(std::move(faces)),
      obstacle_(std::move(obstacle)),
      stiffness_mpa_per_mm_(options.stiffness_mpa_per_mm) {
  LEFORT_CHECK(stiffness_mpa_per_mm_ > 0.0 && options.capture_mm >= 0.0);
  LEFORT_CHECK(options.capture_mm < reach_mm(*obstacle_.field_B, obstacle_.reconstruction));
  first_point_.reserve(faces_.size());
  for (const mesh::Face& face : faces_) {
    const FaceNodes x(face, nodes_L);
    first_point_.push_back(points_.size());
    for (const RulePoint& point : rule_of(face.shape).points)
      points_.push_back(
          {.area_mm2 = area_mm2(point, x.span()),
           .rest_gap_mm = rest_gap_mm(interpolate(point, x.span()), options.capture_mm)});
  }
  last_clearance_.resize(faces_.size());
  remember(nodes_L);
}

template <class Function>
void ContactTerm::for_each_gap(std::size_t face, std::span<const Vec3> x_L,
                               const Function& f) const {
  const FaceNodes x(faces_[face], x_L);
  std::size_t k = first_point_[face];
  for (const RulePoint& at : rule_of(faces_[face].shape).points)
    f(k++, at, measure_gap(obstacle_, interpolate(at, x.span()), Derivatives::kFirst));
}

double ContactTerm::rest_gap_mm(const Vec3& rest_L, double capture_mm) const {
  const Gap gap = measure_gap(obstacle_, rest_L, Derivatives::kFirst);
  const bool touches = gap.zone == field::Zone::kBand && std::abs(gap.gap_mm) <= capture_mm;
  return touches ? gap.gap_mm : std::min(gap.gap_mm, 0.0);
}

void ContactTerm::remember(std::span<const Vec3> x_L) {
  tunnelled_area_mm2_ += newly_tunnelled_area_mm2(x_L);
  const Mat3 R_BL = obstacle_.X_LB.linear().transpose();
  parallel_for(Index(faces_.size()), [&](Index item) {
    const FaceNodes x(faces_[std::size_t(item)], x_L);
    Clearance& clearance = last_clearance_[std::size_t(item)];
    clearance.clearance_mm = reach_mm(*obstacle_.field_B, obstacle_.reconstruction);
    for (std::size_t a = 0; a < x.count; ++a)
      clearance.nodes_B[a] = R_BL * (x.x_L[a] - obstacle_.X_LB.translation());
    for_each_gap(std::size_t(item), x_L, [&](std::size_t k, const RulePoint&, const Gap& gap) {
      Point& point = points_[k];
      const bool is_seen = gap.zone == field::Zone::kBand || gap.zone == field::Zone::kOutside;
      const double touching_at_mm = std::max(point.rest_gap_mm, 0.0);
      clearance.clearance_mm =
          std::min(clearance.clearance_mm, is_seen ? gap.gap_mm - touching_at_mm : 0.0);
      point.last_sight = {R_BL * gap.gradient_L, gap.zone != field::Zone::kUnknown};
    });
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
  for (const Point& point : points_) deepest_mm = std::max(deepest_mm, -point.rest_gap_mm);
  return deepest_mm;
}

bool ContactTerm::is_out_of_reach(std::size_t face, std::span<const Vec3> x_L) const {
  constexpr double kSlack_mm = 0.1;  // Errors of the field, many times over.
  constexpr double kSlope = 1.1;     // Likewise for the length of its gradient.
  const Clearance& last = last_clearance_[face];
  if (last.clearance_mm <= kSlack_mm) return false;
  const double allowed_mm =
      (last.clearance_mm - kSlack_mm) / (kSlope * rule_of(faces_[face].shape).reach);
  const Mat3 R_BL = obstacle_.X_LB.linear().transpose();
  for (std::size_t a = 0; a < x_L.size(); ++a) {
    const Vec3 x_B = R_BL * (x_L[a] - obstacle_.X_LB.translation());
    if (!((x_B - last.nodes_B[a]).squaredNorm() < allowed_mm * allowed_mm)) return false;
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
  return deterministic_sum(Index(faces_.size()), 0.0, [&](Index item) {
    double tunnelled_mm2 = 0.0;
    for_each_gap(std::size_t(item), x_L, [&](std::size_t k, const RulePoint&, const Gap& gap) {
      if (has_tunnelled(points_[k].last_sight, gap)) tunnelled_mm2 += points_[k].area_mm2;
    });
    return tunnelled_mm2;
  });
}

bool ContactTerm::evaluate(Index item, std::span<const Vec3> x_L,
                           fem::LocalEquations& local) const {
  if (is_out_of_reach(std::size_t(item), x_L)) return true;
  const Rule& rule = rule_of(faces_[std::size_t(item)].shape);
  const auto nodes = Index(x_L.size());
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const Point& point = points_[first_point_[std::size_t(item)] + q];
    const auto& N = rule.points[q].N;
    const Gap gap =
        measure_gap(obstacle_, interpolate(rule.points[q], x_L),
                    local.wants_stiffness() ? Derivatives::kSecond : Derivatives::kFirst);
    const double depth_mm = point.rest_gap_mm - gap.gap_mm;
    if (gap.zone == field::Zone::kInside) return false;
    if (gap.zone == field::Zone::kUnknown && point.last_sight.knows_side) return false;
    if (gap.zone != field::Zone::kBand || !(depth_mm > 0.0)) continue;

    ++local.contacts;
    const PenaltyResponse response =
        penalty_response(depth_mm, gap.gradient_L, gap.hessian_L, stiffness_mpa_per_mm_);
    local.energy_mj += point.area_mm2 * response.energy_mj_per_mm2;
    for (Index a = 0; a < nodes; ++a)
      local.residual_n.segment<3>(3 * a) +=
          point.area_mm2 * N[std::size_t(a)] * response.gradient_mpa;
    if (!local.wants_stiffness()) continue;
    const Mat3 hessian_mpa_per_mm =
        local.tangent == fem::Tangent::kExact
            ? response.hessian_mpa_per_mm
            : convex_hessian(depth_mm, gap.gradient_L, gap.hessian_L, stiffness_mpa_per_mm_);
    for (Index a = 0; a < nodes; ++a)
      for (Index b = 0; b < nodes; ++b)
        local.stiffness_n_per_mm.block<3, 3>(3 * a, 3 * b) +=
            point.area_mm2 * N[std::size_t(a)] * N[std::size_t(b)] * hessian_mpa_per_mm;
  }
  return true;
}

ContactSummary ContactTerm::summarise(std::span<const Vec3> x_L) const {
  ContactSummary summary;
  std::set<std::int32_t> nodes;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const auto face_nodes = mesh::nodes_of(faces_[face]);
    for_each_gap(face, x_L, [&](std::size_t k, const RulePoint&, const Gap& gap) {
      const Point& point = points_[k];
      const double penetration_mm = std::max(-gap.gap_mm, 0.0);
      const double depth_mm = point.rest_gap_mm - gap.gap_mm;
      if (gap.zone != field::Zone::kBand || !(depth_mm > 0.0)) return;
      const Vec3 force_n = -point.area_mm2 * penalty_response(depth_mm, gap.gradient_L,
                                                              gap.hessian_L, stiffness_mpa_per_mm_)
                                                 .gradient_mpa;
      ++summary.points;
      nodes.insert(face_nodes.begin(), face_nodes.end());
      summary.area_mm2 += point.area_mm2;
      summary.max_penetration_mm = std::max(summary.max_penetration_mm, penetration_mm);
      summary.mean_penetration_mm += point.area_mm2 * penetration_mm;
      summary.max_depth_from_rest_mm = std::max(summary.max_depth_from_rest_mm, depth_mm);
      summary.mean_depth_from_rest_mm += point.area_mm2 * depth_mm;
      summary.force_L_n += force_n;
      summary.normal_force_n += force_n.norm();
    });
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
  // Not the pressure at the node itself: flat faces around a ball touch it in their middles alone.
  std::map<std::int32_t, NodalContact> at;
  std::map<std::int32_t, double> share_mm2;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const auto face_nodes = mesh::nodes_of(faces_[face]);
    for_each_gap(face, x_L, [&](std::size_t k, const RulePoint& rule, const Gap& gap) {
      const Point& point = points_[k];
      const double pressure_mpa =
          gap.zone != field::Zone::kBand
              ? 0.0
              : penalty_response(point.rest_gap_mm - gap.gap_mm, gap.gradient_L, gap.hessian_L,
                                 stiffness_mpa_per_mm_)
                    .gradient_mpa.norm();
      for (std::size_t a = 0; a < face_nodes.size(); ++a) {
        const double weight_mm2 = point.area_mm2 * std::abs(rule.N[a]);
        at[face_nodes[a]].pressure_mpa += weight_mm2 * pressure_mpa;
        share_mm2[face_nodes[a]] += weight_mm2;
      }
    });
  }
  std::vector<NodalContact> touched;
  for (auto& [node, contact] : at) {
    const Gap gap = measure_gap(obstacle_, x_L[std::size_t(node)], Derivatives::kFirst);
    contact.node = node;
    contact.pressure_mpa /= share_mm2.at(node);
    contact.gap_mm =
        gap.zone == field::Zone::kUnknown ? std::numeric_limits<double>::quiet_NaN() : gap.gap_mm;
    touched.push_back(contact);
  }
  return touched;
}

}  // namespace lefort::contact
