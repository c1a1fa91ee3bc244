#include <lefort/anatomy/voxel_mask.h>
#include <lefort/image/interpolate.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/name_mucosa.h>

namespace lefort::predict {

mesh::VolumeMesh name_mucosa(mesh::VolumeMesh tissue, const anatomy::LabelMap& labels,
                             double thickness_mm) {
  using anatomy::Tissue;
  const image::ScalarVolume to_centre =
      anatomy::distance_to(anatomy::mask_where(labels.grid, [&](std::size_t v) {
        return labels.values[v] == Tissue::kAirway || labels.values[v] == Tissue::kSinus;
      }));
  constexpr double kFar_mm = 1e6;
  // From the centre of the air's outermost voxel to its border.
  const double to_border_mm = 0.5 * labels.grid.spacing_mm.minCoeff();
  for (mesh::ElementBlock& block : tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      std::int32_t& region = block.region[std::size_t(e)];
      if (region != regions::kInside) continue;
      Vec3 centroid_L = Vec3::Zero();
      const int corners = mesh::corner_count(block.shape);
      for (int n = 0; n < corners; ++n)
        centroid_L += tissue.nodes_L[std::size_t(block.element(e)[n])] / double(corners);
      if (image::interpolate(to_centre, centroid_L, kFar_mm) - to_border_mm <= thickness_mm)
        region = regions::kMucosa;
    }
  return tissue;
}

}  // namespace lefort::predict
