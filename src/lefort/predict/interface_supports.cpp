#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/boundary_areas.h>
#include <lefort/predict/interface_supports.h>

#include <algorithm>

namespace lefort::predict {
namespace {

/// Stiffness of a roller divided by E / h: a traction of E moves it by h / 1000.
constexpr double kRollerFactor = 1000.0;

bool is_supported_by_bone(const NodeInterface& one) {
  return one.condition == InterfaceCondition::kElevated ||
         one.condition == InterfaceCondition::kSliding;
}

/// Nothing holds tissue along the bone. Tissue that slides near air has a support in compression
/// only. Elevated tissue has none: contact pushes it.
contact::NodalSupport on_bone(const NodeInterface& one, const std::vector<BoundaryNode>& boundary,
                              const LayerStiffness& layer) {
  const BoundaryNode& at = boundary[std::size_t(one.node)];
  const bool is_elevated = one.condition == InterfaceCondition::kElevated;
  const bool may_lift_off = is_elevated || one.may_separate;
  return {.node = one.node,
          .area_mm2 = at.load_area_mm2,
          .normal_B = -at.normal_L,  // Into the tissue, out of the bone.
          .normal_mpa_per_mm = is_elevated ? 0.0 : layer.normal_mpa_per_mm,
          .tension_mpa_per_mm = may_lift_off ? 0.0 : layer.normal_mpa_per_mm,
          .follows_surface = true};
}

}  // namespace

LayerStiffness layer_stiffness(double young_mpa, double poisson, double thickness_mm) {
  const double mu = young_mpa / (2.0 * (1.0 + poisson));
  const double lambda = young_mpa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  return {.normal_mpa_per_mm = (lambda + 2.0 * mu) / thickness_mm,
          .tangential_mpa_per_mm = mu / thickness_mm};
}

InterfaceSupports interface_supports(const mesh::VolumeMesh& tissue, const InterfaceMap& map,
                                     std::size_t segment_count, const TissueOptions& options,
                                     const BoundaryOptions& boundary) {
  InterfaceSupports supports;
  supports.on_segments.resize(segment_count);
  if (map.nodes.empty()) return supports;
  const std::vector<BoundaryNode> nodes = boundary_nodes(tissue);
  const LayerStiffness layer =
      layer_stiffness(kLayerYoung_mpa, kLayerPoisson, boundary.interface_layer_mm);
  for (const NodeInterface& one : map.nodes) {
    if (!is_supported_by_bone(one)) continue;
    if (!(nodes[std::size_t(one.node)].load_area_mm2 > 0.0)) continue;
    auto& list = one.bone == kStationaryBone ? supports.on_stationary
                                             : supports.on_segments[std::size_t(one.bone)];
    list.push_back(on_bone(one, nodes, layer));
  }
  const LayerStiffness foundation =
      layer_stiffness(options.young_mpa, options.poisson, boundary.foundation_mm);
  const double roller_mpa_per_mm = kRollerFactor * options.young_mpa / node_spacing_mm(options);
  for (const NodePlane& plane : map.planes) {
    const auto at = std::lower_bound(
        map.nodes.begin(), map.nodes.end(), plane.node,
        [](const NodeInterface& one, std::int32_t node) { return one.node < node; });
    const bool is_roller = at->condition == InterfaceCondition::kRoller;
    const BoundaryNode& node = nodes[std::size_t(plane.node)];
    const double area_mm2 = is_roller ? node.area_mm2 : node.load_area_mm2;  // A roller is rigid.
    if (!(area_mm2 > 0.0)) continue;
    const double normal_mpa_per_mm = is_roller ? roller_mpa_per_mm : foundation.normal_mpa_per_mm;
    auto& list =
        plane.segment >= 0 ? supports.on_segments[std::size_t(plane.segment)] : supports.on_planes;
    list.push_back({.node = plane.node,
                    .area_mm2 = area_mm2,
                    .normal_B = plane.normal_L,
                    .normal_mpa_per_mm = normal_mpa_per_mm,
                    .tension_mpa_per_mm = normal_mpa_per_mm,
                    .tangential_mpa_per_mm = is_roller ? 0.0 : foundation.tangential_mpa_per_mm,
                    .motion_fraction = plane.segment >= 0 ? plane.motion_fraction : 0.0});
  }
  return supports;
}

bool slides_on_stationary_bone(const InterfaceMap& map) {
  return std::any_of(map.nodes.begin(), map.nodes.end(), [](const NodeInterface& one) {
    return is_supported_by_bone(one) && one.bone == kStationaryBone;
  });
}

}  // namespace lefort::predict
