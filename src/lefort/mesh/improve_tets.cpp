#include <lefort/core/check.h>
#include <lefort/core/units.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/improve_tets.h>
#include <lefort/mesh/internal/users_of_nodes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace lefort::mesh {
namespace {

/// Quality of a tetrahedron: the smallest sine of its six dihedral angles, or twice its radius
/// ratio 3 r / R, which also detects short edges, if that is less. Negative if inverted.
///
/// With the areas A and A' of the faces at an edge of length l, the sine is 3 V l / (2 A A').
double shape_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  const Vec3 bc = c - b, bd = d - b, cd = d - c;
  const Vec3 abc = ab.cross(ac), acd = ac.cross(ad), adb = ad.cross(ab);
  const double six_volumes = abc.dot(ad);
  // Twice the areas of the faces opposite to a, b, c, d.
  const double fa = bc.cross(bd).norm(), fb = acd.norm(), fc = adb.norm(), fd = abc.norm();
  const double sine =
      six_volumes * std::min({ab.norm() / (fc * fd), ac.norm() / (fb * fd), ad.norm() / (fb * fc),
                              bc.norm() / (fa * fd), bd.norm() / (fa * fc), cd.norm() / (fa * fb)});
  // r = 6V / (fa + fb + fc + fd), R = |center| / 12V.
  const double center =
      (ab.squaredNorm() * acd + ac.squaredNorm() * adb + ad.squaredNorm() * abc).norm();
  const double radius_ratio =
      6.0 * six_volumes * std::abs(six_volumes) / ((fa + fb + fc + fd) * center);
  const double shape = std::min(sine, 2.0 * radius_ratio);
  return std::isfinite(shape) ? shape : 0.0;
}

using internal::Lists;
using internal::users_of_nodes;

// Heuristic values, without a source in the literature.
constexpr double kMaxMoveRotation_deg = 20.0;  // Of a boundary face.
constexpr double kFirstStepFraction = 0.3;     // Of the shortest edge at the node.
constexpr int kSearchRounds = 8;               // The step is halved in a round without success.

class Improver {
 public:
  Improver(VolumeMesh& mesh, const InsidePredicate& is_inside, const ImproveOptions& options)
      : mesh_(&mesh),
        is_inside_(&is_inside),
        options_(options),
        faces_(triangles_of(boundary_faces(mesh))),
        tets_of_node_(users_of_nodes(mesh.node_count(), mesh.element_count(),
                                     [&](Index e) { return nodes_of(e); })),
        faces_of_node_(users_of_nodes(mesh.node_count(), Index(faces_.size()),
                                      [&](Index f) { return faces_[std::size_t(f)]; })) {}

  [[nodiscard]] std::vector<Index> bad_elements() const {
    const double wanted = std::sin(radians_from_degrees(options_.angle_deg));
    std::vector<Index> bad;
    for (Index e = 0; e < mesh_->element_count(); ++e)
      if (shape(e) < wanted) bad.push_back(e);
    return bad;
  }

