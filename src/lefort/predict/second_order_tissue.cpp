#include <lefort/image/interpolate.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/elevate_order.h>
#include <lefort/mesh/fit_mid_edge_nodes.h>
#include <lefort/mesh/split_into_tets.h>
#include <lefort/predict/second_order_tissue.h>
#include <lefort/predict/skin_faces.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

constexpr double kBeyondGrid_mm = -1.0;  // Level beyond its grid.

/// A node of the lower lip, and the direction from it to the upper lip.
struct Partner {
  std::int32_t node = 0;
  Vec3 normal_L = Vec3::Zero();
};

/// \param a, b    partners of the ends of an edge: more than one where several slits meet.
/// \param middle  mid-edge nodes by the ends of their edges, ascending.
/// \returns the mid-edge node of the first edge between partners, with the sum of their directions.
std::optional<Partner> partner_of_edge(
    const std::vector<Partner>& a, const std::vector<Partner>& b,
    const std::map<std::array<std::int32_t, 2>, std::int32_t>& middle) {
  for (const Partner& p : a)
    for (const Partner& q : b)
      if (const auto node = middle.find({std::min(p.node, q.node), std::max(p.node, q.node)});
          node != middle.end())
        return Partner{node->second, p.normal_L + q.normal_L};
  return std::nullopt;
}

/// Pairs of mid-edge nodes, ascending, from those of corners.
///
/// \param corners  pairs of the linear mesh.
std::vector<LipPair> pairs_of_middle_nodes(const std::vector<LipPair>& corners,
                                           const mesh::QuadraticMesh& quadratic) {
  std::map<std::int32_t, std::vector<Partner>> by_upper;
  for (const LipPair& pair : corners) by_upper[pair.upper].push_back({pair.lower, pair.normal_L});
  std::map<std::array<std::int32_t, 2>, std::int32_t> middle;
  const auto first = std::int32_t(quadratic.corner_count());
  for (std::size_t m = 0; m < quadratic.ends.size(); ++m)
    middle[quadratic.ends[m]] = first + std::int32_t(m);

  // A corner without a partner is on the border of the slit.
  const auto partners_of = [&](std::int32_t upper) -> std::vector<Partner> {
    const auto found = by_upper.find(upper);
    return found == by_upper.end() ? std::vector<Partner>{{upper, Vec3::Zero()}} : found->second;
  };

  std::map<std::int32_t, LipPair> pairs;
  for (const mesh::Face& face : quadratic.mesh.face_sets.at(sets::kUpperLip)) {
    const auto at = [&](std::size_t n) -> const Vec3& {
      return quadratic.mesh.nodes_L[std::size_t(face.nodes[n])];
    };
    const double third_mm2 = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t upper = face.nodes[3 + i];
      const std::optional<Partner> lower =
          partner_of_edge(partners_of(face.nodes[i]), partners_of(face.nodes[(i + 1) % 3]), middle);
      if (!lower || lower->node == upper || !(lower->normal_L.norm() > 0.0)) continue;
      const LipPair pair{upper, lower->node, 0.0, lower->normal_L.normalized()};
      pairs.try_emplace(upper, pair).first->second.area_mm2 += third_mm2;
    }
  }
  std::vector<LipPair> ascending;
  for (const auto& [upper, pair] : pairs) ascending.push_back(pair);
  return ascending;
}

/// A warped wedge can be split into flat or inverted tetrahedra.
Result<void> check_tets(const mesh::VolumeMesh& tets) {
  const std::vector<mesh::PoorElement> poor = mesh::poor_elements(tets, 0.0);
  if (poor.empty()) return {};
  const Vec3& p_L = poor.front().center_L;
  return fail(ErrorCode::kMeshingFailed,
              fmt::format("tissue.element_order 2: {} of {} tetrahedra are flat or inverted, the "
                          "first at ({:.1f}, {:.1f}, {:.1f}) mm; use order 1 or another "
                          "tissue.element_size_mm",
                          poor.size(), tets.element_count(), p_L.x(), p_L.y(), p_L.z()));
}

}  // namespace

Result<TissueWithLips> second_order_tissue(TissueWithLips linear, const TissueDomain& domain,
                                           Progress& progress) {
  TissueWithLips elevated{{}, std::move(linear.lips)};
  mesh::VolumeMesh tets = mesh::split_into_tets(std::move(linear.tissue));
  LEFORT_TRY_VOID(check_tets(tets));
  mesh::QuadraticMesh quadratic = mesh::elevate_order(std::move(tets));
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
