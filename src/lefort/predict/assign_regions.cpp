#include <lefort/anatomy/voxel_mask.h>
#include <lefort/image/interpolate.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/predict/assign_regions.h>
#include <lefort/predict/mesh_tissue.h>

#include <fmt/format.h>

#include <cstdint>
#include <map>

namespace lefort::predict {
namespace {

using anatomy::Tissue;

/// Assigns `region` to elements of deep tissue whose centroid satisfies `contains`.
template <class Predicate>
void assign_region(mesh::VolumeMesh& tissue, std::int32_t region, const Predicate& contains) {
  for (mesh::ElementBlock& block : tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      std::int32_t& current = block.region[std::size_t(e)];
      if (current != regions::kDeepTissue) continue;
      Vec3 centroid_L = Vec3::Zero();
      const int corners = mesh::corner_count(block.shape);
      for (int n = 0; n < corners; ++n)
        centroid_L += tissue.nodes_L[std::size_t(block.element(e)[n])] / double(corners);
      if (contains(centroid_L)) current = region;
    }
}

}  // namespace

mesh::VolumeMesh assign_muscle(mesh::VolumeMesh tissue, const anatomy::LabelMap& labels) {
  constexpr double kHalf = 0.5;
  const anatomy::Mask muscle = anatomy::mask_where(
      labels.grid, [&](std::size_t v) { return labels.values[v] == Tissue::kMuscle; });
  assign_region(tissue, regions::kMuscle,
                [&](const Vec3& p_L) { return image::interpolate(muscle, p_L, 0.0) >= kHalf; });
  return tissue;
}

mesh::VolumeMesh assign_mucosa(mesh::VolumeMesh tissue, const anatomy::LabelMap& labels,
                               double thickness_mm) {
  const image::ScalarVolume to_center =
      anatomy::distance_to(anatomy::mask_where(labels.grid, [&](std::size_t v) {
        return labels.values[v] == Tissue::kAirway || labels.values[v] == Tissue::kSinus;
      }));
  constexpr double kFar_mm = 1e6;  // Outside the scan.
  // From the center of an outermost voxel of air to its border.
  const double to_border_mm = 0.5 * labels.grid.spacing_mm.minCoeff();
  assign_region(tissue, regions::kMucosa, [&](const Vec3& p_L) {
    return image::interpolate(to_center, p_L, kFar_mm) - to_border_mm <= thickness_mm;
  });
  return tissue;
}

std::vector<RegionAndSize> regions_and_sizes(const mesh::VolumeMesh& tissue,
                                             const TissueOptions& options) {
  const std::map<std::int32_t, bool> has_material{{regions::kDeepTissue, true},
                                                  {regions::kSkin, options.skin.has_value()},
                                                  {regions::kMucosa, options.mucosa.has_value()},
                                                  {regions::kMuscle, options.muscle.has_value()}};
  const std::map<std::int32_t, mesh::RegionSize> sizes = mesh::region_sizes(tissue);
  std::vector<RegionAndSize> named;
  for (const auto& [region, name] : regions::kNames) {
    if (!has_material.at(region)) continue;
    const auto size = sizes.find(region);
    named.push_back({name, size == sizes.end() ? mesh::RegionSize{} : size->second});
  }
  return named;
}

std::string describe_regions(const mesh::VolumeMesh& tissue, const TissueOptions& options) {
  std::string text;
  for (const auto& [name, size] : regions_and_sizes(tissue, options))
    text += fmt::format("{}{} {} elements, {:.1f} ml", text.empty() ? "" : "; ", name,
                        size.elements, size.volume_mm3 * 1e-3);
  return text;
}

}  // namespace lefort::predict
