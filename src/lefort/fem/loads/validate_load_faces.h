/// \file
/// Checks of the faces that a load acts on.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>

namespace lefort::fem {

/// \param nodes_L  reference positions of all nodes [mm].
/// \param faces    that the load acts on.
/// \returns kMeshInvalid if a face names a node twice, or one that does not exist or has no finite
///   position.
[[nodiscard]] Result<void> validate_load_faces(std::span<const Vec3> nodes_L,
                                               std::span<const mesh::Face> faces);

}  // namespace lefort::fem
