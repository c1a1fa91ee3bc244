/// \file
/// Finds the parts of the tissue boundary by anatomy, and their boundary conditions.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/boundary_labels.h>
#include <lefort/predict/interface_map.h>
#include <lefort/predict/prediction_options.h>
#include <lefort/predict/tissue_domain.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lefort::predict {

/// Names of the node sets and face sets that find_tissue_boundary() makes.
namespace sets {
inline constexpr const char* kMobilizedSegment = "mobilized_segment";  ///< On a segment.
inline constexpr const char* kStationaryBone = "stationary_bone";      ///< On stationary bone.
inline constexpr const char* kCut = "cut";                     ///< Where the meshed region ends.
inline constexpr const char* kScanBoundary = "scan_boundary";  ///< Where the scan ends.
inline constexpr const char* kBrain = "brain";                 ///< At the cranial cavity.
inline constexpr const char* kSkin = "skin";
inline constexpr const char* kFree = "free";      ///< Airway and the rest.
inline constexpr const char* kFixed = "fixed";    ///< Nodes that do not move.
inline constexpr const char* kBonded = "bonded";  ///< Nodes that move with a segment.
/// Faces that may touch a segment; with TissueInterface::kBonded only where this is painted.
inline constexpr const char* kContact = "contact";
/// Faces that may touch stationary bone: all of kContact (kClinical), otherwise those painted as
/// contact or elevated. Missing if there are none.
inline constexpr const char* kStationaryContact = "stationary_contact";
}  // namespace sets

/// A mesh with those sets, and the condition of each boundary node.
struct TissueBoundary {
  mesh::VolumeMesh tissue;
  InterfaceMap interface;
};

/// Adds those sets to a mesh of the domain and decides the conditions.
///
/// \param tissue   mesh of the domain.
/// \param domain   its planes are used.
/// \param labels   of the scan; brain and airway are used.
/// \param skin_L   skin surface. Its level-set function does not suffice, because it is known
///   only near its zero.
/// \param bones    segments and stationary bone at rest.
/// \param options  contact snap distance, interface and boundaries.
/// \param painted  may be null. Its labels override the rules; each label gets a set of its nodes
///   (kBoundaryLabelStyles). The sets of boundary_rules() do not depend on it.
[[nodiscard]] TissueBoundary find_tissue_boundary(
    mesh::VolumeMesh tissue, const TissueDomain& domain, const anatomy::LabelMap& labels,
    const geometry::TriangleMesh& skin_L, const InterfaceBones& bones,
    const BoundaryOptions& options, const BoundaryLabelMap* painted = nullptr);

/// Nodes on a segment that are not fixed, ascending. \pre `tissue` has the sets.
[[nodiscard]] std::vector<std::int32_t> nodes_on_segment(const mesh::VolumeMesh& tissue);

/// Nodes that move with a segment, ascending: the set sets::kBonded. A mesh without that set has
/// all nodes_on_segment() if `interface` is kBonded, else none.
[[nodiscard]] std::vector<std::int32_t> nodes_with_segment(const mesh::VolumeMesh& tissue,
                                                           TissueInterface interface);

/// \param tissue  with the sets of find_tissue_boundary().
/// \returns the min distance between nodes on a segment and nodes at the scan boundary [mm];
///   nothing if the scan does not end within the mesh, or no tissue lies on a segment.
[[nodiscard]] std::optional<double> distance_to_scan_boundary(const mesh::VolumeMesh& tissue);

/// Boundary nodes that one rule takes, by boundary condition.
struct BoundaryRuleStatistics {
  std::string set;                  ///< Name of the set of nodes that the rule takes.
  std::optional<double> within_mm;  ///< Max distance of these nodes; empty: all other nodes.
  Index fixed = 0;
  Index with_segment = 0;
  Index free = 0;     ///< Any other condition (interface_map.h).
  Index painted = 0;  ///< Taken by the rule, but decided by a label.
  /// Of the tissue boundary; each face counts in equal parts for its corners.
  struct Areas {
    double fixed_mm2 = 0.0, with_segment_mm2 = 0.0, free_mm2 = 0.0, painted_mm2 = 0.0;
  } areas;
};

/// A set and the distance within which nodes belong to it; without a distance, all other nodes.
struct RuleDistance {
  const char* set;
  std::optional<double> within_mm;
};

/// The rules in the order of evaluation: the first that applies to a node takes it.
[[nodiscard]] std::vector<RuleDistance> boundary_rules(const BoundaryOptions& options);

/// Statistics of each rule, in the order of boundary_rules().
[[nodiscard]] std::vector<BoundaryRuleStatistics> boundary_rule_statistics(
    const mesh::VolumeMesh& tissue, const BoundaryOptions& options);

/// Boundary nodes of one label.
struct BoundaryLabelStatistics {
  BoundaryLabelStyle label;
  Index nodes = 0;
  double area_mm2 = 0.0;  ///< As BoundaryRuleStatistics::Areas.
};

/// Statistics of each of kBoundaryLabelStyles; empty if the mesh was not painted.
[[nodiscard]] std::vector<BoundaryLabelStatistics> boundary_label_statistics(
    const mesh::VolumeMesh& tissue);

/// \param tissue  with the sets of find_tissue_boundary().
/// \returns whether tissue can slide on the segments: the interface is not kBonded, or nodes are
///   painted as kContact or kElevated.
[[nodiscard]] bool slides_on_segments(const mesh::VolumeMesh& tissue, TissueInterface interface);

/// Nodes of a label, ascending; none if nothing was painted.
[[nodiscard]] std::vector<std::int32_t> nodes_painted(const mesh::VolumeMesh& tissue,
                                                      BoundaryLabel label);

/// Nodes of all labels, ascending.
[[nodiscard]] std::vector<std::int32_t> all_painted_nodes(const mesh::VolumeMesh& tissue);

/// The statistics as one line of text.
[[nodiscard]] std::string describe_boundary(const mesh::VolumeMesh& tissue,
                                            const BoundaryOptions& options);

}  // namespace lefort::predict
