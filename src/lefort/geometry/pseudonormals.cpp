#include <lefort/core/parallel.h>
#include <lefort/geometry/pseudonormals.h>

#include <cmath>
#include <numbers>
#include <span>

namespace lefort::geometry {

namespace {

/// Most triangles without area that are crossed to find a normal.
constexpr int kMaxSteps = 32;
constexpr Index kBlock = 4096;
// Sum of the angles around a vertex of a flat surface.
constexpr double kFullTurn = 2.0 * std::numbers::pi;

double side_length(const TriangleMesh& mesh, Index triangle, int side) {
  return (mesh.corner(triangle, (side + 1) % 3) - mesh.corner(triangle, side)).norm();
}

/// Finds the normals that stand for triangles without area.
class Beyond {
 public:
  Beyond(const TriangleMesh& mesh, const EdgeIncidence& edges, std::span<const Vec3> of_face)
      : mesh_(mesh), edges_(edges), of_face_(of_face) {}

  /// The normal of a triangle at its edge `side`; if the triangle has no area, that of the triangle
  /// beyond it. A cap (three collinear corners) extends the neighbor at its longest edge, or, if
  /// entered from there, those at the short edges; a needle extends the neighbor at its opposite
  /// long edge.
  [[nodiscard]] Vec3 normal_at_side(Index triangle, int side) const {
    for (int step = 0; step < kMaxSteps; ++step) {
      if (!normal(triangle).isZero()) return normal(triangle);
      const int next = (side + 1) % 3, previous = (side + 2) % 3;
      side = side_length(mesh_, triangle, next) >= side_length(mesh_, triangle, previous)
                 ? next
                 : previous;
      const HalfEdge* other = across(triangle, side);
      if (other == nullptr) break;
      triangle = other->triangle();
      side = other->side();
    }
    return Vec3::Zero();
  }

  /// The same at a corner: through the opposite edge.
  [[nodiscard]] Vec3 normal_at_corner(Index triangle, int corner) const {
    if (!normal(triangle).isZero()) return normal(triangle);
    const HalfEdge* other = across(triangle, (corner + 1) % 3);
    return other == nullptr ? Vec3(Vec3::Zero()) : normal_at_side(other->triangle(), other->side());
  }

 private:
  [[nodiscard]] const Vec3& normal(Index triangle) const { return of_face_[std::size_t(triangle)]; }

  /// The first other triangle at an edge, preferably one with area.
  [[nodiscard]] const HalfEdge* across(Index triangle, int side) const {
    const Triangle& t = mesh_.triangles[std::size_t(triangle)];
    const auto [smaller, larger] =
        std::minmax(t[std::size_t(side)], t[std::size_t((side + 1) % 3)]);
    const HalfEdge* found = nullptr;
    edges_.for_each_edge_at(
        smaller, [&, wanted = larger](std::int32_t, std::int32_t end, auto edges) {
          if (end != wanted) return;
          for (const HalfEdge& s : edges) {
            if (s.triangle() == triangle) continue;
            if (found == nullptr ||
                (normal(found->triangle()).isZero() && !normal(s.triangle()).isZero()))
              found = &s;
          }
        });
    return found;
  }

