#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/cut_surface.h>
#include <lefort/mesh/internal/boolean_operations.h>
#include <lefort/mesh/repair_surface.h>

#include <CGAL/exceptions.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <optional>

namespace lefort::mesh {
namespace {

using geometry::TriangleMesh;

/// Displacements of the cut, tried in this order. With exact arithmetic a valid surface needs none.
/// If the cut passes through a point where the surface touches or crosses itself, a slightly
/// displaced cut often does not. All are far below the accuracy of a saw or a scanner.
constexpr std::array kShifts_mm{0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2};
constexpr double kMaxVolumeError = 1e-3;  // Fraction of the volume of the surface.

Result<void> check_half_spaces(std::span<const HalfSpace> half_spaces) {
  if (half_spaces.empty())
    return fail(ErrorCode::kInvalidArgument,
                "there are no half-spaces to cut by, must be one or more");
  for (std::size_t i = 0; i < half_spaces.size(); ++i) {
    const HalfSpace& half = half_spaces[i];
    if (!half.point.allFinite() || !half.normal.allFinite() || !(half.normal.norm() > 1e-12))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("half-space {} has point ({}, {}, {}) and normal ({}, {}, {}), must be "
                      "finite and the normal not zero",
                      i, half.point.x(), half.point.y(), half.point.z(), half.normal.x(),
                      half.normal.y(), half.normal.z()));
  }
  return {};
}

std::vector<HalfSpace> shifted_inwards(std::span<const HalfSpace> half_spaces, double shift_mm) {
  std::vector<HalfSpace> shifted(half_spaces.begin(), half_spaces.end());
  for (HalfSpace& half : shifted) half.point += shift_mm * half.normal.normalized();
  return shifted;
}

/// \returns the bounding box with a margin, so that no face of it touches the surface.
Box3 room_around(const TriangleMesh& surface) {
  Box3 box = geometry::bounding_box(surface);
  const Vec3 margin_mm = Vec3::Constant(1.0 + 0.05 * box.sizes().maxCoeff());
  box.extend(Vec3(box.min() - margin_mm));
  box.extend(Vec3(box.max() + margin_mm));
  return box;
}

/// \returns the parts inside and outside the solid; nothing if the surface crosses itself at the
/// cut, or a part would not be a surface.
std::optional<std::array<TriangleMesh, 2>> split(const TriangleMesh& surface,
                                                 const TriangleMesh& solid) {
  auto parts =
      internal::boolean_operations(surface, solid, {.in_both = true, .in_first_only = true});
  if (!parts.in_both || !parts.in_first_only) return std::nullopt;
  return {{std::move(*parts.in_both), std::move(*parts.in_first_only)}};
}

bool is_sound(const SurfaceCut& cut) {
  const double missing_mm3 = cut.inside_volume_mm3 + cut.outside_volume_mm3 - cut.whole_volume_mm3;
  return std::abs(missing_mm3) <= kMaxVolumeError * cut.whole_volume_mm3 &&
         cut.inside_volume_mm3 >= 0.0 && cut.outside_volume_mm3 >= 0.0 &&
         geometry::is_closed(cut.inside) && geometry::is_closed(cut.outside);
}

std::optional<SurfaceCut> try_to_cut(const TriangleMesh& whole, const TriangleMesh& solid,
                                     double shift_mm) {
  SurfaceCut cut;
  cut.plane_shift_mm = shift_mm;
  cut.whole_volume_mm3 = geometry::signed_volume_mm3(whole);
  if (solid.triangles.empty()) {
    cut.outside = whole;
  } else {
    auto parts = split(whole, solid);
    if (!parts) return std::nullopt;
    cut.inside = std::move((*parts)[0]);
    cut.outside = std::move((*parts)[1]);
  }
  cut.inside_volume_mm3 = geometry::signed_volume_mm3(cut.inside);
  cut.outside_volume_mm3 = geometry::signed_volume_mm3(cut.outside);
  if (!is_sound(cut)) return std::nullopt;
  return cut;
}

/// Cuts by a solid that `solid_at` displaces by each of kShifts_mm, until the cut succeeds.
Result<SurfaceCut> cut_by(const TriangleMesh& surface,
                          const std::function<TriangleMesh(const TriangleMesh&, double)>& solid_at,
                          Progress& progress) {
  LEFORT_TRY(const TriangleMesh whole, repair_surface(surface));
  for (std::size_t i = 0; i < kShifts_mm.size(); ++i) {
    progress.report(double(i) / double(kShifts_mm.size()));
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "cutting the surface was cancelled");
    try {
      if (auto cut = try_to_cut(whole, solid_at(whole, kShifts_mm[i]), kShifts_mm[i]))
        return std::move(*cut);
    } catch (const CGAL::Failure_exception&) {  // The cutting solid violates a precondition.
    } catch (const std::bad_alloc&) {
      return fail(
          ErrorCode::kMeshingFailed,
          fmt::format("cutting the surface of {} triangles needs more memory than available",
                      whole.triangle_count()));
    }
  }
  return fail(ErrorCode::kMeshingFailed,
              fmt::format("the surface of {} triangles cannot be cut: it crosses itself along the "
                          "cut, must not",
                          whole.triangle_count()));
}

}  // namespace

Result<SurfaceCut> cut_surface(const TriangleMesh& surface, std::span<const HalfSpace> half_spaces,
                               Progress& progress) {
  LEFORT_TRY_VOID(check_half_spaces(half_spaces));
  return cut_by(
      surface,
      [&](const TriangleMesh& whole, double shift_mm) {
        return convex_solid(shifted_inwards(half_spaces, shift_mm), room_around(whole));
      },
      progress);
}

Result<SurfaceCut> cut_surface(const TriangleMesh& surface, const TriangleMesh& solid,
                               Progress& progress) {
  return cut_by(
      surface,
      [&](const TriangleMesh&, double shift_mm) {
        TriangleMesh shifted = solid;
        const Vec3 by = shift_mm * Vec3(0.36, 0.48, 0.8);  // A unit vector in no anatomical plane.
        for (Vec3& vertex : shifted.vertices) vertex += by;
        return shifted;
      },
      progress);
}

}  // namespace lefort::mesh
