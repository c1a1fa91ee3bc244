#include <lefort/contact/dense_faces.h>
#include <lefort/contact/penalty.h>
#include <lefort/contact/point_in_patch.h>
#include <lefort/contact/rest_gap.h>
#include <lefort/contact/step_bound.h>
#include <lefort/contact/weighted_contact_points.h>
#include <lefort/contact/weighted_contact_term.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::contact {
namespace {

constexpr std::size_t kMaxFacePoints = 48;

/// Gaps of points to the closest of several bones.
struct ClosestGaps {
  std::array<Gap, kMaxFacePoints> gaps;
  std::array<std::uint8_t, kMaxFacePoints> obstacle{};

  ClosestGaps(std::span<const RigidObstacle> obstacles, std::span<const Vec3> p_L,
              Derivatives derivatives) {
    const auto first = std::span(gaps).first(p_L.size());
    measure_gaps(obstacles[0], p_L, derivatives, first);
    std::array<Gap, kMaxFacePoints> others;
    for (std::size_t k = 1; k < obstacles.size(); ++k) {
      measure_gaps(obstacles[k], p_L, derivatives, std::span(others).first(p_L.size()));
      for (std::size_t i = 0; i < p_L.size(); ++i)
        if (others[i].gap_mm < gaps[i].gap_mm) {
          gaps[i] = others[i];
          obstacle[i] = std::uint8_t(k);
        }
    }
  }
};

/// Largest depth of a sharp point, as a fraction of the radius of a node patch. In one increment a
/// bone must not move further.
constexpr double kMaxDepthFactor = 0.5;

/// In the reference configuration, points are searched this many times deeper.
constexpr double kRestReach = 2.0;

/// Motion for which candidates are noted, as a fraction of the element size.
constexpr double kNotedMotion = 0.5;
constexpr double kRounding = 1e-9;

/// Patches are not measured again while they are known to be this far from bones, as a fraction of
/// the element size.
constexpr double kRemeasured = 0.25;

/// Rounds of moved_with_bones(): each round moves neighbors of the patches that the round before it
/// moved.
constexpr int kMaxCarryRounds = 20;

Mat3 positive_part(const Mat3& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

WeightedContactTerm::WeightedContactTerm(std::span<const Vec3> nodes_L,
                                         std::vector<mesh::Face> faces,
                                         std::vector<RigidObstacle> bones, const Options& options)
    : obstacles_(std::move(bones)),
      options_(options),
      patches_(nodes_L, faces),
      rest_gaps_mm_(patches_.point_count(), 0.0),
      faces_(std::move(faces)) {
  LEFORT_CHECK(!obstacles_.empty() && options_.stiffness_mpa_per_mm > 0.0);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    double weight_mm2 = 0.0, shape_bound = 1.0;
    for (const PatchFace& part : patches_[p].faces) {
      const auto points = weighted_quadrature(part.shape);
      std::array<Vec3, kMaxFacePoints> p_L;
      const auto count = std::size_t(mesh::node_count(part.shape));
      shape_bound =
          std::max(shape_bound, face_quadrature(std::size_t(part.shape)).displacement_bound);
      for (std::size_t q = 0; q < points.size(); ++q) {
        p_L[q].setZero();
        for (std::size_t b = 0; b < count; ++b)
          p_L[q] += points[q].at.N[b] * nodes_L[std::size_t(patches_[p].nodes[part.local[b]])];
        weight_mm2 += patches_.area_mm2(part.first_point + q) * std::abs(points[q].M[part.center]);
      }
      const ClosestGaps at(obstacles_, std::span(p_L).first(points.size()), Derivatives::kFirst);
      for (std::size_t q = 0; q < points.size(); ++q)
        rest_gaps_mm_[part.first_point + q] =
            rest_gap_mm(at.gaps[q], gap_to_bone(obstacles_[at.obstacle[q]], p_L[q], at.gaps[q]),
                        options_.contact_snap_mm);
    }
    gap_bounds_.push_back(kMaxGapSlope * shape_bound * weight_mm2 / patches_[p].area_mm2);
  }
  rest_offsets_mm_.assign(patches_.size(), 0.0);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    PatchGap gap;
    if (measure(patches_[p], positions(patches_[p], nodes_L), nullptr, gap))
      rest_offsets_mm_[p] = std::min(gap.gap_mm, 0.0);
  }
  for (const DenseFace& face : dense_faces(faces_, nodes_L)) {
    face_areas_mm2_.push_back(face.area_mm2);
    for (const DensePoint& point : face.points) {
      const auto [gap, bone] = closest_gap(obstacles_, point.x_L);
      const Gap to_bone = gap_to_bone(obstacles_[bone], point.x_L, gap);
      dense_rest_gaps_mm_.push_back(rest_gap_mm(gap, to_bone, options_.contact_snap_mm));
      dense_bone_rest_gaps_mm_.push_back(bone_rest_gap_mm(to_bone, options_.contact_snap_mm));
    }
  }
  find_bone_points(nodes_L);
}

