#include <lefort/anatomy/tissue_volumes.h>

#include <algorithm>

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

}  // namespace lefort::anatomy
