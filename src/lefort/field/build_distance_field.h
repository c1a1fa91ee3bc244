/// \file
/// Turns a bone surface into a sampled signed distance field: the paper's hybrid algorithm,
/// section 2.1.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::field {

/// How finely, and how far from the surface, the distance is sampled.
struct DistanceFieldOptions {
  int resolution = 256;         ///< Cells along a side of the cube: a power of two, 16..1024.
  double band_mm = 0.0;         ///< 2 cells .. resolution / 4 cells; 0 takes three cells.
  double tolerance_mm = 0.005;  ///< Samples in the band are reproduced to this, >= 0.
  double margin_mm = 0.0;       ///< Domain beyond the band around the surface's box, >= 0.
};

/// Samples the signed distance to `surface_B` in a band around it.
///
/// \param surface_B  triangles counter-clockwise from outside; vertices at equal positions count as
///   one. It may be open or non-manifold: the sign is then that of the nearest feature, points
///   beyond the band of an open surface are kUnknown, and so are cells where the sign tears beyond
///   a rim.
/// \param progress   is told the share done, and may cancel.
/// \returns the field, in the frame of the surface, or
///   - kInvalidArgument  an option lies outside its range, or the field would be too large;
///   - kMeshInvalid      the surface is empty, not finite, without extent, too large, or closed but
///                       inside out;
///   - kCancelled        `progress` asked to stop.
/// \note The sign is that of the pseudonormal at the nearest feature \cite baerentzen2005; among
///   features equally near, faces come before edges and vertices, and lower numbers first.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<DistanceField> build_distance_field(const geometry::TriangleMesh& surface_B,
                                                         const DistanceFieldOptions& options = {},
                                                         Progress& progress = Progress::none());

}  // namespace lefort::field
