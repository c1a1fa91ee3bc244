/// \file
/// Parses untrusted Gmsh files of format 4.1.
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
  std::optional<mesh::ElementShape> element;  ///< Empty if the solver does not support it.
  std::optional<mesh::FaceShape> face;        ///< Empty if it is not a face shape of the solver.
};

/// The elements of one type in one geometrical entity.
struct GmshBlock {
  GmshKey entity;
  const GmshType* type = nullptr;
  std::vector<std::uint64_t> element_tags{};
  std::vector<std::uint64_t> node_tags{};  ///< type->nodes per element, in Gmsh's order.
};

struct GmshFile {
  std::map<GmshKey, std::string> group_names;     ///< Key: dimension and tag of the group.
  std::map<GmshKey, std::vector<int>> groups_of;  ///< Tags of the physical groups of each entity.
  std::vector<std::uint64_t> node_tags;
  std::vector<Vec3> nodes;
  std::vector<GmshBlock> blocks;
};

/// Parses a text or binary file. Each count is compared with the length of the file before memory
/// is allocated.
///
/// \param bytes  of the whole file.
/// \returns the contents; kFileCorrupt if the file is truncated or damaged, or a coordinate is not
///   finite; or kFileUnsupported for another version or byte order, a partitioned mesh, or element
///   types that the solver does not support. The message does not contain the file name.
[[nodiscard]] Result<GmshFile> parse_gmsh(std::string_view bytes);

}  // namespace lefort::io::internal
