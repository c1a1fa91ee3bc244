#include <lefort/fem/loads/validate_load_faces.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::fem {

Result<void> validate_load_faces(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::span nodes = mesh::nodes_of(faces[f]);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const std::int32_t node = nodes[a];
      if (node < 0 || std::size_t(node) >= nodes_L.size())
        return fail(ErrorCode::kMeshInvalid, fmt::format("face {} names node {}, must be 0 to {}",
                                                         f, node, Index(nodes_L.size()) - 1));
      if (!nodes_L[std::size_t(node)].allFinite())
        return fail(ErrorCode::kMeshInvalid,
                    fmt::format("node {} of face {} has a coordinate that is not finite", node, f));
      if (std::ranges::count(nodes.first(a), node) > 0)
        return fail(ErrorCode::kMeshInvalid,
                    fmt::format("face {} names node {} twice, its nodes must differ", f, node));
    }
  }
  return {};
}

}  // namespace lefort::fem
