#include <lefort/core/check.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/internal/face_key.h>
#include <lefort/mesh/layer_thickness.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

namespace lefort::mesh {
namespace {

double area_mm2(const VolumeMesh& mesh, const std::int32_t* nodes) {
  const Vec3& p = mesh.nodes_L[std::size_t(nodes[0])];
  return 0.5 * (mesh.nodes_L[std::size_t(nodes[1])] - p)
                   .cross(mesh.nodes_L[std::size_t(nodes[2])] - p)
                   .norm();
}

Face triangle(const std::int32_t* nodes) {
  return {FaceShape::kTri3, {nodes[0], nodes[1], nodes[2]}};
}

/// \returns the heights of the region's wedges by their triangles: volume over mean area [mm].
std::map<internal::FaceKey, double> heights_by_triangle(const VolumeMesh& mesh,
                                                        std::int32_t region) {
  std::map<internal::FaceKey, double> heights_mm;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.shape != ElementShape::kWedge6) continue;
    for (Index e = 0; e < block.element_count(); ++e) {
      if (block.region[std::size_t(e)] != region) continue;
      const std::int32_t* wedge = block.element(e);
      std::array<Vec3, 6> nodes;
      for (std::size_t n = 0; n < 6; ++n) nodes[n] = mesh.nodes_L[std::size_t(wedge[n])];
      const double mean_area_mm2 = 0.5 * (area_mm2(mesh, wedge) + area_mm2(mesh, wedge + 3));
      const double height_mm = volume_of(ElementShape::kWedge6, nodes) / mean_area_mm2;
      heights_mm[internal::face_key(triangle(wedge))] = height_mm;
      heights_mm[internal::face_key(triangle(wedge + 3))] = height_mm;
    }
  }
  return heights_mm;
}

/// Groups faces that have nodes in common.
std::vector<ThinPatch> patches_of(const VolumeMesh& mesh, std::span<const Face> faces) {
  std::vector<std::int32_t> parent(mesh.nodes_L.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t node) {
    while (parent[std::size_t(node)] != node)
      node = parent[std::size_t(node)] = parent[std::size_t(parent[std::size_t(node)])];
    return node;
  };
  for (const Face& face : faces)
    for (const std::int32_t node : nodes_of(face))
      parent[std::size_t(root(node))] = root(face.nodes[0]);
  std::map<std::int32_t, ThinPatch> by_root;
  for (const Face& face : faces) {
    ThinPatch& patch = by_root[root(face.nodes[0])];
    const double area = area_mm2(mesh, face.nodes.data());
    patch.area_mm2 += area;
    for (const std::int32_t node : nodes_of(face))
      patch.center_L += area / 3.0 * mesh.nodes_L[std::size_t(node)];
  }
  std::vector<ThinPatch> patches;
  for (auto& [node, patch] : by_root) {
    if (patch.area_mm2 > 0.0) patch.center_L /= patch.area_mm2;
    patches.push_back(patch);
  }
  std::stable_sort(patches.begin(), patches.end(),
                   [](const ThinPatch& a, const ThinPatch& b) { return a.area_mm2 > b.area_mm2; });
  return patches;
}

}  // namespace

LayerThickness layer_thickness_statistics(const VolumeMesh& mesh, std::int32_t region,
                                          std::span<const Face> faces, int layers,
                                          double wanted_mm) {
  LEFORT_CHECK(layers >= 1 && wanted_mm > 0.0);
  // As documented for ThinPatch and LayerThickness.
  constexpr double kThin = 0.5, kFull = 0.9, kPercentile = 0.05;
  const auto heights_mm = heights_by_triangle(mesh, region);
  LayerThickness all;
  std::vector<std::pair<double, double>> covered;  // Thickness [mm] and area [mm^2].
  std::vector<Face> thin;
  double covered_mm2 = 0.0, full_mm2 = 0.0;
  for (const Face& face : faces) {
    if (face.shape != FaceShape::kTri3) continue;
    const double area = area_mm2(mesh, face.nodes.data());
    all.area_mm2 += area;
    const auto height = heights_mm.find(internal::face_key(face));
    const double thickness_mm = height == heights_mm.end() ? 0.0 : layers * height->second;
    if (thickness_mm < kThin * wanted_mm) thin.push_back(face);
    if (height == heights_mm.end()) continue;
    covered.push_back({thickness_mm, area});
    covered_mm2 += area;
    all.mean_mm += thickness_mm * area;
    if (thickness_mm >= kFull * wanted_mm) full_mm2 += area;
  }
  all.thin = patches_of(mesh, thin);
  if (!(covered_mm2 > 0.0)) return all;
  all.covered_fraction = covered_mm2 / all.area_mm2;
  all.full_thickness_fraction = full_mm2 / covered_mm2;
  all.mean_mm /= covered_mm2;
  std::sort(covered.begin(), covered.end());
  double below_mm2 = 0.0;
  for (const auto& [thickness_mm, area] : covered) {
    all.p05_mm = thickness_mm;
    below_mm2 += area;
    if (below_mm2 >= kPercentile * covered_mm2) break;
  }
  return all;
}

}  // namespace lefort::mesh
