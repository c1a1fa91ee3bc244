/// \file
/// Statistics of contact at one state: sums over all points, values at nodes, single points.
///
/// Two depths occur (docs/glossary.md): the penetration max(-g, 0), and the penetration increase
/// d = g_0 - g, on which the contact pressure depends. Where a tangent plane is the constraint, g
/// is the smaller of the gap to the plane and the gap to the closest surface.
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
  double max_penetration_mm = 0.0;            ///< Over that area.
  double mean_penetration_mm = 0.0;           ///< Over that area.
  double max_penetration_increase_mm = 0.0;   ///< Over that area.
  double mean_penetration_increase_mm = 0.0;  ///< Over that area.
  /// Penetration increase that 99 % of that area does not exceed; >= 0.
  double p99_penetration_increase_mm = 0.0;
  /// The same with the gap to the bone itself, where the obstacle replaces it (rest_gap.h).
  double max_bone_penetration_increase_mm = 0.0;
  double p99_bone_penetration_increase_mm = 0.0;
  Vec3 force_L_n = Vec3::Zero();  ///< On the tissue [N].
  double normal_force_n = 0.0;    ///< Sum of the magnitudes of the forces of the points [N].
  /// Cumulative reference area of points that tunneled through thin bone without a tangent plane
  /// [mm^2]. A point counts once per event.
  double tunneled_area_mm2 = 0.0;
};

/// Statistics of two bones together: sums of counts, areas and forces, maxima of depths, means
/// over both areas. Tissue in contact with both counts twice. The P99 is the larger of the two,
/// which is not less than that of the whole area.
[[nodiscard]] ContactStatistics combine(const ContactStatistics& a, const ContactStatistics& b);

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
  Vec3 gradient_L = Vec3::Zero();  ///< Of the gap that the force acts on.
  double gap_mm = 0.0;             ///< g.
  double depth_mm = 0.0;           ///< d.
  double bone_depth_mm = 0.0;      ///< The same to the bone itself.
};

/// Adds up ContactStatistics point by point.
class ContactStatisticsSum {
 public:
  /// \param nodes  of the patch of the point.
  void add(const PointContact& point, std::span<const std::int32_t> nodes);

  /// \param tunneled_area_mm2  of all increments so far.
  /// \returns the statistics of all points that were added.
  [[nodiscard]] ContactStatistics finish(double tunneled_area_mm2) &&;

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
