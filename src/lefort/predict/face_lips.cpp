#include <lefort/core/check.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/face_lips.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace lefort::predict {
namespace {

/// A node has slipped beyond the border of the other lip if it lies further beside its normal at
/// the closest point than this and than half its distance.
constexpr double kBeyondBorder_mm = 0.5;
constexpr double kBeyondBorderRatio = 0.5;

LipSurface surface_of(const std::vector<mesh::Face>& faces, const mesh::VolumeMesh& tissue,
                      const OralFissure& fissure, double outward) {
  LipSurface lip;
  lip.outward = outward;
  lip.nodes = mesh::nodes_of_faces(faces);
  const auto local = [&](std::int32_t node) {
    return std::int32_t(std::lower_bound(lip.nodes.begin(), lip.nodes.end(), node) -
                        lip.nodes.begin());
  };
  for (const mesh::Face3& face : mesh::triangles_of(faces))
    lip.triangles.push_back({local(face[0]), local(face[1]), local(face[2])});
  lip.heights_mm.reserve(lip.nodes.size());
  for (const std::int32_t node : lip.nodes)
    lip.heights_mm.push_back(fissure.level(tissue.nodes_L[std::size_t(node)]));
  return lip;
}

/// Unit normals of the vertices from the lower to the upper lip, by the areas of the triangles.
std::vector<Vec3> upward_normals(const geometry::TriangleMesh& mesh, double outward) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    const Vec3 area = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a);
    for (const std::int32_t v : mesh.triangles[std::size_t(t)])
      normals[std::size_t(v)] += outward * area;
  }
  for (Vec3& normal : normals)
    normal = normal.squaredNorm() > 0.0 ? normal.normalized() : Vec3::UnitZ();
  return normals;
}

/// A lip at present: the surface of contact that moves with it.
struct PresentLip {
  const LipSurface& lip;
  std::vector<Vec3> shifts;   ///< From the nodes to the surface of contact.
  std::vector<Vec3> normals;  ///< Of that surface, from the lower to the upper lip.
  geometry::Bvh tree;         ///< Of that surface.
};

PresentLip present_lip(const LipSurface& lip, std::span<const Vec3> x_L) {
  geometry::TriangleMesh mesh{{}, lip.triangles};
  for (const std::int32_t node : lip.nodes) mesh.vertices.push_back(x_L[std::size_t(node)]);
  std::vector<Vec3> shifts = upward_normals(mesh, lip.outward);
  for (std::size_t v = 0; v < shifts.size(); ++v) {
    shifts[v] *= -lip.heights_mm[v];
    mesh.vertices[v] += shifts[v];
  }
  std::vector<Vec3> normals = upward_normals(mesh, lip.outward);
  return {lip, std::move(shifts), std::move(normals), geometry::Bvh(std::move(mesh))};
}

/// Barycentric coordinates of a point in the plane of a triangle; at a corner they are exact.
Vec3 weights_in(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (p == a) return Vec3::UnitX();
  if (p == b) return Vec3::UnitY();
  if (p == c) return Vec3::UnitZ();
  const Vec3 n = (b - a).cross(c - a);
  if (n.squaredNorm() == 0.0) return Vec3::UnitX();
  const double v = n.dot((p - a).cross(c - a)) / n.squaredNorm();
  const double w = n.dot((b - a).cross(p - a)) / n.squaredNorm();
  return {1.0 - v - w, v, w};
}

/// \returns the point of `other` that the node `v` of `own` faces, if there is one.
std::optional<FacingPoint> facing_point(const PresentLip& own, std::size_t v,
                                        const PresentLip& other) {
  const Vec3& p = own.tree.mesh().vertices[v];
  const auto nearest = other.tree.closest_point(p);
  if (!nearest) return std::nullopt;
  const geometry::TriangleMesh& mesh = other.tree.mesh();
  const geometry::Triangle& corners = mesh.triangles[std::size_t(nearest->triangle)];
  FacingPoint point;
  point.weights = weights_in(nearest->point, mesh.corner(nearest->triangle, 0),
                             mesh.corner(nearest->triangle, 1), mesh.corner(nearest->triangle, 2));
  point.nodes[0] = own.lip.nodes[v];
  Vec3 normal = Vec3::Zero();
  Vec3 shift = own.shifts[v];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto corner = std::size_t(corners[i]);
    point.nodes[i + 1] = other.lip.nodes[corner];
    if (point.nodes[i + 1] == point.nodes[0]) return std::nullopt;  // The lips are joined there.
    normal += point.weights[Index(i)] * other.lip.outward * other.normals[corner];
    shift -= point.weights[Index(i)] * other.shifts[corner];
  }
  if (normal.squaredNorm() == 0.0) return std::nullopt;
  if (other.lip.outward * own.normals[v].dot(normal) <= 0.0) return std::nullopt;  // Another sheet.
  point.normal_L = normal.normalized();
  point.rest_mm = -point.normal_L.dot(shift);
  const Vec3 distance = p - nearest->point;
  const double beside_mm = (distance - point.normal_L.dot(distance) * point.normal_L).norm();
  if (beside_mm > std::max(kBeyondBorder_mm, kBeyondBorderRatio * distance.norm()))
    return std::nullopt;
  return point;
}

std::size_t position_in(const LipSurface& lip, std::int32_t node) {
  const auto at = std::lower_bound(lip.nodes.begin(), lip.nodes.end(), node);
  LEFORT_CHECK(at != lip.nodes.end() && *at == node);
  return std::size_t(at - lip.nodes.begin());
}

}  // namespace

std::array<LipSurface, 2> lip_surfaces(const mesh::VolumeMesh& tissue, const LipSlit& lips) {
  LEFORT_CHECK(lips.is_separated() && lips.fissure);
  return {surface_of(tissue.face_sets.at(sets::kUpperLip), tissue, *lips.fissure, -1.0),
          surface_of(tissue.face_sets.at(sets::kLowerLip), tissue, *lips.fissure, 1.0)};
}

std::vector<FacingPoint> face_lips(const std::array<LipSurface, 2>& surfaces,
                                   std::span<const LipPair> pairs, std::span<const Vec3> x_L) {
  const PresentLip upper = present_lip(surfaces[0], x_L), lower = present_lip(surfaces[1], x_L);
  std::vector<FacingPoint> points;
  for (const LipPair& pair : pairs)
    for (const auto& [own, other, node] :
         {std::tie(upper, lower, pair.upper), std::tie(lower, upper, pair.lower)})
      if (auto point = facing_point(own, position_in(own.lip, node), other)) {
        point->area_mm2 = 0.5 * pair.area_mm2;
        points.push_back(*point);
      }
  return points;
}

}  // namespace lefort::predict
