#include <lefort/field/build_distance_field.h>
#include <lefort/field/coalesce.h>
#include <lefort/field/far_sides.h>
#include <lefort/field/narrow_band.h>
#include <lefort/field/spline_lattice.h>
#include <lefort/geometry/mesh_measures.h>

#include <fmt/format.h>

#include <bit>
#include <utility>

namespace lefort::field {

namespace {

constexpr int kMinResolution = 16;
constexpr int kMaxResolution = 1024;
constexpr int kDefaultBandCells = 3;
constexpr int kMinBandCells = 2;
constexpr int kMaxBandShare = 4;  // The band is at most the cube's side divided by this.
constexpr double kMaxMargin_mm = 1e4;
constexpr double kMinExtent_mm = 1e-3;
constexpr Index kMaxTriangles = 20'000'000;  // Some 500 bytes each while the field is built.

// What sample_smooth() needs beyond the band, in cells: a cell that interpolates has a corner
// within kCellRadius of the band; the coefficients of its points lie up to two cells along each
// axis from that corner; and each coefficient needs its neighbours.
constexpr double kStencilReach = kCellRadius + 3.4642;
constexpr double kSampleReach = kStencilReach + 1.0001;
static_assert(kSampleReach < SparseLattice::kSide, "the lattice must hold what it needs");

Result<void> check_options(const DistanceFieldOptions& options) {
  const auto refuse = [](std::string message) {
    return fail(ErrorCode::kInvalidArgument, std::move(message));
  };
  if (options.resolution < kMinResolution || options.resolution > kMaxResolution ||
      !std::has_single_bit(unsigned(options.resolution)))
    return refuse(fmt::format("resolution is {}, it must be a power of two from {} to {}",
                              options.resolution, kMinResolution, kMaxResolution));
  if (!(options.margin_mm >= 0.0 && options.margin_mm <= kMaxMargin_mm))
    return refuse(
        fmt::format("margin_mm is {}, it must be from 0 to {}", options.margin_mm, kMaxMargin_mm));
  if (!(options.band_mm >= 0.0 && options.band_mm <= kMaxMargin_mm))
    return refuse(
        fmt::format("band_mm is {}, it must be from 0 to {}", options.band_mm, kMaxMargin_mm));
  if (!(options.tolerance_mm >= 0.0 && options.tolerance_mm <= kMaxMargin_mm))
    return refuse(fmt::format("tolerance_mm is {}, it must be from 0 to {}", options.tolerance_mm,
                              kMaxMargin_mm));
  return {};
}

/// Lays the cube around the surface so that the band fits into it.
Result<FieldFrame> lay_cube(const geometry::TriangleMesh& mesh,
                            const DistanceFieldOptions& options) {
  const Box3 box = geometry::bounding_box(mesh);
  const double extent = box.sizes().maxCoeff();
  if (!(extent >= kMinExtent_mm))
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("the surface is {} mm wide, it must be at least {} mm", extent, kMinExtent_mm));
  FieldFrame frame;
  frame.resolution = options.resolution;
  frame.tolerance_mm = options.tolerance_mm;
  if (options.band_mm > 0.0) {
    frame.cell_mm = (extent + 2.0 * (options.band_mm + options.margin_mm)) / options.resolution;
    frame.band_mm = options.band_mm;
  } else {
    frame.cell_mm =
        (extent + 2.0 * options.margin_mm) / (options.resolution - 2 * kDefaultBandCells);
    frame.band_mm = kDefaultBandCells * frame.cell_mm;
  }
  const double least = kMinBandCells * frame.cell_mm;
  const double most = options.resolution / kMaxBandShare * frame.cell_mm;
  if (!(frame.band_mm >= least && frame.band_mm <= most))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("band_mm is {}, it must be from {:.3g} ({} cells) to {:.3g} (a quarter "
                            "of the cube) at resolution {}",
                            frame.band_mm, least, kMinBandCells, most, options.resolution));
  const double side = frame.cell_mm * frame.resolution;
  frame.origin_B = box.center() - Vec3::Constant(0.5 * side);
  return frame;
}

/// \returns whether the surface encloses a volume.
Result<bool> check_orientation(const geometry::TriangleMesh& mesh) {
  if (geometry::first_unbalanced_edge(mesh)) return false;
  const double volume = geometry::signed_volume_mm3(mesh);
  if (volume < 0.0)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the closed surface encloses {:.6g} mm^3, it must enclose a positive "
                            "volume: its triangles are clockwise seen from outside",
                            volume));
  return true;
}

}  // namespace

Result<DistanceField> build_distance_field(const geometry::TriangleMesh& surface_B,
                                           const DistanceFieldOptions& options,
                                           Progress& progress) {
  LEFORT_TRY_VOID(check_options(options));
  if (surface_B.triangle_count() > kMaxTriangles)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the surface has {} triangles, at most {} are possible",
                            surface_B.triangle_count(), kMaxTriangles));
  LEFORT_TRY_VOID(geometry::check_surface(surface_B));
  const geometry::TriangleMesh mesh_B = geometry::weld_vertices(surface_B);
  if (mesh_B.triangles.empty())
    return fail(ErrorCode::kMeshInvalid,
                "all triangles of the surface are points or lines, one must have three corners");
  LEFORT_TRY(FieldFrame frame, lay_cube(mesh_B, options));
  LEFORT_TRY(frame.closed, check_orientation(mesh_B));

  progress.begin_stage("distances near the bone");
  LEFORT_TRY(
      SparseLattice distances,
      sample_narrow_band(mesh_B, frame, frame.band_mm + kSampleReach * frame.cell_mm, progress));
  SparseLattice smooth =
      spline_coefficients(distances, frame.cell_mm, frame.band_mm + kStencilReach * frame.cell_mm);
  const SidedDistances sided = fill_far_sides(std::move(distances), frame.closed);
  progress.begin_stage("unite cells of the distance field");
  LEFORT_TRY(Octree octree, coalesce(sided, frame, progress));
  progress.report(1.0);
  return DistanceField(frame, std::move(octree), std::move(smooth));
}

}  // namespace lefort::field
