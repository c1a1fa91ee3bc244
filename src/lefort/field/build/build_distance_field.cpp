#include <lefort/field/build/build_bricks.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/build/coalesce.h>
#include <lefort/field/build/top_down.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/dense_samples.h>
#include <lefort/field/storage/spline_lattice.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

namespace lefort::field {

namespace {

constexpr int kMinResolution = 16;
constexpr int kMaxResolution = 2048;
constexpr int kMaxDenseResolution = 1024;
constexpr int kDefaultBandCells = 5;
constexpr int kMinBandCells = 2;
constexpr int kMaxBandFraction = 4;  // The band is at most the cube's edge divided by this.
constexpr double kMaxLength_mm = 1e4;
constexpr double kMinExtent_mm = 1e-3;
constexpr Index kMaxTriangles = 100'000'000;

// Distance beyond the band that sample_smooth() needs, in cells: its values lie up to two cells
// along each axis from the corners of a cell, and one corner may be a cell diagonal beyond the
// band.
constexpr double kStencilCells = 4.4;
static_assert(kStencilCells < SparseLattice::kSide, "the lattice must contain the stencil");

int default_band_cells(int resolution) {
  return std::min(kDefaultBandCells, resolution / kMaxBandFraction);
}

Result<void> check_options(const DistanceFieldOptions& options) {
  const auto invalid = [](std::string message) {
    return fail(ErrorCode::kInvalidArgument, std::move(message));
  };
  const int maximum =
      options.method == FieldMethod::kUniform ? kMaxDenseResolution : kMaxResolution;
  if (options.resolution < kMinResolution || options.resolution > maximum ||
      !std::has_single_bit(unsigned(options.resolution)))
    return invalid(fmt::format("resolution is {}, it must be a power of two from {} to {}",
                               options.resolution, kMinResolution, maximum));
  const auto check_length = [&](const char* name, double length) -> Result<void> {
    if (length >= 0.0 && length <= kMaxLength_mm) return {};
    return invalid(fmt::format("{} is {}, it must be from 0 to {}", name, length, kMaxLength_mm));
  };
  LEFORT_TRY_VOID(check_length("margin_mm", options.margin_mm));
  LEFORT_TRY_VOID(check_length("side_mm", options.side_mm));
  LEFORT_TRY_VOID(check_length("band_mm", options.band_mm));
  LEFORT_TRY_VOID(check_length("tolerance_mm", options.tolerance_mm));
  if (!(options.relative_tolerance >= 0.0 && options.relative_tolerance <= 1.0))
    return invalid(fmt::format("relative_tolerance is {}, it must be from 0 to 1",
                               options.relative_tolerance));
  return {};
}

/// Positions the cube so that it contains the surface and the band.
Result<FieldFrame> position_cube(const geometry::TriangleMesh& mesh,
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
  const int band_cells = default_band_cells(options.resolution);
  if (options.side_mm > 0.0) {
    frame.cell_mm = options.side_mm / options.resolution;
  } else if (options.band_mm > 0.0) {
    frame.cell_mm = (extent + 2.0 * (options.band_mm + options.margin_mm)) / options.resolution;
  } else {
    frame.cell_mm = (extent + 2.0 * options.margin_mm) / (options.resolution - 2 * band_cells);
  }
  frame.band_mm = options.band_mm > 0.0 ? options.band_mm : band_cells * frame.cell_mm;
  const double minimum = kMinBandCells * frame.cell_mm;
  const double maximum = options.resolution / kMaxBandFraction * frame.cell_mm;
  if (!(frame.band_mm >= minimum && frame.band_mm <= maximum))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("band_mm is {}, it must be from {:.3g} ({} cells) to {:.3g} (a quarter "
                            "of the cube) at resolution {}",
                            frame.band_mm, minimum, kMinBandCells, maximum, options.resolution));
  const double side = frame.cell_mm * frame.resolution;
  if (options.relative_tolerance > 0.0) frame.tolerance_mm = options.relative_tolerance * side;
  if (side < (extent + 2.0 * frame.band_mm) * (1.0 - 1e-12))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("side_mm is {}, it must be at least {:.4g} for the surface and the band "
                    "on both sides",
                    options.side_mm, extent + 2.0 * frame.band_mm));
  frame.origin_B = box.center() - Vec3::Constant(0.5 * side);
  return frame;
}