  void sweep(const std::vector<Index>& bad) {
    std::vector<std::int32_t> nodes;
    for (const Index e : bad)
      for (const std::int32_t node : nodes_of(e)) nodes.push_back(node);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const std::int32_t node : nodes)
      if (options_.fixed_nodes.empty() || options_.fixed_nodes[std::size_t(node)] == 0)
        improve(std::size_t(node));
  }

 private:
  [[nodiscard]] std::span<const std::int32_t> nodes_of(Index e) const {
    return {mesh_->blocks[0].element(e), 4};
  }
  [[nodiscard]] const Vec3& at(std::int32_t node) const {
    return mesh_->nodes_L[std::size_t(node)];
  }
  [[nodiscard]] double shape(Index e) const {
    const auto nodes = nodes_of(e);
    const std::array<Vec3, 4> p{at(nodes[0]), at(nodes[1]), at(nodes[2]), at(nodes[3])};
    const double shape = shape_of(p[0], p[1], p[2], p[3]);
    return options_.with_jacobian ? std::min(shape, 2.0 * scaled_jacobian(ElementShape::kTet4, p))
                                  : shape;
  }
  [[nodiscard]] double worst_around(std::size_t node) const {
    double worst = 1.0;
    for (const Index e : tets_of_node_.of(node)) worst = std::min(worst, shape(e));
    return worst;
  }
  [[nodiscard]] Vec3 normal_of_face(Index f) const {
    const auto& [a, b, c] = faces_[std::size_t(f)];
    return (at(b) - at(a)).cross(at(c) - at(a));
  }
  [[nodiscard]] double shortest_edge_mm(std::size_t node) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const Index e : tets_of_node_.of(node))
      for (const std::int32_t other : nodes_of(e))
        if (std::size_t(other) != node)
          shortest = std::min(shortest, (at(other) - mesh_->nodes_L[node]).norm());
    return shortest;
  }

  /// \returns the unit normal of a boundary node, nothing for interior nodes.
  [[nodiscard]] std::optional<Vec3> boundary_normal(std::size_t node) const {
    const auto faces = faces_of_node_.of(node);
    if (faces.empty()) return std::nullopt;
    Vec3 sum = Vec3::Zero();
    for (const Index f : faces) sum += normal_of_face(f);
    return sum.normalized();
  }

  /// \returns the search directions: 14 in space for interior nodes, 8 tangential ones for boundary
  /// nodes.
  [[nodiscard]] static std::vector<Vec3> directions(const std::optional<Vec3>& normal) {
    std::vector<Vec3> all;
    if (!normal) {
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z)
            if (const Vec3 v(x, y, z); std::abs(x) + std::abs(y) + std::abs(z) != 2)
              if (v.squaredNorm() > 0.0) all.push_back(v.normalized());
      return all;
    }
    const Vec3 u = normal->unitOrthogonal();
    const Vec3 v = normal->cross(u);
    for (int i = 0; i < 8; ++i) {
      const double angle = radians_from_degrees(45.0 * i);
      all.push_back(std::cos(angle) * u + std::sin(angle) * v);
    }
    return all;
  }

  /// Moves the node to `p`; a boundary node is snapped to the surface from there.
  /// \returns whether that is allowed.
  bool try_move(std::size_t node, Vec3 p, const std::optional<Vec3>& normal, double step_mm,
                const std::vector<Vec3>& face_normals) {
    if (normal) {
      const auto t = find_zero_crossing(p, *normal, *is_inside_, step_mm, options_.tolerance_mm);
      if (!t) return false;
      p += *t * *normal;
    }
    mesh_->nodes_L[node] = p;
    const auto faces = faces_of_node_.of(node);
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (normal_of_face(faces[i]).normalized().dot(face_normals[i]) <
          std::cos(radians_from_degrees(kMaxMoveRotation_deg)))
        return false;
    return true;
  }

  void improve(std::size_t node) {
    const std::optional<Vec3> normal = boundary_normal(node);
    if (normal && !(normal->norm() > 0.5)) return;  // The normals of its faces cancel.
    std::vector<Vec3> face_normals;
    for (const Index f : faces_of_node_.of(node))
      face_normals.push_back(normal_of_face(f).normalized());

    const std::vector<Vec3> along = directions(normal);
    Vec3 best_p = mesh_->nodes_L[node];
    double best = worst_around(node);
    double step_mm = kFirstStepFraction * shortest_edge_mm(node);
    for (int round = 0; round < kSearchRounds; ++round) {
      const Vec3 from = best_p;
      bool any = false;
      for (const Vec3& direction : along) {
        if (!try_move(node, from + step_mm * direction, normal, step_mm, face_normals)) continue;
        const double worst = worst_around(node);
        if (!(worst > best)) continue;
        best = worst;
        best_p = mesh_->nodes_L[node];
        any = true;
      }
      if (!any) step_mm *= 0.5;
    }
    mesh_->nodes_L[node] = best_p;
  }

  VolumeMesh* mesh_;
  const InsidePredicate* is_inside_;
  ImproveOptions options_;
  std::vector<Face3> faces_;
  Lists tets_of_node_;
  Lists faces_of_node_;
};

}  // namespace

Index improve_tets(VolumeMesh& mesh, const InsidePredicate& is_inside_L,
                   const ImproveOptions& options) {
  LEFORT_CHECK(mesh.blocks.size() == 1 && mesh.blocks[0].shape == ElementShape::kTet4);
  LEFORT_CHECK(options.fixed_nodes.empty() ||
               Index(options.fixed_nodes.size()) == mesh.node_count());
  Improver improver(mesh, is_inside_L, options);
  std::vector<Index> bad = improver.bad_elements();
  for (int i = 0; i < options.sweeps && !bad.empty(); ++i) {
    improver.sweep(bad);
    bad = improver.bad_elements();
  }
  return Index(bad.size());
}

}  // namespace lefort::mesh
