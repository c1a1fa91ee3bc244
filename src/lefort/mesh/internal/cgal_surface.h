/// \file
/// Conversion of surfaces to and from CGAL. For .cpp files of this layer only.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/assertions_behaviour.h>

namespace lefort::mesh::internal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalSurface = CGAL::Surface_mesh<Kernel::Point_3>;

/// During its lifetime, violated preconditions of CGAL throw without also printing to stderr. The
/// layer is built with CGAL_DEBUG, so that they are checked in release builds as well.
class QuietCgal {
 public:
  QuietCgal() : before_(CGAL::set_error_handler(&say_nothing)) {}
  ~QuietCgal() { CGAL::set_error_handler(before_); }
  QuietCgal(const QuietCgal&) = delete;
  QuietCgal& operator=(const QuietCgal&) = delete;

 private:
  static void say_nothing(const char*, const char*, const char*, int, const char*) {}
  CGAL::Failure_function before_;
};

/// \param mesh  a surface: no edge has more than two triangles, no vertex more than one fan.
[[nodiscard]] inline CgalSurface to_cgal(const geometry::TriangleMesh& mesh) {
  CgalSurface surface;
  for (const Vec3& p : mesh.vertices) surface.add_vertex({p.x(), p.y(), p.z()});
  const auto vertex = [](std::int32_t v) { return CgalSurface::Vertex_index(std::uint32_t(v)); };
  for (const auto& [a, b, c] : mesh.triangles) surface.add_face(vertex(a), vertex(b), vertex(c));
  return surface;
}

/// \returns vertices and triangles in the order of their numbers, without removed ones.
[[nodiscard]] inline geometry::TriangleMesh from_cgal(const CgalSurface& surface) {
  geometry::TriangleMesh mesh;
  std::vector<std::int32_t> number(surface.number_of_vertices() +
                                   surface.number_of_removed_vertices());
  for (const auto v : surface.vertices()) {
    number[std::size_t(v)] = std::int32_t(mesh.vertices.size());
    const Kernel::Point_3& p = surface.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    geometry::Triangle triangle{};
    std::size_t corner = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      triangle[corner++] = number[std::size_t(v)];
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace lefort::mesh::internal
