/// \file
/// Volume meshes with fields, and series of them over time, for ParaView (VTK XML files).
///
/// Sets have the names "set:NAME": a node array is a node set, a cell array a face set, each 1 for
/// its members and 0 for all others. The faces of face sets are cells of two dimensions (triangle,
/// quad, quadratic triangle, quadratic quad) behind the elements; the elements are 0 in such an
/// array. In ParaView: Calculator (point or cell data) with the result name "set:NAME".
///
/// Raw appended binary with 64-bit lengths, little-endian, uncompressed: the same mesh gives the
/// same bytes. Format: VTK user's guide, "VTK XML file formats".
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {

/// A number, vector or tensor per node or element. The unit belongs in the name: "displacement_mm".
struct VtuArray {
  std::string name{};            ///< Not empty, unique among its kind.
  int components = 1;            ///< 1, 3, or 9 (3x3, row by row).
  std::vector<double> values{};  ///< components per node or element, in the mesh's order.
};

[[nodiscard]] VtuArray vtu_array(std::string name, std::span<const double> values);
[[nodiscard]] VtuArray vtu_array(std::string name, std::span<const Vec3> values);
[[nodiscard]] VtuArray vtu_array(std::string name, std::span<const Mat3> values);

struct VtuFields {
  std::vector<VtuArray> nodes{};
  std::vector<VtuArray> elements{};  ///< Block after block.
};

/// Whether a file holds the faces of the face sets. To look at fields they are in the way: they lie
/// on the elements' own faces.
enum class VtuFaces { kLeaveOut, kWrite };

/// Writes the mesh with its nodes at rest; to see it deformed, give the displacement as a field
/// (ParaView: Warp By Vector). The cell array "region" and all node sets are added; the names of
/// regions are not kept. On faces the fields of elements are NaN.
/// \returns
///   - kMeshInvalid      an element or a set names a missing node, or a block has a wrong length
///   - kInvalidArgument  a field has a wrong length, or no, a repeated or an unprintable name
///   - kFileUnwritable
[[nodiscard]] Result<void> write_vtu(const std::filesystem::path& target,
                                     const mesh::VolumeMesh& mesh, const VtuFields& fields = {},
                                     VtuFaces faces = VtuFaces::kLeaveOut);

/// One file of a series.
struct PvdEntry {
  double time = 0.0;   ///< For lefort the share of the bone's path, 0 to 1; finite.
  std::string file{};  ///< Relative to the folder of the .pvd.
};

/// Writes the table of contents of a series.
/// \returns kInvalidArgument for a time that is not finite or an empty file name, kFileUnwritable.
[[nodiscard]] Result<void> write_pvd(const std::filesystem::path& target,
                                     std::span<const PvdEntry> entries);

}  // namespace lefort::io
