#include <lefort/geometry/mesh_measures.h>
#include <lefort/geometry/winding_number.h>
#include <lefort/mesh/cut_surface.h>
#include <lefort/mesh/join_parts.h>
#include <lefort/plan/cut_bones.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::plan {
namespace {

using geometry::TriangleMesh;

constexpr double kMm3PerMl = 1000.0;

Result<std::vector<mesh::HalfSpace>> half_spaces_of(const Osteotomy& osteotomy) {
  const auto bad = [&](const std::string& what) {
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("osteotomy of '{}': {}", osteotomy.segment, what));
  };
  if (osteotomy.planes.empty()) return bad("`planes` is empty, must have one or more");
  std::vector<mesh::HalfSpace> half_spaces;
  for (std::size_t i = 0; i < osteotomy.planes.size(); ++i) {
    const auto& [point_L, normal_L] = osteotomy.planes[i];
    if (!point_L.allFinite()) return bad(fmt::format("plane {}: its point is not finite", i));
    if (!normal_L.allFinite() || !(normal_L.norm() > 1e-6))
      return bad(fmt::format("plane {}: its normal has length {}, must be 1", i, normal_L.norm()));
    half_spaces.push_back({point_L, normal_L});
  }
  return half_spaces;
}

/// One shell of a surface: around a body if its volume is positive, around a cavity if not.
struct Shell {
  TriangleMesh surface;
  Box3 box;
  double volume_mm3;

  [[nodiscard]] bool is_cavity() const { return volume_mm3 < 0.0; }
  [[nodiscard]] bool contains(const Shell& other) const {
    return box.contains(other.box) &&
           geometry::winding_number(surface, other.surface.vertices[0]) > 0.5;
  }
};

std::vector<Shell> shells_of(const TriangleMesh& surface) {
  std::vector<Shell> shells;
  const geometry::Components components = geometry::connected_components(surface);
  for (std::int32_t c = 0; c < components.count; ++c) {
    Shell shell;
    shell.surface = geometry::keep_triangles(
        surface, [&](Index t) { return components.of_triangle[std::size_t(t)] == c; });
    shell.box = geometry::bounding_box(shell.surface);
    shell.volume_mm3 = geometry::signed_volume_mm3(shell.surface);
    shells.push_back(std::move(shell));
  }
  return shells;
}

/// Which shells stay with the remainder: small bodies, and the cavities in them.
std::vector<bool> find_crumbs(const std::vector<Shell>& shells, const CutBonesOptions& options) {
  double largest_mm3 = 0.0;
  for (const Shell& shell : shells) largest_mm3 = std::max(largest_mm3, shell.volume_mm3);
  const double smallest_mm3 =
      std::max(options.smallest_piece_ml * kMm3PerMl, options.smallest_piece_share * largest_mm3);
  std::vector<bool> is_crumb(shells.size());
  for (std::size_t s = 0; s < shells.size(); ++s)
    is_crumb[s] = !shells[s].is_cavity() && shells[s].volume_mm3 < smallest_mm3;
  for (std::size_t s = 0; s < shells.size(); ++s)
    for (std::size_t body = 0; shells[s].is_cavity() && body < shells.size(); ++body)
      if (is_crumb[body] && !shells[body].is_cavity() && shells[body].contains(shells[s]))
        is_crumb[s] = true;
  return is_crumb;
}

void append(TriangleMesh& to, const TriangleMesh& more) {
  const auto shift = std::int32_t(to.vertices.size());
  to.vertices.insert(to.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles)
    to.triangles.push_back({a + shift, b + shift, c + shift});
}

CutBones sort_pieces(mesh::SurfaceCut cut, const CutBonesOptions& options) {
  CutBones bones;
  const std::vector<Shell> shells = shells_of(cut.inside);
  const std::vector<bool> is_crumb = find_crumbs(shells, options);
  TriangleMesh crumbs;
  for (std::size_t s = 0; s < shells.size(); ++s) {
    append(is_crumb[s] ? crumbs : bones.segment_L, shells[s].surface);
    (is_crumb[s] ? bones.crumb_volume_mm3 : bones.segment_volume_mm3) += shells[s].volume_mm3;
    if (!shells[s].is_cavity()) ++(is_crumb[s] ? bones.crumbs : bones.segment_pieces);
  }
  bones.skull_volume_mm3 = cut.whole_volume_mm3;
  bones.remainder_volume_mm3 = cut.outside_volume_mm3 + bones.crumb_volume_mm3;
  bones.remainder_L =
      crumbs.triangles.empty() ? std::move(cut.outside) : mesh::join_parts(cut.outside, crumbs);
  return bones;
}

Result<void> check(const CutBonesOptions& options) {
  if (!(options.smallest_piece_ml >= 0.0) || !std::isfinite(options.smallest_piece_ml))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("smallest_piece_ml is {}, must be >= 0", options.smallest_piece_ml));
  if (!(options.smallest_piece_share >= 0.0 && options.smallest_piece_share <= 1.0))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("smallest_piece_share is {}, must be 0 to 1", options.smallest_piece_share));
  return {};
}

}  // namespace

Result<CutBones> cut_bones(const TriangleMesh& skull_L, const Osteotomy& osteotomy,
                           const CutBonesOptions& options, Progress& progress) {
  LEFORT_TRY_VOID(check(options));
  LEFORT_TRY(const auto half_spaces, half_spaces_of(osteotomy));
  LEFORT_TRY(mesh::SurfaceCut cut, mesh::cut_surface(skull_L, half_spaces, progress));
  const auto misses = [&](const std::string& what) {
    return fail(ErrorCode::kCutMissesBone,
                fmt::format("osteotomy of '{}': {}", osteotomy.segment, what));
  };
  if (cut.inside.triangles.empty()) return misses("no bone lies inside its planes, must some");
  if (cut.outside.triangles.empty())
    return misses("all bone lies inside its planes, some must lie outside");
  CutBones bones = sort_pieces(std::move(cut), options);
  if (bones.segment_pieces == 0)
    return misses(
        fmt::format("its planes hold {} crumbs of {:.2g} ml altogether, must hold a piece "
                    "of {} ml or more",
                    bones.crumbs, bones.crumb_volume_mm3 / kMm3PerMl, options.smallest_piece_ml));
  if (!geometry::is_closed(bones.remainder_L))
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("osteotomy of '{}': {} crumbs cannot be joined to the remainder again",
                            osteotomy.segment, bones.crumbs));
  return bones;
}

}  // namespace lefort::plan
