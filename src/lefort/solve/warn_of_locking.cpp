#include <lefort/fem/materials/material_response.h>
#include <lefort/solve/warn_of_locking.h>
#include <lefort/solve/young_modulus_at_rest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace lefort::solve {
namespace {

bool is_linear(mesh::ElementShape shape) {
  using enum mesh::ElementShape;
  return shape == kTet4 || shape == kWedge6 || shape == kPyramid5 || shape == kHex8;
}

/// Elements of one warning.
struct Found {
  std::map<mesh::ElementShape, Index> count;
  double max_poisson = 0.0;

  [[nodiscard]] std::string text() const {
    std::vector<std::string> shapes;
    for (const auto& [shape, number] : count)
      shapes.push_back(fmt::format("{} {}", number, mesh::name_of(shape)));
    return fmt::format("{} with a nearly incompressible law (Poisson's ratio up to {:.4f})",
                       fmt::join(shapes, ", "), max_poisson);
  }
};

}  // namespace

std::vector<std::string> warn_of_locking(const mesh::VolumeMesh& mesh,
                                         const fem::RegionMaterials& materials) {
  std::map<std::int32_t, double> poisson;
  for (const auto& [region, law] : materials) poisson[region] = poisson_ratio_at_rest(law);
  Found locking, unstable;
  for (const mesh::ElementBlock& block : mesh.blocks) {
    if (!is_linear(block.shape)) continue;
    for (const std::int32_t region : block.region) {
      if (!(poisson.at(region) >= kNearlyIncompressiblePoisson)) continue;
      const bool has_mean = block.shape == mesh::ElementShape::kHex8 &&
                            fem::volumetric_part(materials.at(region)) != nullptr;
      Found& found = has_mean ? unstable : locking;
      ++found.count[block.shape];
      found.max_poisson = std::max(found.max_poisson, poisson.at(region));
    }
  }
  constexpr const char* kRemedy = "use tet10, wedge15 or hex20 with a decoupled law";
  std::vector<std::string> warnings;
  if (!locking.count.empty())
    warnings.push_back(fmt::format("{} lock: they are too stiff; {}", locking.text(), kRemedy));
  if (!unstable.count.empty())
    warnings.push_back(fmt::format("the pressure of {} can oscillate from element to element; {}",
                                   unstable.text(), kRemedy));
  return warnings;
}

}  // namespace lefort::solve
