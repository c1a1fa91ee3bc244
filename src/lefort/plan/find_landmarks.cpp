#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/plan/find_landmarks.h>
#include <lefort/plan/internal/landmark_rules.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

namespace lefort::plan {
namespace {

using geometry::SurfaceCrossings;
using geometry::SymmetryPlane;
using internal::HeadInF;
using internal::LandmarkList;

std::vector<Vec3> every_nth(const std::vector<Vec3>& points, Index count) {
  const Index step = std::max<Index>(1, Index(points.size()) / count);
  std::vector<Vec3> chosen;
  for (Index i = 0; i < Index(points.size()); i += step) chosen.push_back(points[std::size_t(i)]);
  return chosen;
}

/// The height below which there is no head: below the mandible, or a head's height below the vertex
/// \cite farkas1994. Shoulders are concave and symmetric, too.
double neck_mm(const HeadSurfaces& head) {
  constexpr double kHead_mm = 250.0;     // From vertex to gnathion: mean and 2.6 sigma of men.
  constexpr double kBelowChin_mm = 5.0;  // Of a head that is bent backwards.
  const double vertex_mm = geometry::bounding_box(*head.skull_L).max().z();
  const double low_mm = vertex_mm - kHead_mm;
  if (head.mandible_L == nullptr || head.mandible_L->triangles.empty()) return low_mm;
  return std::max(low_mm, geometry::bounding_box(*head.mandible_L).min().z() - kBelowChin_mm);
}

/// The triangles above a height, with the vertices that they use.
geometry::TriangleMesh part_above(const geometry::TriangleMesh& mesh, double low_mm) {
  geometry::TriangleMesh part;
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);
  for (const geometry::Triangle& triangle : mesh.triangles) {
    const auto is_above = [&](std::int32_t v) {
      return mesh.vertices[std::size_t(v)].z() >= low_mm;
    };
    if (!std::all_of(triangle.begin(), triangle.end(), is_above)) continue;
    geometry::Triangle copied = triangle;
    for (std::int32_t& v : copied) {
      std::int32_t& n = number[std::size_t(v)];
      if (n < 0) {
        n = std::int32_t(part.vertices.size());
        part.vertices.push_back(mesh.vertices[std::size_t(v)]);
      }
      v = n;
    }
    part.triangles.push_back(copied);
  }
  return part;
}

/// The symmetry plane of the skull: the best of 25 starts with few points, then with many.
SymmetryPlane find_mid_sagittal(const geometry::TriangleMesh& skull_L) {
  constexpr Index kFew = 500, kMany = 6000;
  constexpr double kStep_rad = 7.0 * std::numbers::pi / 180.0;
  const geometry::Bvh surface(skull_L);
  const Box3 box_L = geometry::bounding_box(skull_L);
  const std::vector<Vec3> few = every_nth(skull_L.vertices, kFew);
  SymmetryPlane best;
  double best_cost_mm = std::numeric_limits<double>::infinity();
  for (int yaw = -2; yaw <= 2; ++yaw)
    for (int roll = -2; roll <= 2; ++roll) {
      const Vec3 normal = Vec3(1.0, kStep_rad * yaw, kStep_rad * roll).normalized();
      const SymmetryPlane plane =
          geometry::fit_symmetry_plane(surface, few, {box_L.center(), normal});
      // Outliers count as much as a wide inlier: a plane that mirrors little of the skull is bad.
      const double cost_mm = plane.rms_mm / std::max(plane.inlier_fraction, 0.01);
      if (cost_mm >= best_cost_mm) continue;
      best_cost_mm = cost_mm;
      best = plane;
    }
  return geometry::fit_symmetry_plane(surface, every_nth(skull_L.vertices, kMany), best);
}

/// The frame of the plane, with the scan's superior direction.
RigidTransform frame_of(const SymmetryPlane& plane, const Vec3& near_L) {
  const Vec3 x = plane.normal;
  const Vec3 y = Vec3::UnitZ().cross(x).normalized();
  Mat3 R_FL;
  R_FL << x.transpose(), y.transpose(), x.cross(y).transpose();
  const Vec3 origin_L = near_L - x.dot(near_L - plane.point) * x;
  RigidTransform X_FL = RigidTransform::Identity();
  X_FL.linear() = R_FL;
  X_FL.translation() = -(R_FL * origin_L);
  return X_FL;
}

HeadInF head_in_F(const HeadSurfaces& head, const RigidTransform& X_FL) {
  const auto of = [&](const geometry::TriangleMesh* mesh_L) {
    return mesh_L == nullptr || mesh_L->triangles.empty()
               ? std::nullopt
               : std::optional(geometry::transformed(*mesh_L, X_FL));
  };
  return {*of(head.skull_L), of(head.mandible_L), of(head.skin_L), of(head.upper_teeth_L),
          of(head.lower_teeth_L)};
}

LandmarkList search_in(const HeadSurfaces& head, const internal::ScanEnds& ends,
                       const RigidTransform& X_FL) {
  const HeadInF head_F = head_in_F(head, X_FL);
  const SurfaceCrossings front(head_F.skull, 1, geometry::bounding_box(head_F.skull),
                               internal::kPixel_mm);
  const auto cavities = internal::find_facial_cavities(front);
  LandmarkList list(X_FL, ends, head.voxel_mm);
  internal::find_midface(head_F, front, cavities, list);
  internal::find_lateral(head_F, list);
  internal::find_mandible_landmarks(head_F, list);
  internal::find_skin_landmarks(head_F, cavities, list);
  return list;
}

/// The rotation about x that brings the line from Po to Or into the horizontal.
std::optional<RigidTransform> to_frankfurt(const LandmarkList& list) {
  constexpr double kMaxPitch = 0.6;  // 35 degrees: more is a wrong landmark.
  const auto mean = [&](const char* right, const char* left) -> std::optional<Vec3> {
    const auto r = list.at(right), l = list.at(left);
    if (r && l) return Vec3(0.5 * (*r + *l));
    return r ? r : l;
  };
  const auto porion = mean("Po-R", "Po-L"), orbitale = mean("Or-R", "Or-L");
  if (!porion || !orbitale) return std::nullopt;
  const Vec3 ahead = *orbitale - *porion;  // Anterior is -y.
  const double pitch = std::atan2(ahead.z(), -ahead.y());
  if (std::abs(pitch) > kMaxPitch) return std::nullopt;
  RigidTransform turn = RigidTransform::Identity();
  turn.linear() = Eigen::AngleAxisd(pitch, Vec3::UnitX()).toRotationMatrix();
  return turn;
}

}  // namespace

