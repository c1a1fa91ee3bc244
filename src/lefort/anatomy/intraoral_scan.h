/// \file
/// Intraoral scans of a synthetic head with teeth.
#pragma once

#include <lefort/anatomy/parametric_head.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>

namespace lefort::anatomy {

/// The crowns of one jaw with up to 2.5 mm of gingiva, as in the scan of the head: an open surface.
///
/// \param head        \pre has_dentition().
/// \param is_upper    which jaw.
/// \param spacing_mm  of the grid on which the level-set functions are sampled, about the length of
///                    the edges of triangles.
/// \param noise_mm    standard deviation of the level-set functions at the points of the grid.
/// \param seed        of the noise; same bits for the same seed.
/// \returns the surface in L, outward; or the errors of extract_isosurface().
[[nodiscard]] Result<geometry::TriangleMesh> scanned_arch(const ParametricHead& head, bool is_upper,
                                                          double spacing_mm, double noise_mm,
                                                          std::uint64_t seed,
                                                          Progress& progress = Progress::none());

/// What a scan of the bite shows of both arches: triangles that face the cheeks and the lips.
///
/// \param head              \pre has_dentition().
/// \param upper_L, lower_L  of scanned_arch(), not moved.
/// \returns the surface in L, with the lower arch in occlusion.
[[nodiscard]] geometry::TriangleMesh scanned_bite(const ParametricHead& head,
                                                  const geometry::TriangleMesh& upper_L,
                                                  const geometry::TriangleMesh& lower_L);

}  // namespace lefort::anatomy