  const TriangleMesh& mesh_;
  const EdgeIncidence& edges_;
  std::span<const Vec3> of_face_;
};

double corner_angle(const TriangleMesh& mesh, Index triangle, int corner) {
  const Vec3& at = mesh.corner(triangle, corner);
  const Vec3 u = mesh.corner(triangle, (corner + 1) % 3) - at;
  const Vec3 v = mesh.corner(triangle, (corner + 2) % 3) - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// True if a sum of vectors with this total length is zero up to rounding, as for the two edges of
/// a sheet.
bool cancels(const Vec3& sum, double length) { return !(sum.norm() > 1e-12 * length); }

/// Direction of a sum of normals weighted by the angles around a vertex.
Vec3 direction_of(const Vec3& sum) {
  return cancels(sum, kFullTurn) ? Vec3(Vec3::Zero()) : Vec3(sum.stableNormalized());
}

/// An edge that is not shared by exactly two triangles with area.
struct IrregularEdge {
  std::span<const HalfEdge> edges;
};

}  // namespace

Vec3 face_normal(const TriangleMesh& mesh, Index triangle) {
  const Vec3 &a = mesh.corner(triangle, 0), &b = mesh.corner(triangle, 1),
             &c = mesh.corner(triangle, 2);
  if (triangle_is_degenerate(a, b, c)) return Vec3::Zero();
  return (b - a).cross(c - a).normalized();
}

Pseudonormals::Pseudonormals(const TriangleMesh& mesh, const EdgeIncidence& edges)
    : of_face_(mesh.triangles.size()),
      at_vertex_(mesh.vertices.size()),
      opposite_triangle_(mesh.triangles.size()) {
  parallel_for(
      mesh.triangle_count(), [&](Index t) { of_face_[std::size_t(t)] = face_normal(mesh, t); },
      kBlock);
  const Beyond beyond(mesh, edges, of_face_);

  const auto has_area = [&](const HalfEdge& s) {
    return !of_face_[std::size_t(s.triangle())].isZero();
  };
  const auto beyond_side = [&](const HalfEdge& s) -> std::int32_t& {
    return opposite_triangle_[std::size_t(s.triangle())][std::size_t(s.side())];
  };
  const auto odd_edges = parallel_collect<IrregularEdge>(
      mesh.vertex_count(), [&](Index vertex, std::vector<IrregularEdge>& odd) {
        edges.for_each_edge_at(std::int32_t(vertex), [&](std::int32_t, std::int32_t, auto there) {
          if (there.size() == 2 && has_area(there[0]) && has_area(there[1])) {
            beyond_side(there[0]) = std::int32_t(there[1].triangle());
            beyond_side(there[1]) = std::int32_t(there[0].triangle());
          } else {
            odd.push_back({there});
          }
        });
      });
  for (const IrregularEdge& edge : odd_edges) {
    Vec3 sum = Vec3::Zero();
    for (const HalfEdge& s : edge.edges) {
      beyond_side(s) = ~std::int32_t(of_irregular_edge_.size());
      sum += beyond.normal_at_side(s.triangle(), s.side());
    }
    of_irregular_edge_.push_back(cancels(sum, double(edge.edges.size())) ? Vec3(Vec3::Zero())
                                                                         : sum);
  }
  find_corners(mesh, edges);
}

/// Calls body(triangle, corner) for each triangle of the fan around a vertex; most vertices have
/// exactly one fan.
///
/// \returns false if an irregular edge or another fan prevents it from visiting all triangles.
template <class Body>
bool Pseudonormals::walk_around(const TriangleMesh& mesh, std::int32_t vertex,
                                const Body& body) const {
  const Corners& at = at_vertex_[std::size_t(vertex)];
  const std::int32_t first = at.first / 3;
  std::int32_t triangle = first, corner = at.first % 3;
  std::int32_t side = (corner + 2) % 3;  // Through which the current triangle is left.
  std::int32_t count = 0;
  do {
    const Triangle& here = mesh.triangles[std::size_t(triangle)];
    const std::int32_t other_end = here[std::size_t(side == corner ? (corner + 1) % 3 : side)];
    body(triangle, corner);
    ++count;
    triangle = opposite_triangle_[std::size_t(triangle)][std::size_t(side)];
    if (triangle < 0) return false;
    const Triangle& next = mesh.triangles[std::size_t(triangle)];
    corner = next[0] == vertex ? 0 : next[1] == vertex ? 1 : 2;
    side = next[std::size_t((corner + 1) % 3)] == other_end ? (corner + 2) % 3 : corner;
  } while (triangle != first && count < at.count);
  return triangle == first && count == at.count;
}

/// Finds the triangles at each vertex, and the normals of vertices that are not surrounded by one
/// fan.
void Pseudonormals::find_corners(const TriangleMesh& mesh, const EdgeIncidence& edges) {
  for (std::int32_t t = std::int32_t(mesh.triangle_count()) - 1; t >= 0; --t)
    for (std::int32_t corner = 2; corner >= 0; --corner) {
      const auto v = std::size_t(mesh.triangles[std::size_t(t)][std::size_t(corner)]);
      at_vertex_[v] = {3 * t + corner, at_vertex_[v].count + 1};
    }
  const std::vector<std::int32_t> odd = parallel_collect<std::int32_t>(
      mesh.vertex_count(), [&](Index v, std::vector<std::int32_t>& others) {
        if (at_vertex_[std::size_t(v)].count > 0 &&
            !walk_around(mesh, std::int32_t(v), [](std::int32_t, std::int32_t) {}))
          others.push_back(std::int32_t(v));
      });
  if (odd.empty()) return;

  for (std::size_t i = 0; i < odd.size(); ++i)
    at_vertex_[std::size_t(odd[i])].first = ~std::int32_t(i);
  of_irregular_vertex_.assign(odd.size(), Vec3::Zero());
  const Beyond beyond(mesh, edges, of_face_);
  for (std::int32_t t = 0; t < std::int32_t(mesh.triangle_count()); ++t)
    for (std::int32_t corner = 0; corner < 3; ++corner) {
      const auto v = std::size_t(mesh.triangles[std::size_t(t)][std::size_t(corner)]);
      if (at_vertex_[v].first < 0)
        of_irregular_vertex_[std::size_t(~at_vertex_[v].first)] +=
            corner_angle(mesh, t, corner) * beyond.normal_at_corner(t, corner);
    }
  for (Vec3& sum : of_irregular_vertex_) sum = direction_of(sum);
}

Vec3 Pseudonormals::at_vertex(const TriangleMesh& mesh, Index vertex) const {
  const Corners& at = at_vertex_[std::size_t(vertex)];
  if (at.first < 0)
    return at.count > 0 ? of_irregular_vertex_[std::size_t(~at.first)] : Vec3(Vec3::Zero());
  Vec3 sum = Vec3::Zero();
  walk_around(mesh, std::int32_t(vertex), [&](std::int32_t triangle, std::int32_t corner) {
    sum += corner_angle(mesh, triangle, corner) * of_face_[std::size_t(triangle)];
  });
  return direction_of(sum);
}

Vec3 Pseudonormals::at(const TriangleMesh& mesh, Index triangle, Feature feature) const {
  const auto number = std::size_t(number_of(feature));
  if (is_vertex(feature)) return at_vertex(mesh, mesh.triangles[std::size_t(triangle)][number]);
  const Vec3& here = of_face_[std::size_t(triangle)];
  if (!is_edge(feature)) return here;
  const std::int32_t other = opposite_triangle_[std::size_t(triangle)][number];
  if (other < 0) return of_irregular_edge_[std::size_t(~other)];
  const Vec3 sum = here + of_face_[std::size_t(other)];
  return cancels(sum, 2.0) ? Vec3(Vec3::Zero()) : sum;
}

}  // namespace lefort::geometry