Result<DistanceField::Samples> build_samples(const PreparedSurface& surface,
                                             const FieldFrame& frame, FieldMethod method,
                                             const WindingScanlines* winding, Progress& progress) {
  if (method == FieldMethod::kAdaptive) return split_top_down(surface, frame, winding, progress);
  if (method == FieldMethod::kHybrid) {
    LEFORT_TRY(SparseLattice distances,
               sample_narrow_band(surface, frame, frame.band_mm, winding, progress));
    const SignedDistances completed = fill_outside_band(std::move(distances), frame, winding);
    progress.begin_stage("coalesce cells of the distance field");
    return coalesce(completed, frame, progress);
  }
  LEFORT_TRY(const BandSampler sampler,
             BandSampler::create(surface, frame, frame.band_mm, BandSampler::kMaxPoints, progress));
  if (method == FieldMethod::kUniform) return build_dense(sampler, frame, winding, progress);
  return build_bricks(sampler, frame, winding, nullptr, progress);
}

/// Samples in the band, and the spline around it.
struct SmoothSamples {
  DistanceField::Samples samples;
  SparseLattice spline;
};

/// Bricks have both from the same distances.
Result<SmoothSamples> build_smooth(const PreparedSurface& surface, const FieldFrame& frame,
                                   FieldMethod method, const WindingScanlines* winding,
                                   Progress& progress) {
  const double max_distance_mm = frame.band_mm + kStencilCells * frame.cell_mm;
  if (method != FieldMethod::kBricks) {
    LEFORT_TRY(auto samples, build_samples(surface, frame, method, winding, progress));
    progress.begin_stage("compute smooth distances");
    LEFORT_TRY(const SparseLattice distances,
               sample_narrow_band(surface, frame, max_distance_mm, winding, progress));
    return SmoothSamples{std::move(samples),
                         spline_lattice(distances, frame.cell_mm, max_distance_mm)};
  }
  LEFORT_TRY(
      const BandSampler sampler,
      BandSampler::create(surface, frame, max_distance_mm, BandSampler::kMaxFloatPoints, progress));
  const std::span<const std::int32_t> bricks = sampler.bricks();
  SparseLattice distances(frame.resolution, {bricks.begin(), bricks.end()}, kUnsampled);
  LEFORT_TRY(auto samples, build_bricks(sampler, frame, winding, &distances, progress));
  progress.begin_stage("compute smooth distances");
  return SmoothSamples{std::move(samples),
                       spline_lattice(distances, frame.cell_mm, max_distance_mm)};
}

}  // namespace

double default_band_mm(int resolution, double extent_mm) {
  const int cells = default_band_cells(resolution);
  return cells * (extent_mm / (resolution - 2 * cells));
}

Result<DistanceField> build_distance_field(const geometry::TriangleMesh& surface_B,
                                           const DistanceFieldOptions& options,
                                           Progress& progress) {
  LEFORT_TRY_VOID(check_options(options));
  if (surface_B.triangle_count() > kMaxTriangles)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the surface has {} triangles, at most {} are possible",
                            surface_B.triangle_count(), kMaxTriangles));
  LEFORT_TRY(const PreparedSurface surface, prepare_surface(surface_B));
  for (const std::string& sentence : describe(surface.report)) progress.note(sentence);
  LEFORT_TRY(FieldFrame frame, position_cube(surface.mesh_B, options));
  frame.closed = surface.closed;

  progress.begin_stage("compute distances");
  std::optional<WindingScanlines> scanlines;
  if (surface.closed) scanlines.emplace(surface.mesh_B, frame);
  const WindingScanlines* const winding = scanlines ? &*scanlines : nullptr;
  const FieldSource source{surface.mesh_B.triangle_count(), surface.components, surface.report};
  if (!options.smooth) {
    LEFORT_TRY(DistanceField::Samples samples,
               build_samples(surface, frame, options.method, winding, progress));
    progress.report(1.0);
    return DistanceField(frame, std::move(samples), std::nullopt, source);
  }
  LEFORT_TRY(SmoothSamples made, build_smooth(surface, frame, options.method, winding, progress));
  progress.report(1.0);
  return DistanceField(frame, std::move(made.samples), std::move(made.spline), source);
}

}  // namespace lefort::field
