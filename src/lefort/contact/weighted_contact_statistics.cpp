#include <lefort/contact/dense_faces.h>
#include <lefort/contact/rest_gap.h>
#include <lefort/contact/weighted_contact_points.h>
#include <lefort/contact/weighted_contact_term.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lefort::contact {

/// Adds dense samples of the faces around active nodes. A sample counts with the hat functions of
/// these nodes there, so that a face between an active and a free node counts in part, and no area
/// twice.
void WeightedContactTerm::add_faces(std::span<const Vec3> x_L,
                                    std::vector<ContactStatisticsSum>& sums) const {
  const ActiveSet active = active_set(x_L);
  std::vector<double> pressures_mpa(x_L.size(), 0.0);
  for (std::size_t p = 0; p < patches_.size(); ++p)
    pressures_mpa[std::size_t(patches_[p].node())] = active[p];
  std::size_t sample = 0, number = 0;
  for (const DenseFace& face : dense_faces(faces_, x_L)) {
    const auto nodes = mesh::nodes_of(*face.face);
    const double area_mm2 = face_areas_mm2_[number++] / double(face.points.size());
    for (const DensePoint& point : face.points) {
      const double rest_gap_mm = dense_rest_gaps_mm_[sample],
                   bone_rest_gap_mm = dense_bone_rest_gaps_mm_[sample];
      ++sample;
      double fraction = 0.0, p_mpa = 0.0;
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const double p_a_mpa = pressures_mpa[std::size_t(nodes[a])];
        if (!(p_a_mpa > 0.0)) continue;
        fraction += point.hat[a];
        p_mpa += point.hat[a] * p_a_mpa;
      }
      if (!(p_mpa > 0.0)) continue;
      const auto [gap, bone] = closest_gap(obstacles_, point.x_L);
      const double depth_mm = std::max(rest_gap_mm - gap.gap_mm, 0.0);
      sums[bone].add({.area_mm2 = fraction * area_mm2,
                      .pressure_mpa = p_mpa,
                      .gradient_L = gap.gradient_L,
                      .depth_mm = depth_mm},
                     nodes);
      sums[bone].add(
          {.area_mm2 = fraction * area_mm2,
           .gap_mm = gap.gap_mm,
           .depth_mm = depth_mm,
           .bone_depth_mm = bone_depth_mm(obstacles_[bone], point.x_L, gap, bone_rest_gap_mm)});
    }
  }
}

std::vector<ContactStatistics> WeightedContactTerm::summarize(std::span<const Vec3> x_L) const {
  std::vector<ContactStatisticsSum> sums(obstacles_.size());
  add_faces(x_L, sums);
  std::vector<ContactStatistics> all;
  for (ContactStatisticsSum& sum : sums) {
    all.push_back(std::move(sum).finish());
    all.back().force_L_n.setZero();
    all.back().normal_force_n = 0.0;
  }
  const auto add_force = [](ContactStatistics& one, const Vec3& force_n) {
    one.force_L_n += force_n;
    one.normal_force_n += force_n.norm();
  };
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const std::vector<Vec3> x = positions(patches_[p], x_L);
    for_each_point_behind(
        sharp_points_, p, x, false, [&](std::size_t bone, std::size_t v, const PointDepth& at) {
          const double increase_mm = at.depth_mm - sharp_points_[bone].rest_depths_mm[v];
          Vec3 force_n = Vec3::Zero();
          for (std::size_t c = 0; c < at.corners; ++c)
            force_n -= 2.0 * options_.stiffness_mpa_per_mm * point_area_mm2() * at.weight *
                       increase_mm *
                       (at.fade * at.gradient_L[c] + 0.5 * increase_mm * at.fade_gradient_L[c]);
          add_force(all[bone], force_n);
        });
    for (const auto* points : {&sharp_points_, &vertices_})
      for_each_point_behind(
          *points, p, x, false, [&](std::size_t bone, std::size_t v, const PointDepth& at) {
            ContactStatistics& one = all[bone];
            one.max_penetration_mm = std::max(one.max_penetration_mm, at.depth_mm);
            one.max_penetration_increase_mm = std::max(
                one.max_penetration_increase_mm, at.depth_mm - (*points)[bone].rest_depths_mm[v]);
          });
    PatchGap gap;
    if (!measure(patches_[p], x, nullptr, gap) || gap.gap_mm >= 0.0) continue;
    const double p_mpa = -2.0 * options_.stiffness_mpa_per_mm * gap.gap_mm;
    Vec3 force_n = Vec3::Zero();
    for (Index b = 0; b < Index(x.size()); ++b)
      force_n += p_mpa * gap.gradient_mm2.segment<3>(3 * b);
    add_force(all[closest_gap(obstacles_, x_L[std::size_t(patches_[p].node())]).second], force_n);
  }
  return all;
}

std::vector<std::vector<NodalContact>> WeightedContactTerm::at_nodes_by_bone(
    std::span<const Vec3> x_L) const {
  std::vector<std::vector<NodalContact>> all(obstacles_.size());
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const std::vector<Vec3> x = positions(patches_[p], x_L);
    PatchGap gap;
    const bool is_known = measure(patches_[p], x, nullptr, gap);
    const double depth_mm = is_known ? std::max(-gap.gap_mm, 0.0) : 0.0;
    const Vec3& x_node = x_L[std::size_t(patches_[p].node())];
    std::vector<Gap> gaps;
    for (const RigidObstacle& obstacle : obstacles_)
      gaps.push_back(measure_gap(obstacle, x_node, Derivatives::kFirst));
    const auto closest = std::size_t(
        std::min_element(gaps.begin(), gaps.end(),
                         [](const Gap& a, const Gap& b) { return a.gap_mm < b.gap_mm; }) -
        gaps.begin());
    for (std::size_t bone = 0; bone < obstacles_.size(); ++bone)
      all[bone].push_back(
          {.node = patches_[p].node(),
           .pressure_mpa = bone == closest ? 2.0 * options_.stiffness_mpa_per_mm * depth_mm : 0.0,
           .gap_mm = gaps[bone].zone == field::Zone::kUnknown
                         ? std::numeric_limits<double>::quiet_NaN()
                         : gaps[bone].gap_mm,
           .depth_mm = bone == closest ? depth_mm : 0.0});
  }
  return all;
}

}  // namespace lefort::contact
