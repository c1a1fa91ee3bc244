/// \file
/// The surface that the paper's Table 1 is rerun on.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

namespace lefort::bench {

/// How a skull of the paper's size is made from a scan.
struct SkullSurfaceOptions {
  double bone_hu = 226.0;
  int smoothing_iterations = 20;  ///< Of the windowed sinc filter.
  double pass_band = 0.1;
  Index triangles = 96'190;  ///< As in the paper, section 3.2.1.
};

/// Flying edges at `bone_hu`, the largest connected part, windowed sinc smoothing, Lindstrom-Turk
/// edge collapse to exactly `triangles`.
///
/// Done by VTK and CGAL alone, so that the benchmark's surface does not depend on our own methods.
/// \returns the surface in L, closed; kMeshInvalid if there is less bone than that, or if it does
///   not come down to the number asked for.
[[nodiscard]] Result<geometry::TriangleMesh> extract_skull(const image::CtVolume& ct,
                                                           const SkullSurfaceOptions& options = {},
                                                           Progress& progress = Progress::none());

}  // namespace lefort::bench
