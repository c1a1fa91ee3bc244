#include <lefort/bench/competitors.h>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <vector>

namespace lefort::bench {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

Kernel::Point_3 point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

struct CgalTree::Tree {
  Triangles triangles;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree;
};

CgalTree::CgalTree(const geometry::TriangleMesh& mesh) : tree_(std::make_unique<Tree>()) {
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    tree_->triangles.emplace_back(point(mesh.corner(t, 0)), point(mesh.corner(t, 1)),
                                  point(mesh.corner(t, 2)));
  tree_->tree.rebuild(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->tree.accelerate_distance_queries();
}

CgalTree::~CgalTree() = default;

void CgalTree::distances(std::span<const Vec3> points, std::span<double> distances_mm) const {
  for (std::size_t i = 0; i < points.size(); ++i)
    distances_mm[i] = std::sqrt(tree_->tree.squared_distance(point(points[i])));
}

}  // namespace lefort::bench
