#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/tissue_materials.h>

namespace lefort::predict {

Result<fem::RegionMaterials> materials_of(const TissueOptions& tissue) {
  fem::RegionMaterials materials;
  LEFORT_TRY(materials[regions::kDeepTissue],
             fem::NeoHookean::from_young_poisson(tissue.young_mpa, tissue.poisson));
  if (const auto& skin = tissue.skin) {
    LEFORT_TRY(materials[regions::kSkin],
               fem::NeoHookean::from_young_poisson(skin->young_mpa, skin->poisson));
  }
  if (const auto& mucosa = tissue.mucosa) {
    LEFORT_TRY(materials[regions::kMucosa],
               fem::NeoHookean::from_young_poisson(mucosa->young_mpa, mucosa->poisson));
  }
  if (const auto& muscle = tissue.muscle) {
    LEFORT_TRY(materials[regions::kMuscle],
               fem::NeoHookean::from_young_poisson(muscle->young_mpa, muscle->poisson));
  }
  return materials;
}

}  // namespace lefort::predict
