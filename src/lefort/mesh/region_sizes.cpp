#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/region_sizes.h>

#include <array>
#include <span>

namespace lefort::mesh {

std::map<std::int32_t, RegionSize> region_sizes(const VolumeMesh& mesh) {
  std::map<std::int32_t, RegionSize> sizes;
  std::array<Vec3, 20> nodes;
  for (const ElementBlock& block : mesh.blocks) {
    const auto count = std::size_t(node_count(block.shape));
    for (Index e = 0; e < block.element_count(); ++e) {
      for (std::size_t n = 0; n < count; ++n)
        nodes[n] = mesh.nodes_L[std::size_t(block.element(e)[n])];
      RegionSize& size = sizes[block.region[std::size_t(e)]];
      ++size.elements;
      size.volume_mm3 += volume_of(block.shape, std::span(nodes).first(count));
    }
  }
  return sizes;
}

}  // namespace lefort::mesh
