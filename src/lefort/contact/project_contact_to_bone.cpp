#include <lefort/contact/project_contact_to_bone.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

namespace lefort::contact {
namespace {

Vec3 twice_area(const geometry::TriangleMesh& mesh, const geometry::Triangle& corners) {
  const Vec3& a = mesh.vertices[std::size_t(corners[0])];
  return (mesh.vertices[std::size_t(corners[1])] - a)
      .cross(mesh.vertices[std::size_t(corners[2])] - a);
}

/// \returns the area-weighted normal of each vertex, not of unit length.
std::vector<Vec3> normals_of(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const geometry::Triangle& corners : mesh.triangles)
    for (const std::int32_t v : corners) normals[std::size_t(v)] += twice_area(mesh, corners);
  return normals;
}

/// \returns the barycentric coordinates of a point of a triangle.
Vec3 barycentric(const geometry::TriangleMesh& mesh, const geometry::Triangle& corners,
                 const Vec3& p) {
  const Vec3 normal = twice_area(mesh, corners);
  const double area = normal.squaredNorm();
  if (!(area > 0.0)) return Vec3::Constant(1.0 / 3.0);
  Vec3 weights;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& b = mesh.vertices[std::size_t(corners[(k + 1) % 3])];
    const Vec3& c = mesh.vertices[std::size_t(corners[(k + 2) % 3])];
    weights[Index(k)] = std::clamp((b - p).cross(c - p).dot(normal) / area, 0.0, 1.0);
  }
  return weights / weights.sum();
}

/// The tissue faces as triangles, with pressure and depth of their nodes.
struct ContactFaces {
  geometry::TriangleMesh surface_L;
  std::vector<double> pressure_mpa, depth_mm;
};

ContactFaces contact_faces(std::span<const Vec3> x_L, std::span<const mesh::Face> faces,
                           std::span<const NodalContact> at_nodes) {
  ContactFaces tissue;
  std::map<std::int32_t, std::int32_t> number;
  for (const NodalContact& node : at_nodes) {
    number.emplace(node.node, std::int32_t(number.size()));
    tissue.surface_L.vertices.push_back(x_L[std::size_t(node.node)]);
    tissue.pressure_mpa.push_back(node.pressure_mpa);
    tissue.depth_mm.push_back(node.depth_mm);
  }
  for (const mesh::Face3& face : mesh::triangles_of(faces)) {
    geometry::Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = number.at(face[k]);
    tissue.surface_L.triangles.push_back(corners);
  }
  return tissue;
}

}  // namespace

BoneContactFields project_contact_to_bone(const geometry::TriangleMesh& bone_L,
                                          std::span<const Vec3> x_L,
                                          std::span<const mesh::Face> faces,
                                          std::span<const NodalContact> at_nodes, double near_mm) {
  LEFORT_CHECK(near_mm >= 0.0);
  BoneContactFields load{std::vector<double>(bone_L.vertices.size(), 0.0),
                         std::vector<double>(bone_L.vertices.size(), 0.0)};
  if (faces.empty()) return load;
  const ContactFaces tissue = contact_faces(x_L, faces, at_nodes);
  const geometry::Bvh tree(tissue.surface_L);
  const std::vector<Vec3> normals_L = normals_of(bone_L);
  parallel_for(Index(bone_L.vertices.size()), [&](Index v) {
    const auto nearest = tree.closest_point(bone_L.vertices[std::size_t(v)], near_mm);
    if (!nearest) return;
    const geometry::Triangle& corners = tissue.surface_L.triangles[std::size_t(nearest->triangle)];
    if (twice_area(tissue.surface_L, corners).dot(normals_L[std::size_t(v)]) >= 0.0) return;
    const Vec3 weights = barycentric(tissue.surface_L, corners, nearest->point);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto node = std::size_t(corners[k]);
      load.pressure_mpa[std::size_t(v)] += weights[Index(k)] * tissue.pressure_mpa[node];
      load.depth_mm[std::size_t(v)] += weights[Index(k)] * tissue.depth_mm[node];
    }
  });
  return load;
}

}  // namespace lefort::contact
