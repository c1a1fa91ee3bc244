/// \file
/// Turns a bone surface into a sampled signed distance field.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>
#include <vector>

namespace lefort::field {

/// How the samples are found and kept. All give the same distances; they differ in time and memory.
enum class FieldMethod : std::uint8_t {
  kBricks,    ///< Bricks of samples near the surface: fastest and smallest (brick_samples.h).
  kHybrid,    ///< The paper's: narrow band, then an octree coalesced bottom-up (coalesce.h).
  kAdaptive,  ///< Frisken's: an octree split top-down (top_down.h).
  kUniform,   ///< Fuhrmann's: a sample at every lattice point (dense_samples.h).
};

/// How finely, and how far from the surface, the distance is sampled.
struct DistanceFieldOptions {
  FieldMethod method = FieldMethod::kBricks;
  int resolution = 256;  ///< Cells along a side of the cube: a power of two, 16..2048.
  /// Samples up to here are kept: 2 cells .. resolution / 4 cells; 0: 5 cells, or that most.
  double band_mm = 0.0;
  double tolerance_mm = 0.005;      ///< Octrees reproduce samples in the band to this, >= 0.
  double relative_tolerance = 0.0;  ///< The same as a share of the cube's side, if not 0.
  double margin_mm = 0.0;           ///< Domain beyond the band around the surface's box, >= 0.
  double side_mm = 0.0;             ///< Side of the cube, if not 0; instead of margin_mm.
  bool smooth = false;              ///< Prepare for DistanceField::sample_smooth().
};

/// Samples the signed distance to `surface_B` in a band around it (paper, section 2.1).
///
/// \param surface_B  triangles counter-clockwise from outside; what is not so is mended where that
///   is unambiguous (prepare_surface()). It may be open or non-manifold: the sign is then that of
///   the nearest feature, points beyond the band of an open surface are kUnknown, and so are cells
///   where the sign tears.
/// \param progress   is told the share done and what was mended, and may cancel.
/// \returns the field, in the frame of the surface, or
///   - kInvalidArgument  an option lies outside its range, or the field would be too large;
///   - kMeshInvalid      the surface is empty, not finite, without extent, or too large;
///   - kCancelled        `progress` asked to stop.
/// \note The sign is that of the pseudonormal at the nearest feature \cite baerentzen2005. The
///   tolerance is kept at every sample, not from level to level.
/// \note Same bits for any number of threads and any processor.
[[nodiscard]] Result<DistanceField> build_distance_field(const geometry::TriangleMesh& surface_B,
                                                         const DistanceFieldOptions& options = {},
                                                         Progress& progress = Progress::none());

}  // namespace lefort::field
