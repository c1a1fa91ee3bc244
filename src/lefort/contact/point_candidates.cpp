#include <lefort/contact/point_candidates.h>
#include <lefort/contact/weighted_quadrature.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/closest_point.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::contact {
namespace {

constexpr Index kFacesPerTask = 16;

/// A point near a face.
struct PointAtFace {
  std::uint32_t point = 0;
  double distance_mm = 0.0;
  bool is_in_front = false;
};

/// Triangles of the division of a face.
std::vector<std::array<Vec3, 3>> triangles_of(const mesh::Face& face, std::span<const Vec3> x_L) {
  const FaceDivision& division = face_division(face.shape);
  const auto nodes = mesh::nodes_of(face);
  std::vector<Vec3> vertices_L;
  for (const DivisionVertex& vertex : division.vertices) {
    Vec3& p_L = vertices_L.emplace_back(Vec3::Zero());
    for (std::size_t b = 0; b < nodes.size(); ++b)
      if (vertex.N[b] != 0.0) p_L += vertex.N[b] * x_L[std::size_t(nodes[b])];
  }
  std::vector<std::array<Vec3, 3>> triangles;
  for (const auto& [a, b, c] : division.triangles)
    triangles.push_back({vertices_L[a], vertices_L[b], vertices_L[c]});
  return triangles;
}

/// Points of a bone within `range_mm` of a face, ascending.
std::vector<PointAtFace> points_at(const mesh::Face& face, const BonePoints& points,
                                   const RigidTransform& X_LB, std::span<const Vec3> x_L,
                                   double range_mm) {
  std::vector<std::array<Vec3, 3>> triangles_B = triangles_of(face, x_L);
  const RigidTransform X_BL = X_LB.inverse();
  Box3 box_B;
  for (auto& triangle : triangles_B)
    for (Vec3& corner : triangle) box_B.extend(corner = X_BL * corner);
  const Vec3 range = Vec3::Constant(range_mm);
  std::vector<PointAtFace> found;
  points.for_each_in(Box3(box_B.min() - range, box_B.max() + range), [&](std::size_t v) {
    const Vec3& v_B = points.points_B()[v];
    double closest_mm2 = range_mm * range_mm;
    bool is_in_front = false, is_near = false;
    for (const auto& [a, b, c] : triangles_B) {
      const auto at = geometry::closest_point_on_triangle(v_B, a, b, c);
      if (!(at.squared_distance_mm2 <= closest_mm2)) continue;
      closest_mm2 = at.squared_distance_mm2;
      is_near = true;
      is_in_front = (b - a).cross(c - a).dot(v_B - at.point) > 0.0;
    }
    if (is_near) found.push_back({std::uint32_t(v), std::sqrt(closest_mm2), is_in_front});
  });
  return found;
}

/// For each point of a bone, PointCandidate::in_front_mm.
std::vector<double> in_front_mm(std::size_t count,
                                const std::vector<std::vector<PointAtFace>>& at_faces) {
  constexpr double kSame_mm = 1e-9;  // Faces at the same edge or vertex.
  std::vector<double> closest_mm(count, std::numeric_limits<double>::infinity());
  for (const auto& at_face : at_faces)
    for (const PointAtFace& at : at_face)
      closest_mm[at.point] = std::min(closest_mm[at.point], at.distance_mm);
  std::vector<double> in_front = closest_mm;
  for (const auto& at_face : at_faces)
    for (const PointAtFace& at : at_face)
      if (!at.is_in_front && at.distance_mm <= closest_mm[at.point] + kSame_mm)
        in_front[at.point] = 0.0;
  return in_front;
}

}  // namespace

PointCandidates::PointCandidates(const NodePatches& patches, std::span<const mesh::Face> faces,
                                 std::span<const BonePoints* const> points,
                                 std::span<const RigidObstacle> bones, std::span<const Vec3> x_L,
                                 double range_mm)
    : range_mm_(range_mm), patches_(patches.size()) {
  for (std::size_t bone = 0; bone < bones.size(); ++bone) {
    const std::size_t count = points[bone]->points_B().size();
    if (count == 0) continue;
    std::vector<std::vector<PointAtFace>> at_faces(faces.size());
    parallel_for(
        Index(faces.size()),
        [&](Index f) {
          at_faces[std::size_t(f)] =
              points_at(faces[std::size_t(f)], *points[bone], bones[bone].X_LB, x_L, range_mm);
        },
        kFacesPerTask);
    const std::vector<double> in_front = in_front_mm(count, at_faces);
    parallel_for(
        Index(patches.size()),
        [&](Index p) {
          std::vector<PointCandidate> all;
          for (const PatchFace& part : patches[std::size_t(p)].faces)
            for (const PointAtFace& at : at_faces[part.number])
              all.push_back({std::uint32_t(bone), at.point, at.distance_mm, in_front[at.point]});
          std::sort(all.begin(), all.end(), [](const PointCandidate& a, const PointCandidate& b) {
            return std::pair(a.point, a.distance_mm) < std::pair(b.point, b.distance_mm);
          });
          all.erase(std::unique(all.begin(), all.end(),
                                [](const PointCandidate& a, const PointCandidate& b) {
                                  return a.point == b.point;
                                }),
                    all.end());
          std::vector<PointCandidate>& candidates = patches_[std::size_t(p)];
          candidates.insert(candidates.end(), all.begin(), all.end());
        },
        kFacesPerTask);
  }
}

}  // namespace lefort::contact
