#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/internal/layer_elements.h>

namespace lefort::mesh::internal {
namespace {

// By the number of single corners of the face above.
constexpr std::array kLayerShapes{ElementShape::kWedge6, ElementShape::kPyramid5,
                                  ElementShape::kTet4};

void append(std::vector<std::int32_t>& to, const std::vector<std::int32_t>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

template <class Visit>
void LayerElements::for_each_element(const Face3& face, const Visit& visit) const {
  const auto single = [&](std::int32_t node) { return is_single(std::size_t(node)); };
  const auto singles = std::size_t(std::count_if(face.begin(), face.end(), single));
  if (singles == 3) return;
  auto [a, b, c] = face;  // Rotated: the one single corner is c, the one corner with thickness a.
  while ((singles == 1 && !single(c)) || (singles == 2 && single(a))) {
    const std::int32_t first = a;
    a = b, b = c, c = first;
  }
  for (int level = 0; level < layers_; ++level) {
    const LayerCorner a0{a, level}, b0{b, level}, c0{c, level};
    const LayerCorner a1{a, level + 1}, b1{b, level + 1}, c1{c, level + 1};
    if (singles == 0) visit(singles, std::array{a0, b0, c0, a1, b1, c1});
    if (singles == 1) visit(singles, std::array{a0, b0, b1, a1, c0});
    if (singles == 2) visit(singles, std::array{a0, c0, b0, a1});
  }
}

double LayerElements::min_scaled_jacobian(const Face3& face) const {
  double minimum = 1.0;
  for_each_element(face, [&](std::size_t singles, std::span<const LayerCorner> corners) {
    std::array<Vec3, 6> points;
    for (std::size_t n = 0; n < corners.size(); ++n)
      points[n] = at_level(std::size_t(corners[n].node), corners[n].level);
    minimum = std::min(
        minimum, scaled_jacobian(kLayerShapes[singles], std::span(points).first(corners.size())));
  });
  return minimum;
}

VolumeMesh LayerElements::add_to(const VolumeMesh& inner, std::int32_t region) const {
  VolumeMesh mesh = inner;
  const std::size_t node_count = surface_.nodes_L.size();
  std::vector<std::int32_t> first_copy(node_count, -1);  // Of the copies above the inner surface.
  for (std::size_t n = 0; n < node_count; ++n) {
    if (is_single(n)) continue;
    first_copy[n] = std::int32_t(mesh.nodes_L.size());
    for (int level = 0; level < layers_; ++level) mesh.nodes_L.push_back(at_level(n, level));
  }
  const auto node_number = [&](const LayerCorner& corner) {
    const std::int32_t first = first_copy[std::size_t(corner.node)];
    return first < 0 || corner.level == layers_ ? corner.node : first + corner.level;
  };
  std::array<ElementBlock, 3> blocks{};  // By the number of single corners.
  blocks[0].shape = kLayerShapes[0];
  blocks[1].shape = kLayerShapes[1];
  for (const Face3& face : surface_.faces)
    for_each_element(face, [&](std::size_t singles, std::span<const LayerCorner> corners) {
      for (const LayerCorner& corner : corners)
        blocks[singles].nodes.push_back(node_number(corner));
      blocks[singles].region.push_back(region);
    });
  append(mesh.blocks[0].nodes, blocks[2].nodes);
  append(mesh.blocks[0].region, blocks[2].region);
  for (const std::size_t singles : {1, 0})
    if (blocks[singles].element_count() > 0) mesh.blocks.push_back(std::move(blocks[singles]));
  return mesh;
}

}  // namespace lefort::mesh::internal
