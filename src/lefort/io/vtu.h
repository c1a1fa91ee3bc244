/// \file
/// Writes volume meshes with fields, and time series of them, for ParaView (VTK XML files).
///
/// A set is an array named "set:NAME" with 1 for its members and 0 for all others: a node array for
/// a node set, a cell array for a face set. The faces of face sets are two-dimensional cells
/// (triangle, quad, quadratic triangle, quadratic quad) after the elements; the elements are 0 in
/// such an array. In ParaView, the Calculator (point or cell data) creates such an array with the
/// result name "set:NAME".
///
/// Raw appended binary with 64-bit lengths, little-endian, uncompressed: equal meshes give equal
/// bytes. Format: VTK user's guide, "VTK XML file formats".
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {

/// A number, vector or tensor per node or element. The name contains the unit: "displacement_mm".
struct VtuArray {
  std::string name{};            ///< Not empty, unique among its kind.
  int components = 1;            ///< 1, 3, or 9 (3x3, row by row).
  std::vector<double> values{};  ///< `components` per node or element, in the order of the mesh.
};

[[nodiscard]] VtuArray vtu_array(std::string name, std::span<const double> values);
[[nodiscard]] VtuArray vtu_array(std::string name, std::span<const Vec3> values);
[[nodiscard]] VtuArray vtu_array(std::string name, std::span<const Mat3> values);

struct VtuFields {
  std::vector<VtuArray> nodes{};
  std::vector<VtuArray> elements{};  ///< Block after block.
};

/// Whether a file contains the face sets. Their faces hide fields in ParaView, since they coincide
/// with faces of elements.
enum class VtuFaces { kLeaveOut, kWrite };

/// Writes the mesh in its reference configuration. To show it deformed, add the displacement as a
/// field (ParaView: Warp By Vector). The cell array "region" and all node sets are added; the names
/// of regions are not written. On faces the element fields are NaN.
///
/// \param target  to write.
/// \param mesh    in frame L [mm].
/// \param fields  of nodes and elements.
/// \param faces   whether the faces of face sets are written.
/// \returns nothing, or
///   - kMeshInvalid      an element or set refers to a missing node, or a block has a wrong length;
///   - kInvalidArgument  a field has a wrong length or number of components, or a field or set has
///                       an empty, repeated or unprintable name;
///   - kFileUnwritable.
[[nodiscard]] Result<void> write_vtu(const std::filesystem::path& target,
                                     const mesh::VolumeMesh& mesh, const VtuFields& fields = {},
                                     VtuFaces faces = VtuFaces::kLeaveOut);

/// One file of a series.
struct PvdEntry {
  double time = 0.0;   ///< Finite; in lefort the path fraction, 0 to 1.
  std::string file{};  ///< Relative to the folder of the .pvd.
};

/// Writes the table of contents of a time series.
///
/// \param target   ends in .pvd.
/// \param entries  files of the series.
/// \returns nothing, kInvalidArgument for a time that is not finite or a file name that is empty or
///   unprintable, or kFileUnwritable.
[[nodiscard]] Result<void> write_pvd(const std::filesystem::path& target,
                                     std::span<const PvdEntry> entries);

}  // namespace lefort::io