void WeightedContactTerm::find_bone_points(std::span<const Vec3> nodes_L) {
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    double radius_mm = 0.0;
    for (const std::int32_t n : patches_[p].nodes)
      radius_mm = std::max(
          radius_mm, (nodes_L[std::size_t(n)] - nodes_L[std::size_t(patches_[p].node())]).norm());
    max_depth_mm_.push_back(kMaxDepthFactor * radius_mm);
    element_size_mm_ += radius_mm / double(patches_.size());
  }
  for (const RigidObstacle& obstacle : obstacles_) {
    PointsWithRest &sharp = sharp_points_.emplace_back(), &all = vertices_.emplace_back();
    const geometry::TriangleMesh* surface_B = obstacle.distance_query_B->surface_B();
    if (surface_B == nullptr) continue;
    if (options_.has_sharp_points)
      sharp.points = sharp_points(*surface_B, *obstacle.distance_query_B, element_size_mm_);
    all.points = BonePoints(vertices_of(*surface_B), element_size_mm_);
  }
  find_rest_depths(sharp_points_, nodes_L);
  find_rest_depths(vertices_, nodes_L);
}

void WeightedContactTerm::find_rest_depths(std::vector<PointsWithRest>& points,
                                           std::span<const Vec3> nodes_L) const {
  std::vector<std::vector<double>> at_rest;
  for (PointsWithRest& of_bone : points) {
    of_bone.rest_depths_mm.assign(of_bone.points.size(), 0.0);
    at_rest.push_back(of_bone.rest_depths_mm);
  }
  for (std::size_t p = 0; p < patches_.size(); ++p)
    for_each_point_behind(
        points, p, positions(patches_[p], nodes_L), false,
        [&](std::size_t bone, std::size_t v, const PointDepth& depth) {
          at_rest[bone][v] =
              std::max(at_rest[bone][v], depth.depth_mm < max_depth_mm_[p]
                                             ? depth.depth_mm
                                             : std::numeric_limits<double>::infinity());
        },
        kRestReach);
  for (std::size_t bone = 0; bone < points.size(); ++bone)
    points[bone].rest_depths_mm = std::move(at_rest[bone]);
}

