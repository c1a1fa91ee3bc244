/// \file
/// Moves the nodes of a slit onto its surface.
#pragma once

#include <lefort/mesh/internal/slit_faces.h>
#include <lefort/mesh/open_slit.h>

#include <span>

namespace lefort::mesh::internal {

/// Moves the nodes of the cut faces as open_slit() describes.
///
/// \param mesh         its nodes move.
/// \param surface      of the slit.
/// \param faces        is_on_slit is used.
/// \param is_inside_L  the body.
/// \returns the root mean square of the distances from the surface afterwards [mm].
double fit_to_slit(VolumeMesh& mesh, const SlitSurface& surface, std::span<const InnerFace> faces,
                   const std::function<bool(const Vec3&)>& is_inside_L);

}  // namespace lefort::mesh::internal
