#include <lefort/image/check_grid.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::image {

namespace {

constexpr double kMinSpacingMm = 1e-3;
constexpr double kMaxSpacingMm = 1e3;
constexpr double kMaxFromOriginMm = 1e7;  // Floats in files still resolve 1 mm there.
constexpr double kRotationTolerance = 1e-4;

}  // namespace

Result<void> check_grid(const Grid& grid) {
  Index voxels = 1;
  for (const Index n : grid.size) {
    // Divided, because the product of the sizes in a file may overflow.
    if (n < 1 || n > kMaxVoxels / voxels)
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the grid has {} x {} x {} voxels, expected 1 to {} in all",
                              grid.size[0], grid.size[1], grid.size[2], kMaxVoxels));
    voxels *= n;
  }
  for (const double spacing_mm : grid.spacing_mm)
    if (!(spacing_mm >= kMinSpacingMm && spacing_mm <= kMaxSpacingMm))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the grid has a spacing of {} mm, expected {} to {} mm", spacing_mm,
                              kMinSpacingMm, kMaxSpacingMm));
  for (const double x_mm : grid.origin_L)
    if (!(std::abs(x_mm) <= kMaxFromOriginMm))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the grid has an origin at {} mm, expected at most {} mm", x_mm,
                              kMaxFromOriginMm));
  const Mat3 from_rotation = grid.direction.transpose() * grid.direction - Mat3::Identity();
  const double deviation = from_rotation.cwiseAbs().maxCoeff();
  if (!grid.direction.allFinite() || deviation > kRotationTolerance)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the grid has axes that deviate by {:.2g} from being orthogonal unit "
                            "vectors, expected at most {}",
                            deviation, kRotationTolerance));
  if (grid.direction.determinant() < 0.0)
    return fail(ErrorCode::kFileCorrupt, "the grid has left-handed axes, expected a rotation");
  return {};
}

}  // namespace lefort::image
