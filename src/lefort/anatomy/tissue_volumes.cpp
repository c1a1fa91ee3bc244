#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/geometry/bvh.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::anatomy {

std::vector<std::pair<std::string, double>> tissue_volumes_ml(const LabelMap& labels) {
  constexpr double kMm3PerMl = 1000.0;
  const double voxel_ml = labels.grid.spacing_mm.prod() / kMm3PerMl;
  std::vector<std::pair<std::string, double>> volumes;
  for (const TissueStyle& style : kTissueStyles) {
    const auto voxels = std::count(labels.values.begin(), labels.values.end(), style.tissue);
    volumes.emplace_back(style.name, double(voxels) * voxel_ml);
  }
  return volumes;
}

BoneVolumes bone_volumes_within(const LabelMap& labels, const geometry::TriangleMesh& surface_L) {
  constexpr double kMaxVisited = 2e5;
  BoneVolumes volumes;
  if (surface_L.triangles.empty()) return volumes;
  Box3 box_V;
  for (const Vec3& p_L : surface_L.vertices) box_V.extend(labels.grid.index_V(p_L));
  std::array<Index, 3> first{}, last{};
  double voxels = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::max<Index>(Index(std::ceil(box_V.min()[Index(axis)])), 0);
    last[axis] = std::min(Index(std::floor(box_V.max()[Index(axis)])), labels.grid.size[axis] - 1);
    voxels *= double(std::max<Index>(last[axis] - first[axis] + 1, 0));
  }
  const Index step = std::max<Index>(Index(std::ceil(std::cbrt(voxels / kMaxVisited))), 1);
  const geometry::Bvh tree(surface_L);
  const Vec3 ray(0.0123456, 0.0234567, 1.0);  // In general position: through no edge.
  const double ml = labels.grid.spacing_mm.prod() * 1e-3 * double(step * step * step);
  for (Index k = first[2]; k <= last[2]; k += step)
    for (Index j = first[1]; j <= last[1]; j += step)
      for (Index i = first[0]; i <= last[0]; i += step) {
        const Tissue tissue = labels.at(i, j, k);
        if (!is_bone(tissue)) continue;
        const Vec3 p_L = labels.grid.point_L({double(i), double(j), double(k)});
        if (tree.count_hits(p_L, ray) % 2 == 0) continue;
        (tissue == Tissue::kBone ? volumes.skull_ml : volumes.mandible_ml) += ml;
      }
  return volumes;
}

}  // namespace lefort::anatomy