void WeightedContactTerm::add_sharp_points(std::size_t patch, std::span<const Vec3> x_L,
                                           fem::LocalEquations& local) const {
  const bool is_exact = local.tangent == fem::Tangent::kExact;
  for_each_point_behind(
      sharp_points_, patch, x_L, local.wants_stiffness(),
      [&](std::size_t bone, std::size_t v, const PointDepth& at) {
        const double increase_mm = at.depth_mm - sharp_points_[bone].rest_depths_mm[v];
        const double full_n_per_mm =
            2.0 * options_.stiffness_mpa_per_mm * point_area_mm2() * at.weight;
        const double stiffness_n_per_mm = at.fade * full_n_per_mm;
        ++local.contacts;
        local.deepest_mm = std::max(local.deepest_mm, increase_mm);
        local.energy_mj += 0.5 * stiffness_n_per_mm * increase_mm * increase_mm;
        const PatchFace& part = patches_[patch].faces[at.face];
        const auto count = std::size_t(mesh::node_count(part.shape));
        for (std::size_t c = 0; c < at.corners; ++c)
          for (std::size_t b = 0; b < count; ++b)
            local.residual_n.segment<3>(3 * Index(part.local[b])) +=
                increase_mm * at.N[c][b] *
                (stiffness_n_per_mm * at.gradient_L[c] +
                 0.5 * full_n_per_mm * increase_mm * at.fade_gradient_L[c]);
        if (!local.wants_stiffness()) return;
        for (std::size_t c = 0; c < at.corners; ++c)
          for (std::size_t d = 0; d < at.corners; ++d) {
            const Index row = 3 * Index(c), col = 3 * Index(d);
            const Mat3 curvature =
                is_exact ? Mat3(increase_mm * at.hessian_L.block<3, 3>(row, col))
                         : Mat3(increase_mm / at.depth_mm * at.positive_L.block<3, 3>(row, col));
            Mat3 K =
                stiffness_n_per_mm * (at.gradient_L[c] * at.gradient_L[d].transpose() + curvature);
            if (is_exact)  // But for the second derivatives of the fade, of order d^2.
              K += full_n_per_mm * increase_mm *
                   (at.gradient_L[c] * at.fade_gradient_L[d].transpose() +
                    at.fade_gradient_L[c] * at.gradient_L[d].transpose());
            for (std::size_t a = 0; a < count; ++a)
              for (std::size_t b = 0; b < count; ++b)
                if (at.N[c][a] != 0.0 && at.N[d][b] != 0.0)
                  local.stiffness_n_per_mm.block<3, 3>(3 * Index(part.local[a]),
                                                       3 * Index(part.local[b])) +=
                      at.N[c][a] * at.N[d][b] * K;
          }
      });
}

bool WeightedContactTerm::is_conservative(const fem::DofMap& /*dofs*/) const {
  return std::all_of(obstacles_.begin(), obstacles_.end(), [](const RigidObstacle& obstacle) {
    return obstacle.distance_query_B->has_exact_derivatives();
  });
}

bool WeightedContactTerm::measure(const NodePatch& patch, std::span<const Vec3> x_L,
                                  fem::LocalEquations* local, PatchGap& gap) const {
  const bool wants_hessian = local != nullptr && local->wants_stiffness();
  gap.gradient_mm2.setZero(3 * Index(x_L.size()));
  double volume_mm3 = 0.0;
  for (const PatchFace& part : patch.faces) {
    const auto points = weighted_quadrature(part.shape);
    const auto count = std::size_t(mesh::node_count(part.shape));
    std::array<Vec3, kMaxFacePoints> p_L;
    for (std::size_t q = 0; q < points.size(); ++q) {
      p_L[q].setZero();
      for (std::size_t b = 0; b < count; ++b) p_L[q] += points[q].at.N[b] * x_L[part.local[b]];
    }
    const ClosestGaps at(obstacles_, std::span(p_L).first(points.size()),
                         wants_hessian ? Derivatives::kSecond : Derivatives::kFirst);
    for (std::size_t q = 0; q < points.size(); ++q) {
      const Gap& of = at.gaps[q];
      if (of.zone == field::Zone::kInside || !p_L[q].allFinite()) return false;
      const double weight_mm2 = patches_.area_mm2(part.first_point + q) * points[q].M[part.center];
      if (weight_mm2 == 0.0) continue;
      volume_mm3 += weight_mm2 * (of.gap_mm - rest_gaps_mm_[part.first_point + q]);
      if (of.zone != field::Zone::kBand) continue;
      for (std::size_t b = 0; b < count; ++b)
        gap.gradient_mm2.segment<3>(3 * Index(part.local[b])) +=
            weight_mm2 * points[q].at.N[b] * of.gradient_L;
      if (!wants_hessian) continue;
      const Mat3 minus_H = -weight_mm2 * of.hessian_L;
      const Mat3 H = local->tangent == fem::Tangent::kExact ? minus_H : positive_part(minus_H);
      for (std::size_t b = 0; b < count; ++b)
        for (std::size_t c = 0; c < count; ++c)
          local->stiffness_n_per_mm.block<3, 3>(3 * Index(part.local[b]),
                                                3 * Index(part.local[c])) +=
              points[q].at.N[b] * points[q].at.N[c] * H;
    }
  }
  gap.gap_mm = volume_mm3 / patch.area_mm2 - rest_offsets_mm_[std::size_t(&patch - &patches_[0])];
  return true;
}

