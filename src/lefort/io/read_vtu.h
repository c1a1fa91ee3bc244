/// \file
/// Reads volume meshes from untrusted VTK XML files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::io {

/// Reads nodes, elements, their regions, and node and face sets as described in vtu.h. Elements of
/// one shape form one block; blocks are in the order of their first elements. Faces in no set form
/// the face set "region N", where N is their region. A boundary face is oriented by its element, so
/// that its normal points outward; a face between two elements has the orientation in the file.
/// Point and line cells and other fields are ignored.
///
/// Both numberings of wedges are read (internal/wedge_order.h).
///
/// \param file      with at least one element; little-endian, uncompressed or zlib.
/// \param regions   the cell array of region numbers; if empty, "region" if it exists, else all
///   regions are 0.
/// \param progress  may request a stop.
/// \returns the mesh, with the coordinates of the file, which count as mm in frame L, or
///   - kFileNotFound     the file does not exist;
///   - kFileCorrupt      not a complete VTU, no element, a missing node, a coordinate that is not
///                       finite, a set array with other numbers than 0 and 1, no array `regions`,
///                       or inconsistent arrays;
///   - kMeshInvalid      a face of no element, a face twice in a set, or an element in a set;
///   - kCancelled        `progress` requested a stop;
///   - kFileUnsupported  a shape the solver does not support, another byte order or compressor.
[[nodiscard]] Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file,
                                                const std::string& regions = {},
                                                Progress& progress = Progress::none());

/// Reads a vector per node that write_vtu() has written, for example "displacement_mm".
///
/// \param file  of write_vtu().
/// \param name  of the node array.
/// \returns the vectors in the order of the nodes; kFileNotFound; or kFileCorrupt if it is not a
///   complete VTU or has no such array of three finite numbers per node.
[[nodiscard]] Result<std::vector<Vec3>> read_vtu_vectors(const std::filesystem::path& file,
                                                         const std::string& name);

}  // namespace lefort::io
