/// \file
/// Statistics of contact at one state: sums over all points, values at nodes, single points.
///
/// Two depths occur (docs/glossary.md): the penetration max(-g, 0), and the penetration increase
/// d = g_0 - g, on which the contact pressure depends.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace lefort::contact {

/// Contact of one bone, or of several, at one state.
struct ContactStatistics {
  Index points = 0;       ///< Quadrature points (weighted gaps: dense samples) in contact.
  Index nodes = 0;        ///< Nodes of faces with such a point.
  double area_mm2 = 0.0;  ///< Of the reference surface in contact.
  // Depths are over dense samples of the faces in contact (dense_faces.h).
  double sampled_area_mm2 = 0.0;  ///< Of the reference surface that these samples stand for.
  double max_penetration_mm = 0.0;
  double mean_penetration_mm = 0.0;
  double max_penetration_increase_mm = 0.0;
  double mean_penetration_increase_mm = 0.0;
  /// Penetration increase that 99 % of the area of these samples does not exceed; >= 0.
  double p99_penetration_increase_mm = 0.0;
  /// The same with the gap to the bone itself, where the obstacle replaces it (rest_gap.h).
  double max_bone_penetration_increase_mm = 0.0;
  double p99_bone_penetration_increase_mm = 0.0;
  Vec3 force_L_n = Vec3::Zero();  ///< On the tissue [N].
  double normal_force_n = 0.0;    ///< Sum of the magnitudes of the forces of the points [N].
};

/// Statistics of two bones together: sums of counts, areas and forces, maxima of depths, means
/// over both sampled areas. Tissue in contact with both counts twice. The P99 is the larger one,
/// which is not less than that of the whole area.
[[nodiscard]] ContactStatistics combine(const ContactStatistics& a, const ContactStatistics& b);

/// Largest penetration increase that is accepted at the end of a path.
struct PenetrationLimits {
  double p99_mm = 0.1;
  double max_mm = 0.3;
};

/// \returns whether neither the P99 nor the maximum exceeds its limit.
[[nodiscard]] inline bool is_within(const PenetrationLimits& limits,
                                    const ContactStatistics& contact) {
  return contact.p99_penetration_increase_mm <= limits.p99_mm &&
         contact.max_penetration_increase_mm <= limits.max_mm;
}

/// Contact at one node of the faces.
struct NodalContact {
  std::int32_t node = 0;
  double pressure_mpa = 0.0;  ///< Mean of the points around it, weighted by A_n |N_a|.
  double gap_mm = 0.0;        ///< Of the node, as Gap::gap_mm; NaN where the zone is unknown.
  double depth_mm = 0.0;      ///< Largest penetration increase of the points around it; >= 0.
};

/// One quadrature point in contact.
struct ContactPoint {
  Vec3 x_L = Vec3::Zero();      ///< Current position [mm].
  double pressure_mpa = 0.0;    ///< > 0.
  Vec3 force_n = Vec3::Zero();  ///< On the tissue.
};

/// A quadrature point, in contact or not, as the statistics need it.
struct PointContact {
  double area_mm2 = 0.0;           ///< A_n.
  double pressure_mpa = 0.0;       ///< p; 0 without contact.
  Vec3 gradient_L = Vec3::Zero();  ///< Of the gap.
  double depth_mm = 0.0;           ///< d.
};

/// A dense sample of a face in contact.
struct DepthSample {
  double area_mm2 = 0.0;       ///< Of the reference surface that it stands for.
  double gap_mm = 0.0;         ///< g.
  double depth_mm = 0.0;       ///< d.
  double bone_depth_mm = 0.0;  ///< The same to the bone itself.
};

/// Adds up ContactStatistics point by point.
class ContactStatisticsSum {
 public:
  /// \param nodes  of the patch of the point.
  void add(const PointContact& point, std::span<const std::int32_t> nodes);
  void add(const DepthSample& sample);

  /// \returns the statistics of all points and samples that were added.
  [[nodiscard]] ContactStatistics finish() &&;

 private:
  ContactStatistics sum_;
  std::vector<std::int32_t> nodes_;
  std::vector<std::pair<double, double>> depth_and_area_, bone_depth_and_area_;
};

/// Averages NodalContact point by point. The pressure is not evaluated at the node itself: the flat
/// faces around a convex bone touch the bone in their middle only.
class NodalContactSum {
 public:
  /// \param nodes  of the patch of the point.
  /// \param N      shape functions of these nodes at the point.
  void add(const PointContact& point, std::span<const std::int32_t> nodes,
           std::span<const double> N);

  /// \param x_L  current positions of all nodes [mm].
  /// \returns one entry per node of the patches that were added, ascending.
  [[nodiscard]] std::vector<NodalContact> finish(const RigidObstacle& obstacle,
                                                 std::span<const Vec3> x_L) &&;

 private:
  struct Node {
    NodalContact contact;
    double area_mm2 = 0.0;
  };
  std::map<std::int32_t, Node> nodes_;
};

}  // namespace lefort::contact