bool WeightedContactTerm::evaluate(Index item, std::span<const Vec3> x_L,
                                   fem::LocalEquations& local) const {
  const NodePatch& patch = patches_[std::size_t(item)];
  if (is_clear(std::size_t(item), x_L)) {
    add_sharp_points(std::size_t(item), x_L, local);
    return true;
  }
  PatchGap gap;
  if (!measure(patch, x_L, &local, gap)) return false;
  const double k = options_.stiffness_mpa_per_mm, depth_mm = -gap.gap_mm;
  const bool is_active = active_.empty() ? depth_mm > 0.0 : active_[std::size_t(item)] > 0.0;
  if (!is_active) {
    if (local.wants_stiffness()) local.stiffness_n_per_mm.setZero();
    add_sharp_points(std::size_t(item), x_L, local);
    return true;
  }
  ++local.contacts;
  local.deepest_mm = depth_mm;
  const double p_mpa = 2.0 * k * depth_mm;
  local.energy_mj = patch.area_mm2 * k * depth_mm * depth_mm;
  local.residual_n = -p_mpa * gap.gradient_mm2;
  if (local.wants_stiffness()) {
    local.stiffness_n_per_mm *= active_.empty() ? p_mpa : active_[std::size_t(item)];
    for (Index c = 0; c < gap.gradient_mm2.size(); ++c)
      local.stiffness_n_per_mm.col(c) +=
          (2.0 * k / patch.area_mm2 * gap.gradient_mm2[c]) * gap.gradient_mm2;
  }
  add_sharp_points(std::size_t(item), x_L, local);
  return true;
}

bool same_active_patches(const ActiveSet& a, const ActiveSet& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double p, double q) { return (p > 0.0) == (q > 0.0); });
}

ActiveSet WeightedContactTerm::active_set(std::span<const Vec3> x_L) const {
  ActiveSet active(patches_.size(), 0.0);
  parallel_for(Index(patches_.size()), [&](Index p) {
    const NodePatch& patch = patches_[std::size_t(p)];
    const std::vector<Vec3> x = positions(patch, x_L);
    if (min_gap_mm(std::size_t(p), x) > 0.0) return;
    PatchGap gap;
    if (measure(patch, x, nullptr, gap))
      active[std::size_t(p)] = std::max(-2.0 * options_.stiffness_mpa_per_mm * gap.gap_mm, 0.0);
  });
  return active;
}

ActiveSet WeightedContactTerm::updated_active_set(const ActiveSet& active,
                                                  std::span<const Vec3> from_L,
                                                  std::span<const Vec3> to_L, double length) const {
  ActiveSet updated(active.size(), 0.0);
  parallel_for(Index(patches_.size()), [&](Index p) {
    const NodePatch& patch = patches_[std::size_t(p)];
    const bool was_active = active[std::size_t(p)] > 0.0;
    const std::vector<Vec3> from = positions(patch, from_L), to = positions(patch, to_L);
    PatchGap gap;
    if (!was_active && min_gap_mm(std::size_t(p), to) > 0.0) return;
    if (!measure(patch, was_active ? from : to, nullptr, gap)) return;
    double gap_mm = gap.gap_mm;
    for (std::size_t b = 0; was_active && b < from.size(); ++b)
      gap_mm += gap.gradient_mm2.segment<3>(3 * Index(b)).dot(to[b] - from[b]) /
                (length * patch.area_mm2);
    // The pressure of a node that comes into contact is not known yet.
    if (gap_mm < 0.0)
      updated[std::size_t(p)] = was_active ? -2.0 * options_.stiffness_mpa_per_mm * gap_mm
                                           : std::numeric_limits<double>::min();
  });
  return updated;
}

