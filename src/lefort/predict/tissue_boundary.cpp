#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_regions.h>
#include <lefort/predict/boundary_areas.h>
#include <lefort/predict/distance_to_label.h>
#include <lefort/predict/skin_faces.h>
#include <lefort/predict/tissue_boundary.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::predict {

std::vector<std::int32_t> nodes_painted(const mesh::VolumeMesh& tissue, BoundaryLabel label) {
  for (const BoundaryLabelStyle& style : kBoundaryLabelStyles)
    if (const auto set = tissue.node_sets.find(style.set);
        style.label == label && set != tissue.node_sets.end())
      return set->second;
  return {};
}

bool slides_on_segments(const mesh::VolumeMesh& tissue, TissueInterface interface) {
  return interface != TissueInterface::kBonded ||
         !nodes_painted(tissue, BoundaryLabel::kContact).empty() ||
         !nodes_painted(tissue, BoundaryLabel::kElevated).empty();
}

namespace {

using NodeList = std::vector<std::int32_t>;
using Distance = std::function<double(const Vec3&)>;

constexpr double kMaxBrainDistance_mm = 2.0;  // Partial-volume voxels between brain and tissue.

NodeList united(const NodeList& a, const NodeList& b) {
  NodeList both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

NodeList without(const NodeList& a, const NodeList& b) {
  NodeList rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

NodeList common(const NodeList& a, const NodeList& b) {
  NodeList both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

double area_mm2(const NodeList& nodes, const std::vector<BoundaryNode>& boundary) {
  double sum = 0.0;
  for (const std::int32_t node : nodes) sum += boundary[std::size_t(node)].area_mm2;
  return sum;
}

/// Adds the node sets of the labels.
void name_painted_nodes(mesh::VolumeMesh& tissue, const BoundaryLabelMap& painted) {
  const NodeList& boundary = tissue.node_sets.at("boundary");
  std::vector<BoundaryLabel> labels(boundary.size());
  parallel_for(std::ssize(boundary), [&](Index n) {
    const auto node = std::size_t(boundary[std::size_t(n)]);
    labels[std::size_t(n)] = painted_at(painted, tissue.nodes_L[node]);
  });
  for (const BoundaryLabelStyle& style : kBoundaryLabelStyles) {
    NodeList nodes;
    for (std::size_t n = 0; n < boundary.size(); ++n)
      if (labels[n] == style.label) nodes.push_back(boundary[n]);
    tissue.node_sets[style.set] = std::move(nodes);
  }
}

/// Sets of prescribed nodes and of faces in contact, from the conditions.
void add_condition_sets(mesh::VolumeMesh& tissue, const InterfaceMap& map) {
  NodeList fixed, bonded;
  for (const NodeInterface& one : map.nodes) {
    const bool is_bonded = one.condition == InterfaceCondition::kBonded;
    if (is_bonded && one.bone >= 0) bonded.push_back(one.node);
    if (one.condition == InterfaceCondition::kFixed || (is_bonded && one.bone < 0))
      fixed.push_back(one.node);
  }
  tissue.node_sets[sets::kFixed] = std::move(fixed);
  tissue.node_sets[sets::kBonded] = std::move(bonded);
}

/// Faces that a segment could touch: not on the outer boundary, and free to move.
std::vector<mesh::Face> faces_that_may_touch(const mesh::VolumeMesh& tissue) {
  std::vector<char> is_outer(tissue.nodes_L.size(), 0), is_prescribed(tissue.nodes_L.size(), 0);
  for (const char* set : {sets::kSkin, sets::kCut, sets::kScanBoundary})
    for (const std::int32_t node : tissue.node_sets.at(set)) is_outer[std::size_t(node)] = 1;
  for (const std::int32_t node :
       united(tissue.node_sets.at(sets::kFixed), tissue.node_sets.at(sets::kBonded)))
    is_prescribed[std::size_t(node)] = 1;

  std::vector<mesh::Face> faces;
  for (const mesh::Face& face : tissue.face_sets.at("boundary")) {
    const auto all = [nodes = nodes_of(face)](const std::vector<char>& flag) {
      return std::all_of(nodes.begin(), nodes.end(),
                         [&](std::int32_t node) { return flag[std::size_t(node)] != 0; });
    };
    if (!all(is_outer) && !all(is_prescribed)) faces.push_back(face);
  }
  return faces;
}

/// Faces with at least one node that is painted as contact or elevated: all bones push it.
std::vector<mesh::Face> faces_painted_as_pushed(const mesh::VolumeMesh& tissue) {
  const NodeList painted = united(nodes_painted(tissue, BoundaryLabel::kContact),
                                  nodes_painted(tissue, BoundaryLabel::kElevated));
  std::vector<mesh::Face> faces;
  for (const mesh::Face& face : tissue.face_sets.at("boundary")) {
    const auto nodes = nodes_of(face);
    if (std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
          return std::binary_search(painted.begin(), painted.end(), node);
        }))
      faces.push_back(face);
  }
  return faces;
}

}  // namespace

std::vector<RuleDistance> boundary_rules(const BoundaryOptions& options) {
  return {{sets::kCut, kPlaneTolerance_mm},
          {sets::kScanBoundary, kPlaneTolerance_mm},
          {sets::kMobilizedSegment, options.contact_snap_mm},
          {sets::kStationaryBone, options.contact_snap_mm},
          {sets::kBrain, kMaxBrainDistance_mm},
          {sets::kSkin, options.contact_snap_mm},
          {sets::kFree, std::nullopt}};
}

TissueBoundary find_tissue_boundary(mesh::VolumeMesh tissue, const TissueDomain& domain,
                                    const anatomy::LabelMap& labels,
                                    const geometry::TriangleMesh& skin_L,
                                    const InterfaceBones& bones, const BoundaryOptions& options,
                                    const BoundaryLabelMap* painted) {
  std::vector<geometry::Bvh> segments(bones.segments_L.begin(), bones.segments_L.end());
  const geometry::Bvh remainder(bones.remainder_L);
  const geometry::Bvh skin(skin_L);
  const auto distance_to = [](const geometry::Bvh& surface) {
    return [&surface](const Vec3& p_L) { return surface.closest_point(p_L)->distance_mm; };
  };
  const auto distance_to_segments = [&](const Vec3& p_L) {
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (const geometry::Bvh& segment : segments)
      nearest_mm = std::min(nearest_mm, segment.closest_point(p_L)->distance_mm);
    return nearest_mm;
  };
  const std::array<Distance, 6> distances_mm{
      [&](const Vec3& p_L) { return domain.distance_to_cut(p_L); },
      [&](const Vec3& p_L) { return domain.distance_to_scan_boundary(p_L); },
      distance_to_segments,
      distance_to(remainder),
      [&](const Vec3& p_L) {
        return distance_to_label(labels, anatomy::Tissue::kBrain, p_L, kMaxBrainDistance_mm);
      },
      distance_to(skin)};
  std::vector<mesh::BoundaryRule> rules;
  for (const auto& [set, within_mm] : boundary_rules(options))
    if (within_mm) rules.push_back({set, distances_mm[rules.size()], *within_mm});
  TissueBoundary found{mesh::name_boundary(std::move(tissue), rules, sets::kFree), {}};
  if (painted != nullptr) name_painted_nodes(found.tissue, *painted);

  found.interface = make_interface_map(found.tissue, domain, labels, bones, options, painted);
  add_condition_sets(found.tissue, found.interface);
  auto& face_sets = found.tissue.face_sets;
  std::vector<mesh::Face> painted_faces = faces_painted_as_pushed(found.tissue);
  face_sets[sets::kContact] = options.interface == TissueInterface::kBonded
                                  ? painted_faces
                                  : faces_that_may_touch(found.tissue);
  std::vector<mesh::Face> on_stationary = options.interface == TissueInterface::kClinical
                                              ? face_sets[sets::kContact]
                                              : std::move(painted_faces);
  if (!on_stationary.empty()) face_sets[sets::kStationaryContact] = std::move(on_stationary);
  return found;
}

NodeList nodes_on_segment(const mesh::VolumeMesh& tissue) {
  return without(tissue.node_sets.at(sets::kMobilizedSegment), tissue.node_sets.at(sets::kFixed));
}

NodeList nodes_with_segment(const mesh::VolumeMesh& tissue, TissueInterface interface) {
  const auto bonded = tissue.node_sets.find(sets::kBonded);
  if (bonded != tissue.node_sets.end()) return bonded->second;
  return interface == TissueInterface::kBonded ? nodes_on_segment(tissue) : NodeList{};
}

std::optional<double> distance_to_scan_boundary(const mesh::VolumeMesh& tissue) {
  const NodeList& ends = tissue.node_sets.at(sets::kScanBoundary);
  const NodeList& on_segment = tissue.node_sets.at(sets::kMobilizedSegment);
  if (ends.empty() || on_segment.empty()) return std::nullopt;
  double squared_mm2 = std::numeric_limits<double>::infinity();
  for (const std::int32_t end : ends)
    for (const std::int32_t node : on_segment)
      squared_mm2 = std::min(
          squared_mm2,
          (tissue.nodes_L[std::size_t(node)] - tissue.nodes_L[std::size_t(end)]).squaredNorm());
  return std::sqrt(squared_mm2);
}

NodeList all_painted_nodes(const mesh::VolumeMesh& tissue) {
  NodeList painted;
  for (const BoundaryLabelStyle& style : kBoundaryLabelStyles)
    painted = united(painted, nodes_painted(tissue, style.label));
  return painted;
}

std::vector<BoundaryRuleStatistics> boundary_rule_statistics(const mesh::VolumeMesh& tissue,
                                                             const BoundaryOptions& options) {
  const NodeList painted = all_painted_nodes(tissue);
  const NodeList with_segment = nodes_with_segment(tissue, options.interface);
  const std::vector<BoundaryNode> nodes = boundary_nodes(tissue);
  std::vector<BoundaryRuleStatistics> statistics;
  for (const auto& [set, within_mm] : boundary_rules(options)) {
    const NodeList& taken = tissue.node_sets.at(set);
    const NodeList decided = without(taken, painted);
    const NodeList fixed = common(decided, tissue.node_sets.at(sets::kFixed));
    const NodeList moved = common(decided, with_segment);
    const NodeList free = without(without(decided, fixed), moved);
    statistics.push_back({.set = set,
                          .within_mm = within_mm,
                          .fixed = std::ssize(fixed),
                          .with_segment = std::ssize(moved),
                          .free = std::ssize(free),
                          .painted = std::ssize(taken) - std::ssize(decided),
                          .areas = {.fixed_mm2 = area_mm2(fixed, nodes),
                                    .with_segment_mm2 = area_mm2(moved, nodes),
                                    .free_mm2 = area_mm2(free, nodes),
                                    .painted_mm2 = area_mm2(common(taken, painted), nodes)}});
  }
  return statistics;
}

std::vector<BoundaryLabelStatistics> boundary_label_statistics(const mesh::VolumeMesh& tissue) {
  const std::vector<BoundaryNode> nodes = boundary_nodes(tissue);
  std::vector<BoundaryLabelStatistics> statistics;
  for (const BoundaryLabelStyle& label : kBoundaryLabelStyles)
    if (const auto set = tissue.node_sets.find(label.set); set != tissue.node_sets.end())
      statistics.push_back({label, std::ssize(set->second), area_mm2(set->second, nodes)});
  return statistics;
}

std::string describe_boundary(const mesh::VolumeMesh& tissue, const BoundaryOptions& options) {
  std::string text = std::string("boundary nodes by rule (fixed / with segment / other):");
  const char* separator = " ";
  for (const BoundaryRuleStatistics& rule : boundary_rule_statistics(tissue, options)) {
    text += fmt::format("{}{} {} / {} / {}", separator, rule.set, rule.fixed, rule.with_segment,
                        rule.free);
    if (rule.within_mm) text += fmt::format(" within {:g} mm", *rule.within_mm);
    separator = ", ";
  }
  separator = "; painted: ";
  for (const BoundaryLabelStatistics& painted : boundary_label_statistics(tissue)) {
    text += fmt::format("{}{} {}", separator, painted.label.name, painted.nodes);
    separator = ", ";
  }
  return text;
}

}  // namespace lefort::predict
