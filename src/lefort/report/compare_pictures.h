/// \file
/// The map of a difference between faces.
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

/// The face colored by `signed_mm`, one per vertex, from the front and both three-quarters; gray
/// where it is not compared. The scale ends at 1, 2, 5, 10 or 20 mm, whatever P95 needs.
///
/// \param p95_mm  of the differences; NaN if there are none.
[[nodiscard]] Result<std::vector<ComparePicture>> draw_difference(
    const geometry::TriangleMesh& face_L, std::span<const double> signed_mm, double p95_mm,
    Progress& progress);

/// The names of these files.
[[nodiscard]] std::vector<std::string> compare_picture_names();

}  // namespace lefort::report