std::vector<Vec3> WeightedContactTerm::own_points(const NodePatch& patch,
                                                  std::span<const Vec3> x_L) const {
  std::vector<Vec3> points_L{x_L[std::size_t(patch.node())]};
  for (const PatchFace& part : patch.faces) {
    if (part.center != 0) continue;
    const auto count = std::size_t(mesh::node_count(part.shape));
    for (const WeightedPoint& point : weighted_quadrature(part.shape)) {
      Vec3& p_L = points_L.emplace_back(Vec3::Zero());
      for (std::size_t b = 0; b < count; ++b)
        p_L += point.at.N[b] * x_L[std::size_t(patch.nodes[part.local[b]])];
    }
  }
  return points_L;
}

double WeightedContactTerm::max_step_length(std::span<const Vec3> x_L,
                                            std::span<const Vec3> dx_L) const {
  std::vector<double> allowed(patches_.size(), 1.0);
  parallel_for(Index(patches_.size()), [&](Index p) {
    const std::vector<Vec3> from_L = own_points(patches_[std::size_t(p)], x_L);
    const std::vector<Vec3> step_L = own_points(patches_[std::size_t(p)], dx_L);
    for (const RigidObstacle& obstacle : obstacles_)
      for (std::size_t n = 0; n < from_L.size(); ++n)
        allowed[std::size_t(p)] =
            std::min(allowed[std::size_t(p)], allowed_fraction(obstacle, from_L[n], step_L[n]));
  });
  return *std::min_element(allowed.begin(), allowed.end());
}

std::vector<WeightedContactTerm::Passage> WeightedContactTerm::passages(
    std::span<const Vec3> from_L, std::span<const RigidTransform> from_X_LB,
    std::span<const Vec3> to_L) const {
  std::vector<Passage> first(patches_.size());
  parallel_for(Index(patches_.size()), [&](Index p) {
    const std::vector<Vec3> first_L = own_points(patches_[std::size_t(p)], from_L);
    const std::vector<Vec3> last_L = own_points(patches_[std::size_t(p)], to_L);
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
      const RigidObstacle in_B{.distance_query_B = obstacles_[k].distance_query_B};
      const RigidTransform X_BL_from = from_X_LB[k].inverse(), X_BL = obstacles_[k].X_LB.inverse();
      for (std::size_t n = 0; n < first_L.size(); ++n) {
        const Vec3 first_B = X_BL_from * first_L[n];
        const double fraction = allowed_fraction(in_B, first_B, X_BL * last_L[n] - first_B);
        if (fraction < first[std::size_t(p)].fraction) first[std::size_t(p)] = {fraction, k};
      }
    }
  });
  return first;
}

double WeightedContactTerm::max_motion(std::span<const Vec3> from_L,
                                       std::span<const RigidTransform> from_X_LB,
                                       std::span<const Vec3> to_L) const {
  double fraction = 1.0;
  for (const Passage& at : passages(from_L, from_X_LB, to_L))
    fraction = std::min(fraction, at.fraction);
  return fraction;
}

