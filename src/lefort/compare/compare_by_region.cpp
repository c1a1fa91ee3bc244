#include <lefort/compare/compare_by_region.h>
#include <lefort/core/check.h>

#include <cmath>
#include <functional>
#include <span>
#include <utility>

namespace lefort::compare {
namespace {

using geometry::TriangleMesh;

constexpr double kMoved_mm = 0.5;  // Heuristic.

/// Whether both are the same surface in two states.
bool is_one_surface(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices.size() == b.vertices.size() && a.triangles == b.triangles;
}

std::vector<char> find_moved(const TriangleMesh& face_L, const TriangleMesh& before_L) {
  std::vector<char> is_moved(face_L.vertices.size(), 0);
  if (is_one_surface(face_L, before_L)) {
    for (std::size_t v = 0; v < is_moved.size(); ++v)
      is_moved[v] = (face_L.vertices[v] - before_L.vertices[v]).norm() > kMoved_mm;
    return is_moved;
  }
  const SurfaceDifference difference = measure_difference(face_L, geometry::Bvh(before_L));
  for (std::size_t v = 0; v < is_moved.size(); ++v)
    is_moved[v] = std::abs(difference.signed_mm[v]) > kMoved_mm;
  return is_moved;
}

/// \returns the statistics of all parts of one surface, including those without area, so that two
/// lists match.
std::vector<std::pair<std::string, DifferenceStatistics>> describe_parts(
    const TriangleMesh& face_L, const SurfaceDifference& difference,
    const TriangleMesh* counterpart_L, std::span<const FaceRegion> region_of) {
  std::vector<std::pair<std::string, DifferenceStatistics>> parts;
  parts.emplace_back("whole", describe(difference, [](Index) { return true; }));
  if (counterpart_L != nullptr) {
    const std::vector<char> is_moved = find_moved(face_L, *counterpart_L);
    parts.emplace_back(
        "moved", describe(difference, [&](Index v) { return is_moved[std::size_t(v)] != 0; }));
  }
  for (const FaceRegion region : kFaceRegions)
    parts.emplace_back(name_of(region), describe(difference, [&](Index v) {
                         return region_of[std::size_t(v)] == region;
                       }));
  return parts;
}

void drop_empty(std::vector<RegionDifference>& rows) {
  std::erase_if(rows, [](const RegionDifference& row) { return row.face.area_mm2 == 0.0; });
}

}  // namespace

std::vector<FaceRegion> regions_of(const TriangleMesh& face_L, const TriangleMesh* before_L,
                                   const FaceRegions& regions) {
  const bool is_carried = before_L != nullptr && is_one_surface(face_L, *before_L);
  std::vector<FaceRegion> region_of;
  region_of.reserve(face_L.vertices.size());
  for (const Vec3& v : is_carried ? before_L->vertices : face_L.vertices)
    region_of.push_back(regions.at(v));
  return region_of;
}

std::vector<RegionDifference> compare_by_region(const TriangleMesh& face_L,
                                                const SurfaceDifference& difference,
                                                const geometry::Bvh& other,
                                                const TriangleMesh* before_L,
                                                const FaceRegions& regions) {
  const std::vector<FaceRegion> region_now = regions_of(face_L, before_L, regions);
  const auto now = describe_parts(face_L, difference, before_L, region_now);
  std::vector<RegionDifference> rows;
  for (const auto& [name, face] : now) rows.push_back({name, face, std::nullopt});
  if (before_L != nullptr) {
    const auto then = describe_parts(*before_L, measure_difference(*before_L, other), &face_L,
                                     regions_of(*before_L, nullptr, regions));
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].baseline = then[k].second;
  }
  drop_empty(rows);
  return rows;
}

std::vector<RegionDifference> movement_by_region(const TriangleMesh& before_L,
                                                 std::span<const Vec3> displacement_mm,
                                                 const FaceRegions& regions) {
  LEFORT_CHECK(displacement_mm.size() == before_L.vertices.size());
  TriangleMesh after_L = before_L;
  SurfaceDifference moved{.signed_mm = {}, .area_mm2 = vertex_areas(before_L)};
  for (std::size_t v = 0; v < displacement_mm.size(); ++v) {
    after_L.vertices[v] += displacement_mm[v];
    moved.signed_mm.push_back(displacement_mm[v].norm());
  }
  std::vector<RegionDifference> rows;
  for (const auto& [name, face] :
       describe_parts(before_L, moved, &after_L, regions_of(before_L, nullptr, regions)))
    rows.push_back({name, face, std::nullopt});
  drop_empty(rows);
  return rows;
}

}  // namespace lefort::compare
