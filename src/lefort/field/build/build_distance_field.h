/// \file
/// Builds a signed distance field from a bone surface.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>
#include <vector>

namespace lefort::field {

/// Construction and storage of samples. All methods give the same distances up to rounding, octrees
/// within the tolerance; they differ in time and memory.
enum class FieldMethod : std::uint8_t {
  kBricks,    ///< Bricks of samples near the surface: fastest and smallest (brick_samples.h).
  kHybrid,    ///< The paper's method: narrow band, then an octree coalesced bottom-up (coalesce.h).
  kAdaptive,  ///< Frisken's method: an octree refined top-down (top_down.h).
  kUniform,   ///< Fuhrmann's method: a sample at every lattice point (dense_samples.h).
};

/// Resolution and width of the band.
struct DistanceFieldOptions {
  FieldMethod method = FieldMethod::kBricks;
  /// Cells along an edge of the cube: a power of two, 16 to 2048 (kUniform: 1024).
  int resolution = 256;
  /// Samples closer to the surface than this are stored: 2 to resolution / 4 cells. 0: 5 cells, or
  /// resolution / 4 cells if that is less.
  double band_mm = 0.0;
  double tolerance_mm = 0.005;      ///< Octrees reproduce samples in the band within this, >= 0.
  double relative_tolerance = 0.0;  ///< Not 0: replaces tolerance_mm; fraction of the cube's edge.
  double margin_mm = 0.0;           ///< Distance between the band and the cube, >= 0.
  double side_mm = 0.0;             ///< Not 0: replaces margin_mm; edge of the cube.
  bool smooth = false;              ///< Store what DistanceField::sample_smooth() needs.
};

/// Band of a field with `band_mm`, `margin_mm` and `side_mm` 0.
///
/// \param resolution  16 to 2048.
/// \param extent_mm   longest edge of the surface's bounding box.
[[nodiscard]] double default_band_mm(int resolution, double extent_mm);

/// Samples the signed distance to `surface_B` in a band around it (paper, section 2.1).
///
/// \param surface_B  triangles counter-clockwise seen from outside. Violations are repaired where
///   this is unambiguous (prepare_surface()). The surface may be open or non-manifold: then the
///   sign is that of the closest feature, and points beyond the band of an open surface and cells
///   with sign conflicts are kUnknown.
/// \param options    resolution and width of the band.
/// \param progress   receives the fraction done and notes about repairs; may cancel.
/// \returns the field, in the frame of the surface, or
///   - kInvalidArgument  an option is out of range, or the field would be too large;
///   - kMeshInvalid      as prepare_surface(); the surface is less than 0.001 mm wide or has more
///     than 1e8 triangles;
///   - kCancelled        `progress` requested a stop.
/// \note The sign is that of the pseudonormal at the closest feature \cite baerentzen2005, or that
///   of the winding number near sign conflicts (resolve_sign_conflicts.h). The tolerance of octrees
///   holds at every sample; errors do not accumulate over levels.
/// \note The result has the same bits for any number of threads and on any processor.
[[nodiscard]] Result<DistanceField> build_distance_field(const geometry::TriangleMesh& surface_B,
                                                         const DistanceFieldOptions& options = {},
                                                         Progress& progress = Progress::none());

}  // namespace lefort::field