std::vector<Vec3> WeightedContactTerm::moved_with_bones(std::span<const Vec3> from_L,
                                                        std::span<const RigidTransform> from_X_LB,
                                                        std::vector<Vec3> to_L) const {
  for (int round = 0; round < kMaxCarryRounds; ++round) {
    const std::vector<Passage> at = passages(from_L, from_X_LB, to_L);
    bool is_allowed = true;
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      if (at[p].fraction == 1.0) continue;
      is_allowed = false;
      const std::size_t k = at[p].bone;
      for (const std::int32_t n : patches_[p].nodes)
        to_L[std::size_t(n)] =
            obstacles_[k].X_LB * (from_X_LB[k].inverse() * from_L[std::size_t(n)]);
    }
    if (is_allowed) break;
  }
  return to_L;
}

std::string WeightedContactTerm::inadmissible_cause() const {
  return "tissue lies deeper in a bone than the band of its distance field (field.band_mm)";
}

void WeightedContactTerm::note_clearances(std::span<const Vec3> x_L) {
  Clearances now{.x_L = {x_L.begin(), x_L.end()}, .X_LB = {}, .gaps_mm = {}, .points = {}};
  for (const RigidObstacle& obstacle : obstacles_) now.X_LB.push_back(obstacle.X_LB);
  now.gaps_mm.assign(patches_.size(), 0.0);
  parallel_for(Index(patches_.size()), [&](Index p) {
    const std::vector<Vec3> x = positions(patches_[std::size_t(p)], x_L);
    now.gaps_mm[std::size_t(p)] = min_gap_mm(std::size_t(p), x);
    if (now.gaps_mm[std::size_t(p)] > kRemeasured * gap_bounds_[std::size_t(p)] * element_size_mm_)
      return;
    PatchGap gap;
    now.gaps_mm[std::size_t(p)] =
        measure(patches_[std::size_t(p)], x, nullptr, gap) ? gap.gap_mm : 0.0;
  });
  std::vector<const BonePoints*> points;
  for (const PointsWithRest& of_bone : sharp_points_) points.push_back(&of_bone.points);
  now.points = PointCandidates(patches_, faces_, points, obstacles_, x_L,
                               *std::max_element(max_depth_mm_.begin(), max_depth_mm_.end()) +
                                   kNotedMotion * element_size_mm_);
  clearances_ = std::move(now);
}

double WeightedContactTerm::moved_since_note_mm(std::size_t bone, std::size_t patch,
                                                std::span<const Vec3> x_L) const {
  if (clearances_.x_L.empty()) return std::numeric_limits<double>::infinity();
  const RigidTransform moved = obstacles_[bone].X_LB * clearances_.X_LB[bone].inverse();
  double squared_mm2 = 0.0;
  for (std::size_t b = 0; b < x_L.size(); ++b) {
    const Vec3& noted_L = clearances_.x_L[std::size_t(patches_[patch].nodes[b])];
    const double of_node_mm2 = (x_L[b] - moved * noted_L).squaredNorm();
    if (!std::isfinite(of_node_mm2)) return std::numeric_limits<double>::infinity();
    squared_mm2 = std::max(squared_mm2, of_node_mm2);
  }
  return (1.0 + kRounding) * std::sqrt(squared_mm2) + kRounding;
}

double WeightedContactTerm::min_gap_mm(std::size_t patch, std::span<const Vec3> x_L) const {
  if (clearances_.gaps_mm.empty()) return -std::numeric_limits<double>::infinity();
  double moved_mm = 0.0;
  for (std::size_t k = 0; k < obstacles_.size(); ++k)
    moved_mm = std::max(moved_mm, moved_since_note_mm(k, patch, x_L));
  return clearances_.gaps_mm[patch] - gap_bounds_[patch] * moved_mm;
}

bool WeightedContactTerm::is_clear(std::size_t patch, std::span<const Vec3> x_L) const {
  if (!active_.empty() && active_[patch] > 0.0) return false;
  return min_gap_mm(patch, x_L) > 0.0;
}

double WeightedContactTerm::rest_penetration_mm() const {
  double max_mm = 0.0;
  for (const double gap_mm : rest_gaps_mm_) max_mm = std::max(max_mm, -gap_mm);
  return max_mm;
}

}  // namespace lefort::contact