Landmarks LandmarkSearch::landmarks() const {
  Landmarks all;
  for (const FoundLandmark& one : found) all.push_back(one.landmark);
  return all;
}

Result<LandmarkSearch> find_landmarks(const HeadSurfaces& whole) {
  constexpr Index kMinVertices = 100;
  constexpr double kNeck_mm = 40.0;  // Of skin below the chin.
  const auto too_small = [] {
    return fail(ErrorCode::kAnatomyMissing, "the skull is too small to find landmarks on it");
  };
  if (whole.skull_L->vertex_count() < kMinVertices) return too_small();
  const double low_mm = neck_mm(whole);
  const geometry::TriangleMesh skull_L = part_above(*whole.skull_L, low_mm);
  if (skull_L.vertex_count() < kMinVertices) return too_small();
  std::optional<geometry::TriangleMesh> skin_L;
  if (whole.skin_L != nullptr) skin_L = part_above(*whole.skin_L, low_mm - kNeck_mm);
  HeadSurfaces head = whole;
  head.skull_L = &skull_L;
  if (skin_L) head.skin_L = &*skin_L;
  LandmarkSearch search;
  search.mid_sagittal_L = find_mid_sagittal(*head.skull_L);
  search.X_FL = frame_of(search.mid_sagittal_L, geometry::bounding_box(*head.skull_L).center());
  const internal::ScanEnds ends = internal::find_scan_ends(whole);
  LandmarkList list = search_in(head, ends, search.X_FL);
  if (const auto turn = to_frankfurt(list)) {
    search.X_FL = *turn * search.X_FL;
    search.has_frankfurt_horizontal = true;
    list = search_in(head, ends, search.X_FL);
  }
  search.found = list.found();
  search.missing = list.missing();
  return search;
}

}  // namespace lefort::plan
