/// \file
/// What a Gmsh file of format 4.1 holds, as it stands there, decoded without trust.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::io::internal {

/// Dimension, 0 to 3, and tag.
using GmshKey = std::pair<int, int>;

/// One of Gmsh's element types.
struct GmshType {
  int number;
  std::string_view name;
  int dimension;
  int nodes;
  std::optional<mesh::ElementShape> element;  ///< If it is one of ours.
  std::optional<mesh::FaceShape> face;        ///< Likewise.
};

/// The elements of one type in one geometrical entity.
struct GmshBlock {
  GmshKey entity;
  const GmshType* type = nullptr;
  std::vector<std::uint64_t> element_tags{};
  std::vector<std::uint64_t> node_tags{};  ///< type->nodes per element, in Gmsh's order.
};

struct GmshFile {
  std::map<GmshKey, std::string> group_names;     ///< By dimension and tag of the group.
  std::map<GmshKey, std::vector<int>> groups_of;  ///< By entity: tags of its physical groups.
  std::vector<std::uint64_t> node_tags;
  std::vector<Vec3> nodes;
  std::vector<GmshBlock> blocks;
};

/// Text or binary. Each count is checked against the length of the file before anything is
/// reserved for it.
///
/// \returns kFileCorrupt if the file is cut short or damaged, or a coordinate is not finite;
///   kFileUnsupported for another version or byte order, a partitioned mesh, or element types that
///   the solver does not know. The sentence has no name of the file.
[[nodiscard]] Result<GmshFile> parse_gmsh(std::string_view bytes);

}  // namespace lefort::io::internal
