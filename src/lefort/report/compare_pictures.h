/// \file
/// Pictures of the difference between two faces.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::report {

struct ComparePicture {
  std::string file;
  std::string png;
};

/// Draws the face from the front and from both three-quarter views, colored by the difference. The
/// color scale is symmetric about 0; it ends at the first of 1, 2, 5 and 10 mm that is not less
/// than `p95_mm`, else at 20 mm.
///
/// \param face_L     the face.
/// \param signed_mm  one per vertex, positive outside the other face; NaN (not compared) is gray.
/// \param p95_mm     95th percentile of the differences; NaN if there are none.
/// \param progress   of the pictures; may request a stop.
/// \returns the pictures, or the errors of SurfaceScene.
[[nodiscard]] Result<std::vector<ComparePicture>> draw_difference(
    const geometry::TriangleMesh& face_L, std::span<const double> signed_mm, double p95_mm,
    Progress& progress);

/// \returns the names of the files of draw_difference().
[[nodiscard]] std::vector<std::string> compare_picture_names();

}  // namespace lefort::report
