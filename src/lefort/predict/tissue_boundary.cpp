#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/image/voxels_within.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_regions.h>
#include <lefort/predict/skin_faces.h>
#include <lefort/predict/tissue_boundary.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

constexpr double kMaxBrainDistance_mm = 2.0;  // Partial-volume voxels between brain and tissue.

/// Distance to the closest voxel of brain, up to kMaxBrainDistance_mm; larger if there is none.
double distance_to_brain(const anatomy::LabelMap& labels, const Vec3& p_L) {
  constexpr double kFar_mm = 1e3;
  const Vec3 p_V = labels.grid.index_V(p_L);
  double nearest_mm = kFar_mm;
  image::visit_voxels_near(labels.grid, p_L, kMaxBrainDistance_mm, [&](Index i, Index j, Index k) {
    if (labels.at(i, j, k) != anatomy::Tissue::kBrain) return;
    const Vec3 beyond_V =
        ((p_V - Vec3(double(i), double(j), double(k))).cwiseAbs().array() - 0.5).cwiseMax(0.0);
    nearest_mm = std::min(nearest_mm, beyond_V.cwiseProduct(labels.grid.spacing_mm).norm());
  });
  return nearest_mm;
}

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

/// Boundary area of each node [mm2]: a third of each adjacent triangle.
std::vector<double> boundary_areas_mm2(const mesh::VolumeMesh& tissue) {
  std::vector<double> areas_mm2(tissue.nodes_L.size(), 0.0);
  for (const mesh::Face3& face : mesh::triangles_of(tissue.face_sets.at("boundary"))) {
    const auto corner = [&](std::size_t n) -> const Vec3& {
      return tissue.nodes_L[std::size_t(face[n])];
    };
    const double area_mm2 = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (const std::int32_t node : face) areas_mm2[std::size_t(node)] += area_mm2 / 3.0;
  }
  return areas_mm2;
}

double sum_over(const NodeList& nodes, const std::vector<double>& of_node) {
  double sum = 0.0;
  for (const std::int32_t node : nodes) sum += of_node[std::size_t(node)];
  return sum;
}

/// Nodes of a label; none if nothing was painted.
NodeList nodes_painted(const mesh::VolumeMesh& tissue, BoundaryLabel label) {
  for (const BoundaryLabelStyle& style : kBoundaryLabelStyles)
    if (const auto set = tissue.node_sets.find(style.set);
        style.label == label && set != tissue.node_sets.end())
      return set->second;
  return {};
}

/// Adds the node sets of the labels and updates the fixed nodes.
void apply_labels(mesh::VolumeMesh& tissue, const BoundaryLabelMap& painted) {
  const NodeList& boundary = tissue.node_sets.at("boundary");
  std::vector<BoundaryLabel> labels(boundary.size());
  parallel_for(std::ssize(boundary), [&](Index n) {
    const auto node = std::size_t(boundary[std::size_t(n)]);
    labels[std::size_t(n)] = painted_at(painted, tissue.nodes_L[node]);
  });
  NodeList fixed = tissue.node_sets.at(sets::kFixed);
  for (const BoundaryLabelStyle& style : kBoundaryLabelStyles) {
    NodeList nodes;
    for (std::size_t n = 0; n < boundary.size(); ++n)
      if (labels[n] == style.label) nodes.push_back(boundary[n]);
    fixed = style.label == BoundaryLabel::kFixed ? united(fixed, nodes) : without(fixed, nodes);
    tissue.node_sets[style.set] = std::move(nodes);
  }
  tissue.node_sets[sets::kFixed] = std::move(fixed);
}

/// Faces that a segment could touch: not on the outer boundary, and free to move.
std::vector<mesh::Face> faces_that_may_touch(const mesh::VolumeMesh& tissue) {
  std::vector<char> is_outer(tissue.nodes_L.size(), 0), is_prescribed(tissue.nodes_L.size(), 0);
  for (const char* set : {sets::kSkin, sets::kCut, sets::kScanBoundary})
    for (const std::int32_t node : tissue.node_sets.at(set)) is_outer[std::size_t(node)] = 1;
  for (const std::int32_t node : united(tissue.node_sets.at(sets::kFixed),
                                        nodes_painted(tissue, BoundaryLabel::kWithSegment)))
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

/// Faces with at least one node that is painted to slide.
std::vector<mesh::Face> faces_that_slide(const mesh::VolumeMesh& tissue) {
  const NodeList slides = nodes_painted(tissue, BoundaryLabel::kSlides);
  std::vector<mesh::Face> faces;
  for (const mesh::Face& face : tissue.face_sets.at("boundary")) {
    const auto nodes = nodes_of(face);
    if (std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
          return std::binary_search(slides.begin(), slides.end(), node);
        }))
      faces.push_back(face);
  }
  return faces;
}

