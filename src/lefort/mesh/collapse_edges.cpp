#include <lefort/core/check.h>
#include <lefort/core/units.h>
#include <lefort/mesh/collapse_edges.h>
#include <lefort/mesh/element_quality.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::mesh {
namespace {

using Nodes = std::vector<std::int32_t>;
using Tet = std::array<std::int32_t, 4>;
using NodePair = std::array<std::int32_t, 2>;

constexpr double kMaxCollapseRotation_deg = 25.0;  // Of a boundary face. Heuristic.

template <class T>
void sort_unique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

bool has(const Tet& tet, std::int32_t node) {
  return std::find(tet.begin(), tet.end(), node) != tet.end();
}

Tet with(Tet tet, std::int32_t from, std::int32_t to) {
  std::replace(tet.begin(), tet.end(), from, to);
  return tet;
}

/// The faces of a tetrahedron, counter-clockwise seen from outside (VTK).
std::array<Face3, 4> faces_of_tet(const Tet& t) {
  return {{{t[0], t[1], t[3]}, {t[1], t[2], t[3]}, {t[2], t[0], t[3]}, {t[0], t[2], t[1]}}};
}

class Collapser {
 public:
  explicit Collapser(const VolumeMesh& mesh)
      : nodes_L_(mesh.nodes_L), tets_of_(mesh.nodes_L.size()) {
    const ElementBlock& block = mesh.blocks[0];
    for (Index e = 0; e < block.element_count(); ++e) {
      Tet tet{};
      std::copy_n(block.element(e), 4, tet.begin());
      for (const std::int32_t node : tet) tets_of_[std::size_t(node)].push_back(std::int32_t(e));
      tets_.push_back(tet);
    }
    is_there_.assign(tets_.size(), 1);
  }

  /// \returns whether an edge of the element was collapsed.
  bool try_at(std::int32_t e, double limit) {
    if (is_there_[std::size_t(e)] == 0 || !(quality(tets_[std::size_t(e)]) < limit)) return false;
    std::pair best{-1.0, -1.0};  // Quality up to the limit, then cosine of the rotation of faces.
    NodePair best_edge{};
    const Tet tet = tets_[std::size_t(e)];
    for (const std::int32_t from : tet)
      for (const std::int32_t to : tet) {
        if (from == to) continue;
        const auto [quality, cosine] = after(from, to);
        const std::pair found{std::min(quality, limit), cosine};
        if (!(found > best)) continue;
        best = found;
        best_edge = {from, to};
      }
    if (!(best.first > 0.0)) return false;
    collapse(best_edge[0], best_edge[1]);
    return true;
  }

  [[nodiscard]] double quality(const Tet& tet) const {
    std::array<Vec3, 4> points;
    for (std::size_t n = 0; n < 4; ++n) points[n] = nodes_L_[std::size_t(tet[n])];
    return scaled_jacobian(ElementShape::kTet4, points);
  }

  [[nodiscard]] std::int32_t size() const { return std::int32_t(tets_.size()); }
  [[nodiscard]] const Tet& tet(std::int32_t e) const { return tets_[std::size_t(e)]; }

  void write_to(VolumeMesh& mesh) const {
    std::vector<std::int32_t> number(nodes_L_.size(), -1);
    VolumeMesh out;
    for (std::size_t n = 0; n < nodes_L_.size(); ++n) {
      if (tets_of_[n].empty()) continue;
      number[n] = std::int32_t(out.nodes_L.size());
      out.nodes_L.push_back(nodes_L_[n]);
    }
    ElementBlock& block = out.blocks.emplace_back();
    for (std::size_t e = 0; e < tets_.size(); ++e) {
      if (is_there_[e] == 0) continue;
      for (const std::int32_t node : tets_[e]) block.nodes.push_back(number[std::size_t(node)]);
      block.region.push_back(mesh.blocks[0].region[e]);
    }
    mesh.nodes_L = std::move(out.nodes_L);
    mesh.blocks = std::move(out.blocks);
  }

 private:
  [[nodiscard]] const Tet& at(std::int32_t e) const { return tets_[std::size_t(e)]; }
  [[nodiscard]] const std::vector<std::int32_t>& around(std::int32_t node) const {
    return tets_of_[std::size_t(node)];
  }

  [[nodiscard]] Nodes neighbors(std::int32_t node) const {
    Nodes all;
    for (const std::int32_t e : around(node))
      for (const std::int32_t other : at(e))
        if (other != node) all.push_back(other);
    sort_unique(all);
    return all;
  }

  /// The edges opposite to the node in the triangles around it.
  [[nodiscard]] std::vector<NodePair> opposite_edges(std::int32_t node) const {
    std::vector<NodePair> all;
    for (const std::int32_t e : around(node))
      for (const std::int32_t a : at(e))
        for (const std::int32_t b : at(e))
          if (a < b && a != node && b != node) all.push_back({a, b});
    sort_unique(all);
    return all;
  }

  /// \returns the boundary faces at the node, oriented as in their element.
  [[nodiscard]] std::vector<Face3> boundary_at(std::int32_t node) const {
    std::vector<std::pair<Face3, Face3>> faces;  // Sorted, and as it is.
    for (const std::int32_t e : around(node))
      for (const Face3& face : faces_of_tet(at(e))) {
        if (std::find(face.begin(), face.end(), node) == face.end()) continue;
        Face3 key = face;
        std::sort(key.begin(), key.end());
        faces.push_back({key, face});
      }
    std::sort(faces.begin(), faces.end());
    std::vector<Face3> single;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const bool like_last = f > 0 && faces[f - 1].first == faces[f].first;
      const bool like_next = f + 1 < faces.size() && faces[f + 1].first == faces[f].first;
      if (!like_last && !like_next) single.push_back(faces[f].second);
    }
    return single;
  }

