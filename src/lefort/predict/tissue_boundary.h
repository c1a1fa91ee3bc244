/// \file
/// Says which part of the tissue's surface is held, touched by the moved bone, or free.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/boundary_labels.h>
#include <lefort/predict/prediction_options.h>
#include <lefort/predict/tissue_domain.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lefort::predict {

/// Names of the node sets and face sets that find_tissue_boundary() makes.
namespace sets {
inline constexpr const char* kMobilizedSegment = "moved_bone";  ///< On the segment.
inline constexpr const char* kStationaryBone = "still_bone";    ///< On bone that stays.
inline constexpr const char* kCut = "cut";                      ///< Where the region was cut out.
inline constexpr const char* kScanBoundary = "scan_edge";       ///< Where the scan ends.
inline constexpr const char* kBrain = "brain";                  ///< Towards the cranial cavity.
inline constexpr const char* kSkin = "skin";
inline constexpr const char* kFree = "free";        ///< Airway and the rest.
inline constexpr const char* kFixed = "fixed";      ///< Nodes that do not move.
inline constexpr const char* kContact = "contact";  ///< Faces that may meet the segment.
/// Faces that slide on still bone. Not there unless something is painted so.
inline constexpr const char* kStationaryContact = "still_contact";
}  // namespace sets

/// Adds those sets to a mesh of the domain.
///
/// Fixed are the cut, the scan's edge if asked for, and tissue on still bone and on the brain, but
/// for what lies within options.elevation_margin_mm of the segment: there the surgeon has elevated
/// it.
///
/// \param labels       the scan's labels: where the brain is.
/// \param skin_L       the skin's surface. Its level would not do: levels end near their zero, and
///   deep inside look no further than the skin's neighborhood.
/// \param segment_L, remainder_L  the bones; several segments as one mesh (plan::append).
/// \param painted      if there is one, decides which nodes are fixed where it says anything; each
///   of its labels gets a set of those nodes (kBoundaryLabelStyles). The other sets tell where a
///   node lies, whatever is painted there.
[[nodiscard]] mesh::VolumeMesh find_tissue_boundary(
    mesh::VolumeMesh tissue, const TissueDomain& domain, const anatomy::LabelMap& labels,
    const geometry::TriangleMesh& skin_L, const geometry::TriangleMesh& segment_L,
    const geometry::TriangleMesh& remainder_L, const BoundaryOptions& options,
    const BoundaryLabelMap* painted = nullptr);

/// Nodes of a mesh with those sets that lie on the segment and are not fixed. Ascending.
[[nodiscard]] std::vector<std::int32_t> nodes_on_segment(const mesh::VolumeMesh& tissue);

/// Nodes that move with the segment: those painted so, and where `segment_interface` says so all on
/// it that are not painted otherwise. Ascending.
[[nodiscard]] std::vector<std::int32_t> nodes_with_segment(const mesh::VolumeMesh& tissue,
                                                           SegmentInterface segment_interface);

/// What became of the boundary's nodes that one rule decided.
struct BoundaryRuleStatistics {
  std::string set;                  ///< Of the nodes that the rule takes.
  std::optional<double> within_mm;  ///< Nodes nearer than this are taken; without, all the rest.
  Index fixed = 0;
  Index with_segment = 0;
  Index free = 0;     ///< The segment may push them.
  Index painted = 0;  ///< Taken by the rule, but decided by a label.
  /// Of the tissue's boundary, each face shared equally by its corners.
  struct Areas {
    double fixed_mm2 = 0.0, with_segment_mm2 = 0.0, free_mm2 = 0.0, painted_mm2 = 0.0;
  } areas;
};

/// A set, and how near a node must be to belong to it; without a distance all the rest do.
struct RuleDistance {
  const char* set;
  std::optional<double> within_mm;
};

/// The rules in the order in which they are asked.
[[nodiscard]] std::vector<RuleDistance> boundary_rules(const BoundaryOptions& options);

/// For each rule in the order in which they are asked.
[[nodiscard]] std::vector<BoundaryRuleStatistics> boundary_rule_statistics(
    const mesh::VolumeMesh& tissue, const BoundaryOptions& options);

/// What one label decided.
struct BoundaryLabelStatistics {
  BoundaryLabelStyle label;
  Index nodes = 0;
  double area_mm2 = 0.0;  ///< Of the tissue's boundary, each face shared equally by its corners.
};

/// For each of kBoundaryLabelStyles; nothing if the mesh was not painted.
[[nodiscard]] std::vector<BoundaryLabelStatistics> boundary_label_statistics(
    const mesh::VolumeMesh& tissue);

/// Nodes that any label decided. Ascending.
[[nodiscard]] std::vector<std::int32_t> all_painted_nodes(const mesh::VolumeMesh& tissue);

/// All that as one sentence.
[[nodiscard]] std::string describe_boundary(const mesh::VolumeMesh& tissue,
                                            const BoundaryOptions& options);

}  // namespace lefort::predict