/// Nodes that are fixed unless a label says otherwise.
NodeList fixed_by_rule(const mesh::VolumeMesh& tissue, const geometry::Bvh& segment,
                       const BoundaryOptions& options) {
  NodeList fixed;
  for (const std::int32_t node :
       united(tissue.node_sets.at(sets::kStationaryBone), tissue.node_sets.at(sets::kBrain)))
    if (segment.closest_point(tissue.nodes_L[std::size_t(node)])->distance_mm >=
        options.elevation_margin_mm)
      fixed.push_back(node);
  fixed = united(fixed, tissue.node_sets.at(sets::kCut));
  if (options.scan_boundary == ScanBoundary::kFixed)
    fixed = united(fixed, tissue.node_sets.at(sets::kScanBoundary));
  return fixed;
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

mesh::VolumeMesh find_tissue_boundary(mesh::VolumeMesh tissue, const TissueDomain& domain,
                                      const anatomy::LabelMap& labels,
                                      const geometry::TriangleMesh& skin_L,
                                      const geometry::TriangleMesh& segment_L,
                                      const geometry::TriangleMesh& remainder_L,
                                      const BoundaryOptions& options,
                                      const BoundaryLabelMap* painted) {
  const geometry::Bvh segment(segment_L);
  const geometry::Bvh remainder(remainder_L);
  const geometry::Bvh skin(skin_L);
  const auto distance_to = [](const geometry::Bvh& surface) {
    return [&surface](const Vec3& p_L) { return surface.closest_point(p_L)->distance_mm; };
  };

  const std::array<std::function<double(const Vec3&)>, 6> distances_mm{
      [&](const Vec3& p_L) { return domain.distance_to_cut(p_L); },
      [&](const Vec3& p_L) { return domain.distance_to_scan_boundary(p_L); },
      distance_to(segment),
      distance_to(remainder),
      [&](const Vec3& p_L) { return distance_to_brain(labels, p_L); },
      distance_to(skin)};
  std::vector<mesh::BoundaryRule> rules;
  for (const auto& [set, within_mm] : boundary_rules(options))
    if (within_mm) rules.push_back({set, distances_mm[rules.size()], *within_mm});
  tissue = mesh::name_boundary(std::move(tissue), rules, sets::kFree);

  tissue.node_sets[sets::kFixed] = fixed_by_rule(tissue, segment, options);
  if (painted != nullptr) apply_labels(tissue, *painted);
  tissue.face_sets[sets::kContact] = faces_that_may_touch(tissue);
  if (auto faces = faces_that_slide(tissue); !faces.empty())
    tissue.face_sets[sets::kStationaryContact] = std::move(faces);
  return tissue;
}

NodeList nodes_on_segment(const mesh::VolumeMesh& tissue) {
  return without(tissue.node_sets.at(sets::kMobilizedSegment), tissue.node_sets.at(sets::kFixed));
}

NodeList nodes_with_segment(const mesh::VolumeMesh& tissue, SegmentInterface segment_interface) {
  const NodeList painted = nodes_painted(tissue, BoundaryLabel::kWithSegment);
  if (segment_interface == SegmentInterface::kSliding) return painted;
  return united(painted, without(nodes_on_segment(tissue), all_painted_nodes(tissue)));
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
  const NodeList with_segment = nodes_with_segment(tissue, options.segment_interface);
  const std::vector<double> areas_mm2 = boundary_areas_mm2(tissue);
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
                          .areas = {.fixed_mm2 = sum_over(fixed, areas_mm2),
                                    .with_segment_mm2 = sum_over(moved, areas_mm2),
                                    .free_mm2 = sum_over(free, areas_mm2),
                                    .painted_mm2 = sum_over(common(taken, painted), areas_mm2)}});
  }
  return statistics;
}

std::vector<BoundaryLabelStatistics> boundary_label_statistics(const mesh::VolumeMesh& tissue) {
  const std::vector<double> areas_mm2 = boundary_areas_mm2(tissue);
  std::vector<BoundaryLabelStatistics> statistics;
  for (const BoundaryLabelStyle& label : kBoundaryLabelStyles)
    if (const auto set = tissue.node_sets.find(label.set); set != tissue.node_sets.end())
      statistics.push_back({label, std::ssize(set->second), sum_over(set->second, areas_mm2)});
  return statistics;
}

std::string describe_boundary(const mesh::VolumeMesh& tissue, const BoundaryOptions& options) {
  std::string text =
      fmt::format("boundary nodes by rule (fixed / with segment / free), elevated within {:g} mm:",
                  options.elevation_margin_mm);
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