  [[nodiscard]] Vec3 normal(const Face3& face) const {
    const Vec3& p = nodes_L_[std::size_t(face[0])];
    return (nodes_L_[std::size_t(face[1])] - p)
        .cross(nodes_L_[std::size_t(face[2])] - p)
        .normalized();
  }

  /// \returns the cosine of the largest rotation of a boundary face; -1 if the result would not be
  /// a surface.
  [[nodiscard]] double cosine_of_rotation(std::int32_t from, std::int32_t to) const {
    const std::vector<Face3> faces = boundary_at(from);
    if (faces.empty()) return 1.0;  // An interior node: no boundary face changes.
    const auto with_to = std::count_if(faces.begin(), faces.end(), [&](const Face3& face) {
      return std::find(face.begin(), face.end(), to) != face.end();
    });
    if (with_to != 2) return -1.0;  // Not an edge of the boundary.
    Nodes near_from, near_to, both;
    for (const Face3& face : faces) near_from.insert(near_from.end(), face.begin(), face.end());
    for (const Face3& face : boundary_at(to))
      near_to.insert(near_to.end(), face.begin(), face.end());
    sort_unique(near_from);
    sort_unique(near_to);
    std::set_intersection(near_from.begin(), near_from.end(), near_to.begin(), near_to.end(),
                          std::back_inserter(both));
    if (both.size() != 4) return -1.0;  // The ends, and the tips of the two faces between them.
    double smallest = 1.0;
    for (const Face3& face : faces) {
      if (std::find(face.begin(), face.end(), to) != face.end()) continue;
      Face3 moved_face = face;
      std::replace(moved_face.begin(), moved_face.end(), from, to);
      smallest = std::min(smallest, normal(face).dot(normal(moved_face)));
    }
    return smallest;
  }

  [[nodiscard]] bool keeps_topology(std::int32_t from, std::int32_t to) const {
    Nodes ring;
    std::vector<NodePair> ring_edges;
    for (const std::int32_t e : around(from)) {
      if (!has(at(e), to)) continue;
      for (const std::int32_t a : at(e))
        for (const std::int32_t b : at(e)) {
          if (a == from || a == to || b == from || b == to) continue;
          if (a == b) ring.push_back(a);
          if (a < b) ring_edges.push_back({a, b});
        }
    }
    sort_unique(ring);
    sort_unique(ring_edges);
    const auto same = [](const auto& a, const auto& b, const auto& wanted) {
      std::decay_t<decltype(wanted)> both;
      std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
      return both == wanted;
    };
    if (!same(neighbors(from), neighbors(to), ring)) return false;
    if (!same(opposite_edges(from), opposite_edges(to), ring_edges)) return false;
    const auto opposite_faces = [&](std::int32_t node) {
      std::vector<Face3> all;
      for (const std::int32_t e : around(node)) {
        Face3 face{};
        std::copy_if(at(e).begin(), at(e).end(), face.begin(),
                     [&](std::int32_t other) { return other != node; });
        std::sort(face.begin(), face.end());
        all.push_back(face);
      }
      sort_unique(all);
      return all;
    };
    return same(opposite_faces(from), opposite_faces(to), std::vector<Face3>{});
  }

  /// \returns the lowest quality of the changed elements if `from` is merged into `to`, and the
  /// cosine of the largest rotation of a face; -1 if the edge must not be collapsed.
  [[nodiscard]] std::pair<double, double> after(std::int32_t from, std::int32_t to) const {
    constexpr std::pair kMayNot{-1.0, -1.0};
    double before = std::numeric_limits<double>::infinity(), worst = before;
    for (const std::int32_t e : around(from)) {
      before = std::min(before, quality(at(e)));
      if (!has(at(e), to)) worst = std::min(worst, quality(with(at(e), from, to)));
    }
    if (!(worst > before) || !std::isfinite(worst) || !keeps_topology(from, to)) return kMayNot;
    const double cosine = cosine_of_rotation(from, to);
    if (!(cosine > std::cos(radians_from_degrees(kMaxCollapseRotation_deg)))) return kMayNot;
    return {worst, cosine};
  }

  void collapse(std::int32_t from, std::int32_t to) {
    for (const std::int32_t e : std::exchange(tets_of_[std::size_t(from)], {})) {
      if (has(at(e), to)) {
        is_there_[std::size_t(e)] = 0;
        for (const std::int32_t node : at(e)) std::erase(tets_of_[std::size_t(node)], e);
      } else {
        tets_[std::size_t(e)] = with(at(e), from, to);
        tets_of_[std::size_t(to)].push_back(e);
      }
    }
  }

  std::vector<Vec3> nodes_L_;
  std::vector<Tet> tets_;
  std::vector<char> is_there_;
  std::vector<std::vector<std::int32_t>> tets_of_;
};

}  // namespace

Index collapse_edges(VolumeMesh& mesh, double min_scaled_jacobian) {
  LEFORT_CHECK(mesh.blocks.size() == 1 && mesh.blocks[0].shape == ElementShape::kTet4);
  LEFORT_CHECK(mesh.node_sets.empty() && mesh.face_sets.empty());
  Collapser collapser(mesh);
  std::vector<std::pair<double, std::int32_t>> poor;
  for (std::int32_t e = 0; e < collapser.size(); ++e)
    if (const double quality = collapser.quality(collapser.tet(e)); quality < min_scaled_jacobian)
      poor.push_back({quality, e});
  std::sort(poor.begin(), poor.end());
  Index done = 0;
  for (const auto& [quality, e] : poor) done += Index(collapser.try_at(e, min_scaled_jacobian));
  if (done > 0) collapser.write_to(mesh);
  return done;
}

}  // namespace lefort::mesh
