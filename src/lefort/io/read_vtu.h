/// \file
/// Volume meshes from VTK XML files, decoded without trust: a cache may be cut off or altered.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>

namespace lefort::io {

/// Reads nodes, elements and, if there is one, the element array "region". Elements of one shape
/// make one block, shapes in the order of their first element. Node sets, which write_vtu() writes
/// as arrays "set:NAME", and other fields are not read back.
///
/// \param file  of at least one element; little-endian, plain or packed by zlib.
/// \returns the mesh, in L and mm as it was written, or
///   - kFileNotFound     there is no such file;
///   - kFileCorrupt      no whole VTU, no element, a missing node, a coordinate that is not finite,
///                       or arrays that contradict each other;
///   - kFileUnsupported  shapes the solver does not know, or another byte order or compressor.
[[nodiscard]] Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file);

}  // namespace lefort::io
