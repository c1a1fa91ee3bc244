#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/winding_number.h>
#include <lefort/plan/bone_bodies.h>

#include <algorithm>

namespace lefort::plan {
namespace {

using geometry::TriangleMesh;

struct Shell {
  TriangleMesh surface;
  Box3 box;
  double volume_mm3;
};

bool contains(const Shell& outer, const Shell& inner) {
  return outer.box.contains(inner.box) &&
         geometry::winding_number(outer.surface, inner.surface.vertices[0]) > 0.5;
}

}  // namespace

void append(TriangleMesh& to, const TriangleMesh& more) {
  const auto shift = std::int32_t(to.vertices.size());
  to.vertices.insert(to.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles)
    to.triangles.push_back({a + shift, b + shift, c + shift});
}

std::vector<BoneBody> bodies_of(const TriangleMesh& surface) {
  const geometry::Components components = geometry::connected_components(surface);
  std::vector<Shell> outer, cavities;
  for (std::int32_t c = 0; c < components.count; ++c) {
    Shell shell;
    shell.surface = geometry::keep_triangles(
        surface, [&](Index t) { return components.of_triangle[std::size_t(t)] == c; });
    shell.box = geometry::bounding_box(shell.surface);
    shell.volume_mm3 = geometry::signed_volume_mm3(shell.surface);
    (shell.volume_mm3 < 0.0 ? cavities : outer).push_back(std::move(shell));
  }
  std::vector<BoneBody> bodies;
  for (const Shell& shell : outer)
    bodies.push_back({shell.surface, shell.volume_mm3, shell.volume_mm3});
  for (const Shell& cavity : cavities) {
    const Shell* smallest = nullptr;
    for (const Shell& shell : outer)
      if ((smallest == nullptr || shell.volume_mm3 < smallest->volume_mm3) &&
          contains(shell, cavity))
        smallest = &shell;
    if (smallest == nullptr) {  // Round-off at its first vertex: use the largest body.
      if (outer.empty()) continue;
      smallest = &*std::max_element(outer.begin(), outer.end(), [](const Shell& a, const Shell& b) {
        return a.volume_mm3 < b.volume_mm3;
      });
    }
    BoneBody& body = bodies[std::size_t(smallest - outer.data())];
    append(body.surface, cavity.surface);
    body.volume_mm3 += cavity.volume_mm3;
  }
  return bodies;
}

TriangleMesh gather(std::span<const BoneBody> bodies, const std::vector<bool>& chosen) {
  TriangleMesh together;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (chosen[b]) append(together, bodies[b].surface);
  return together;
}

}  // namespace lefort::plan
