/// \file
/// Volume meshes from VTK XML files, decoded without trust: a cache may be cut off or altered.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::io {

/// Reads nodes, elements, their regions, and node and face sets as vtu.h tells. Elements of one
/// shape make one block, shapes in the order of their first element. Faces in no set make the face
/// set "region N" after their region. A face is taken from the element it lies on, so that its
/// normal points out; only of one between two elements the file's side is kept. Other fields are
/// not read back.
///
/// Wedges are read in both ways in which programs number them (internal/wedge_order.h).
///
/// \param file     of at least one element; little-endian, plain or packed by zlib.
/// \param regions  the cell array that numbers them; if empty, "region" where there is one, else
///   all are 0.
/// \returns the mesh, in L and mm as it was written, or
///   - kFileNotFound     there is no such file;
///   - kFileCorrupt      no whole VTU, no element, a missing node, a coordinate that is not finite,
///                       a set array with other numbers than 0 and 1, no array `regions`, or
///                       arrays that contradict each other;
///   - kMeshInvalid      a face lies on no element, is in its set twice, or an element is in a set;
///   - kFileUnsupported  shapes the solver does not know, or another byte order or compressor.
[[nodiscard]] Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file,
                                                const std::string& regions = {});

/// Reads a vector per node that write_vtu() has written, for example "displacement_mm".
///
/// \returns them in the order of the nodes; or kFileNotFound, or kFileCorrupt: no whole VTU, no
///   node array of that name with three finite numbers each.
[[nodiscard]] Result<std::vector<Vec3>> read_vtu_vectors(const std::filesystem::path& file,
                                                         const std::string& name);

}  // namespace lefort::io
