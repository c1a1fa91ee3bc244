#include <lefort/image/interpolate.h>
#include <lefort/mesh/elevate_order.h>
#include <lefort/mesh/fit_mid_edge_nodes.h>
#include <lefort/mesh/split_into_tets.h>
#include <lefort/predict/second_order_tissue.h>
#include <lefort/predict/skin_faces.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

constexpr double kBeyondGrid_mm = -1.0;  // Level beyond its grid.

/// Pairs of mid-edge nodes, ascending, from those of corners.
///
/// \param corners  pairs of the linear mesh.
std::vector<LipPair> pairs_of_middle_nodes(const std::vector<LipPair>& corners,
                                           const mesh::QuadraticMesh& quadratic) {
  std::map<std::int32_t, const LipPair*> by_upper;
  for (const LipPair& pair : corners) by_upper[pair.upper] = &pair;
  std::map<std::array<std::int32_t, 2>, std::int32_t> middle;
  const auto first = std::int32_t(quadratic.corner_count());
  for (std::size_t m = 0; m < quadratic.ends.size(); ++m)
    middle[quadratic.ends[m]] = first + std::int32_t(m);

  std::map<std::int32_t, LipPair> pairs;
  for (const mesh::Face& face : quadratic.mesh.face_sets.at(sets::kUpperLip)) {
    const auto at = [&](std::size_t n) -> const Vec3& {
      return quadratic.mesh.nodes_L[std::size_t(face.nodes[n])];
    };
    const double third_mm2 = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6.0;
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<std::int32_t, 2> ends{face.nodes[i], face.nodes[(i + 1) % 3]};
      Vec3 normal_L = Vec3::Zero();
      for (std::int32_t& end : ends)  // A corner without a partner is on the border of the slit.
        if (const auto pair = by_upper.find(end); pair != by_upper.end()) {
          normal_L += pair->second->normal_L;
          end = pair->second->lower;
        }
      std::sort(ends.begin(), ends.end());
      const std::int32_t upper = face.nodes[3 + i];
      const auto lower = middle.find(ends);
      if (lower == middle.end() || lower->second == upper || !(normal_L.norm() > 0.0)) continue;
      const LipPair pair{upper, lower->second, 0.0, normal_L.normalized()};
      pairs.try_emplace(upper, pair).first->second.area_mm2 += third_mm2;
    }
  }
  std::vector<LipPair> ascending;
  for (const auto& [upper, pair] : pairs) ascending.push_back(pair);
  return ascending;
}

}  // namespace

TissueWithLips second_order_tissue(TissueWithLips linear, const TissueDomain& domain,
                                   Progress& progress) {
  TissueWithLips elevated{{}, std::move(linear.lips)};
  mesh::QuadraticMesh quadratic =
      mesh::elevate_order(mesh::split_into_tets(std::move(linear.tissue)));
  std::vector<mesh::Face> lips;
  if (elevated.lips.is_separated()) {
    elevated.lips.pairs = pairs_of_middle_nodes(elevated.lips.pairs, quadratic);
    for (const char* set : {sets::kUpperLip, sets::kLowerLip}) {
      const auto& faces = quadratic.mesh.face_sets.at(set);
      lips.insert(lips.end(), faces.begin(), faces.end());
    }
  }
  const mesh::CurvedSurface surface{
      [&](const Vec3& p_L) {
        return image::interpolate(domain.soft_tissue_level, p_L, kBeyondGrid_mm) > 0.0;
      },
      [&](const Vec3& p_L) { return domain.planes_at(p_L, kPlaneTolerance_mm); }};
  mesh::CurvedMesh curved = mesh::fit_mid_edge_nodes(std::move(quadratic), surface, lips);
  progress.note(fmt::format(
      "second order: {} tet10, {} nodes; {} boundary edges curved, {} of them less than to the "
      "surface, by up to {:.2f} mm; min det J {:.2f} of that with straight edges",
      curved.quadratic.mesh.element_count(), curved.quadratic.mesh.node_count(),
      curved.curved + curved.limited, curved.limited, curved.max_mm, curved.min_ratio));
  elevated.tissue = std::move(curved.quadratic.mesh);
  return elevated;
}

}  // namespace lefort::predict
