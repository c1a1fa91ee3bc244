#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_regions.h>
#include <lefort/predict/skin_faces.h>
#include <lefort/predict/tissue_boundary.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

constexpr double kBrainReach_mm = 2.0;  // A layer of blurred voxels between brain and tissue.

/// Distance to the nearest voxel labelled brain, up to kBrainReach_mm; beyond it, far.
double distance_to_brain(const anatomy::LabelMap& labels, const Vec3& p_L) {
  constexpr double kFar_mm = 1e3;
  const Vec3& spacing_mm = labels.grid.spacing_mm;
  const Vec3 p_V = labels.grid.index_V(p_L);
  std::array<Index, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach_V = kBrainReach_mm / spacing_mm[Index(axis)];
    low[axis] = std::max<Index>(std::lround(p_V[Index(axis)] - reach_V), 0);
    high[axis] =
        std::min(Index(std::lround(p_V[Index(axis)] + reach_V)), labels.grid.size[axis] - 1);
  }
  double nearest_mm = kFar_mm;
  for (Index k = low[2]; k <= high[2]; ++k)
    for (Index j = low[1]; j <= high[1]; ++j)
      for (Index i = low[0]; i <= high[0]; ++i) {
        if (labels.at(i, j, k) != anatomy::Tissue::kBrain) continue;
        const Vec3 beyond_V =
            ((p_V - Vec3(double(i), double(j), double(k))).cwiseAbs().array() - 0.5).cwiseMax(0.0);
        nearest_mm = std::min(nearest_mm, beyond_V.cwiseProduct(spacing_mm).norm());
      }
  return nearest_mm;
}

NodeList united(const NodeList& a, const NodeList& b) {
  NodeList both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

/// Inner faces that can move: tissue that the segment could run into.
std::vector<mesh::Face> faces_that_may_touch(const mesh::VolumeMesh& tissue) {
  std::vector<char> is_outer(tissue.nodes_L.size(), 0), is_fixed(tissue.nodes_L.size(), 0);
  for (const char* set : {sets::kSkin, sets::kCut, sets::kScanEdge})
    for (const std::int32_t node : tissue.node_sets.at(set)) is_outer[std::size_t(node)] = 1;
  for (const std::int32_t node : tissue.node_sets.at(sets::kFixed)) is_fixed[std::size_t(node)] = 1;

  std::vector<mesh::Face> faces;
  for (const mesh::Face& face : tissue.face_sets.at("boundary")) {
    const auto all = [nodes = nodes_of(face)](const std::vector<char>& flag) {
      return std::all_of(nodes.begin(), nodes.end(),
                         [&](std::int32_t node) { return flag[std::size_t(node)] != 0; });
    };
    if (!all(is_outer) && !all(is_fixed)) faces.push_back(face);
  }
  return faces;
}

}  // namespace

mesh::VolumeMesh find_tissue_boundary(mesh::VolumeMesh tissue, const TissueDomain& domain,
                                      const anatomy::LabelMap& labels,
                                      const geometry::TriangleMesh& skin_L,
                                      const geometry::TriangleMesh& segment_L,
                                      const geometry::TriangleMesh& remainder_L,
                                      const BoundaryOptions& options) {
  const geometry::Bvh segment(segment_L);
  const geometry::Bvh remainder(remainder_L);
  const geometry::Bvh skin(skin_L);
  const auto distance_to = [](const geometry::Bvh& surface) {
    return [&surface](const Vec3& p_L) { return surface.closest_point(p_L)->distance_mm; };
  };

  const std::vector<mesh::BoundaryRule> rules{
      {sets::kCut, [&](const Vec3& p) { return domain.distance_to_cut(p); }, kPlaneTolerance_mm},
      {sets::kScanEdge, [&](const Vec3& p) { return domain.distance_to_scan_edge(p); },
       kPlaneTolerance_mm},
      {sets::kMovedBone, distance_to(segment), options.capture_mm},
      {sets::kStillBone, distance_to(remainder), options.capture_mm},
      {sets::kBrain, [&](const Vec3& p) { return distance_to_brain(labels, p); }, kBrainReach_mm},
      {sets::kSkin, distance_to(skin), options.capture_mm},
  };
  tissue = mesh::name_boundary(std::move(tissue), rules, sets::kFree);

  // Held by their neighbour, but elevated from it where the segment is near.
  NodeList held;
  for (const std::int32_t node :
       united(tissue.node_sets.at(sets::kStillBone), tissue.node_sets.at(sets::kBrain)))
    if (segment.closest_point(tissue.nodes_L[std::size_t(node)])->distance_mm >= options.release_mm)
      held.push_back(node);
  NodeList fixed = united(held, tissue.node_sets.at(sets::kCut));
  if (options.scan_edge == ScanEdge::kFixed)
    fixed = united(fixed, tissue.node_sets.at(sets::kScanEdge));
  tissue.node_sets[sets::kFixed] = std::move(fixed);
  tissue.face_sets[sets::kContact] = faces_that_may_touch(tissue);
  return tissue;
}

std::vector<std::int32_t> nodes_on_segment(const mesh::VolumeMesh& tissue) {
  const auto& on_bone = tissue.node_sets.at(sets::kMovedBone);
  const auto& fixed = tissue.node_sets.at(sets::kFixed);
  std::vector<std::int32_t> nodes;
  std::set_difference(on_bone.begin(), on_bone.end(), fixed.begin(), fixed.end(),
                      std::back_inserter(nodes));
  return nodes;
}

}  // namespace lefort::predict
