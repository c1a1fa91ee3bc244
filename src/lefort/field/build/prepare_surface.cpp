#include <lefort/core/parallel.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/field/sign/edge_function_yz.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

namespace lefort::field {

namespace {

using geometry::EdgeIncidence;
using geometry::HalfEdge;
using geometry::Triangle;
using geometry::TriangleMesh;

/// An edge that is not shared by exactly two triangles of consistent orientation.
struct IrregularEdge {
  std::vector<HalfEdge> sides;
};

bool runs_against(const TriangleMesh& mesh, const HalfEdge& a, const HalfEdge& b) {
  return is_canonical_direction(mesh, a) != is_canonical_direction(mesh, b);
}

std::int32_t opposite_corner(const TriangleMesh& mesh, const HalfEdge& s) {
  return mesh.triangles[std::size_t(s.triangle())][std::size_t((s.side() + 2) % 3)];
}

/// Finds irregular edges, in order.
std::vector<IrregularEdge> irregular_edges(const TriangleMesh& mesh, const EdgeIncidence& sides) {
  return parallel_collect<IrregularEdge>(
      mesh.vertex_count(), [&](Index v, std::vector<IrregularEdge>& odd) {
        sides.for_each_edge_at(std::int32_t(v), [&](std::int32_t, std::int32_t, auto there) {
          const bool plain = there.size() == 2 && runs_against(mesh, there[0], there[1]) &&
                             opposite_corner(mesh, there[0]) != opposite_corner(mesh, there[1]);
          if (!plain) odd.push_back({{there.begin(), there.end()}});
        });
      });
}

/// Corners in ascending order, and whether the permutation is even.
std::pair<Triangle, bool> sorted_corners(Triangle t) {
  bool even = true;
  const auto order = [&](std::size_t i, std::size_t j) {
    if (t[i] <= t[j]) return;
    std::swap(t[i], t[j]);
    even = !even;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return {t, even};
}

/// Drops triangles that repeat an earlier one and marks opposite duplicates.
void find_repeated(PreparedSurface& surface, const std::vector<IrregularEdge>& odd) {
  TriangleMesh& mesh = surface.mesh_B;
  std::vector<std::int32_t> candidates;
  for (const IrregularEdge& edge : odd)
    for (const HalfEdge& s : edge.sides) candidates.push_back(std::int32_t(s.triangle()));
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());

  std::map<Triangle, std::array<std::int32_t, 2>> first;  // By orientation; -1 if there is none.
  std::vector<std::int32_t> repeated;
  for (const std::int32_t t : candidates) {
    const auto [corners, even] = sorted_corners(mesh.triangles[std::size_t(t)]);
    auto& [odd_one, even_one] = first.try_emplace(corners, std::array{-1, -1}).first->second;
    std::int32_t& same = even ? even_one : odd_one;
    if (same >= 0) {
      repeated.push_back(t);
    } else {
      same = t;
    }
  }
  std::vector<bool> is_opposite_duplicate(mesh.triangles.size(), false);
  for (const auto& [corners, twins] : first) {
    if (twins[0] < 0 || twins[1] < 0) continue;
    for (const std::int32_t t : twins) is_opposite_duplicate[std::size_t(t)] = true;
    surface.report.opposite_duplicates += 2;
  }
  surface.report.duplicate_triangles = Index(repeated.size());
  std::size_t kept = 0, next = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (next < repeated.size() && repeated[next] == std::int32_t(t)) {
      ++next;
      continue;
    }
    mesh.triangles[kept] = mesh.triangles[t];
    is_opposite_duplicate[kept++] = is_opposite_duplicate[t];
  }
  mesh.triangles.resize(kept);
  is_opposite_duplicate.resize(kept);
  if (surface.report.opposite_duplicates > 0)
    surface.is_opposite_duplicate = std::move(is_opposite_duplicate);
}

double area_mm2(const TriangleMesh& mesh, Index t) {
  const Vec3& a = mesh.corner(t, 0);
  return 0.5 * (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm();
}

/// Flips triangles so that neighbors have consistent orientation.
///
/// \returns the number of edges that remain inconsistent.
Index orient_consistently(PreparedSurface& surface, const EdgeIncidence& sides) {
  TriangleMesh& mesh = surface.mesh_B;
  struct Link {
    std::int32_t other = -1;
    bool agrees = true;
  };
  std::vector<std::array<Link, 3>> links(mesh.triangles.size());
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v)
    sides.for_each_edge_at(v, [&](std::int32_t, std::int32_t, auto there) {
      if (there.size() != 2) return;
      const bool agrees = runs_against(mesh, there[0], there[1]);
      for (std::size_t i = 0; i < 2; ++i)
        links[std::size_t(there[i].triangle())][std::size_t(there[i].side())] = {
            std::int32_t(there[1 - i].triangle()), agrees};
    });

  enum : std::int8_t { kNew, kKeep, kFlip };
  std::vector<std::int8_t> sense(mesh.triangles.size(), kNew);
  std::vector<std::int32_t> patch;
  Index inconsistent = 0;
  for (std::int32_t seed = 0; seed < std::int32_t(mesh.triangles.size()); ++seed) {
    if (sense[std::size_t(seed)] != kNew) continue;
    patch.assign(1, seed);
    sense[std::size_t(seed)] = kKeep;
    double keep_mm2 = 0.0, flip_mm2 = 0.0;
    Index patch_inconsistent = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const auto t = std::size_t(patch[i]);
      (sense[t] == kKeep ? keep_mm2 : flip_mm2) += area_mm2(mesh, Index(t));
      for (const Link& link : links[t]) {
        if (link.other < 0) continue;
        const auto wanted = link.agrees ? sense[t] : std::int8_t(sense[t] == kKeep ? kFlip : kKeep);
        std::int8_t& other = sense[std::size_t(link.other)];
        if (other == kNew) {
          other = wanted;
          patch.push_back(link.other);
        } else if (other != wanted) {
          ++patch_inconsistent;  // Counted from both sides.
        }
      }
    }
    const std::int8_t minority = keep_mm2 >= flip_mm2 ? kFlip : kKeep;
    if (patch_inconsistent > 0) {
      inconsistent += patch_inconsistent / 2;
      continue;  // Not orientable, so flipping cannot help.
    }
    for (const std::int32_t t : patch) {
      if (sense[std::size_t(t)] != minority) continue;
      Triangle& triangle = mesh.triangles[std::size_t(t)];
      std::swap(triangle[1], triangle[2]);
      ++surface.report.flipped_triangles;
    }
  }
  return inconsistent;
}

/// Components of a surface that are connected by edges.
struct Parts {
  std::vector<std::int32_t> of_triangle;
  std::vector<double> volume_mm3;
  std::vector<double> area_mm2;
  std::vector<std::int32_t> largest;  ///< Largest triangle.

  [[nodiscard]] std::size_t count() const { return volume_mm3.size(); }
  /// True if the enclosed volume is clearly negative; sheets with two sides enclose rounding
  /// errors.
  [[nodiscard]] bool is_inward(std::size_t part) const {
    return volume_mm3[part] < -1e-9 * std::pow(area_mm2[part], 1.5);
  }
};

Parts find_parts(const TriangleMesh& mesh, const EdgeIncidence& sides) {
  std::vector<std::int32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root_of = [&](std::int32_t t) {
    while (parent[std::size_t(t)] != t) {
      parent[std::size_t(t)] = parent[std::size_t(parent[std::size_t(t)])];
      t = parent[std::size_t(t)];
    }
    return t;
  };
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v)
    sides.for_each_edge_at(v, [&](std::int32_t, std::int32_t, auto there) {
      for (std::size_t i = 1; i < there.size(); ++i) {
        const std::int32_t a = root_of(std::int32_t(there[0].triangle())),
                           b = root_of(std::int32_t(there[i].triangle()));
        parent[std::size_t(std::max(a, b))] = std::min(a, b);
      }
    });

  Parts parts;
  parts.of_triangle.resize(mesh.triangles.size());
  std::vector<double> max_mm2;
  const Vec3 origin = mesh.corner(0, 0);  // Near the surface, against cancellation.
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::int32_t root = root_of(t);
    if (root == t) {
      parts.of_triangle[std::size_t(t)] = std::int32_t(parts.count());
      parts.volume_mm3.push_back(0.0);
      parts.area_mm2.push_back(0.0);
      parts.largest.push_back(t);
      max_mm2.push_back(0.0);
    }
    // The root has the lowest number of its component.
    const std::int32_t part = parts.of_triangle[std::size_t(t)] =
        parts.of_triangle[std::size_t(root)];
    const Vec3 a = mesh.corner(t, 0) - origin, b = mesh.corner(t, 1) - origin;
    parts.volume_mm3[std::size_t(part)] += a.dot(b.cross(mesh.corner(t, 2) - origin)) / 6.0;
    const double area = area_mm2(mesh, t);
    parts.area_mm2[std::size_t(part)] += area;
    if (area > max_mm2[std::size_t(part)]) {
      max_mm2[std::size_t(part)] = area;
      parts.largest[std::size_t(part)] = t;
    }
  }
  return parts;
}

/// Finds the components that enclose a point, by the triangles that a ray along x from it crosses.
class EnclosureTest {
 public:
  EnclosureTest(const TriangleMesh& mesh, const Parts& parts) : mesh_(mesh), parts_(parts) {
    box_ = geometry::bounding_box(mesh);
    side_ = std::clamp(int(std::sqrt(double(mesh.triangle_count()))), 1, kMaxSide);
    first_.assign(std::size_t(side_) * std::size_t(side_) + 1, 0);
    for_each_bin([&](std::size_t bin, std::int32_t) { ++first_[bin + 1]; });
    for (std::size_t bin = 0; bin + 1 < first_.size(); ++bin) first_[bin + 1] += first_[bin];
    triangles_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for_each_bin([&](std::size_t bin, std::int32_t t) { triangles_[next[bin]++] = t; });
  }

  /// Components that enclose the center of the largest triangle of `part`, without `part` itself.
  /// Corners are not used: another component may touch there.
  [[nodiscard]] std::vector<std::int32_t> of(std::size_t part) const {
    const std::int32_t from = parts_.largest[part];
    const Vec3 p = (mesh_.corner(from, 0) + mesh_.corner(from, 1) + mesh_.corner(from, 2)) / 3.0;
    const std::size_t bin =
        std::size_t(bin_at(p.z(), 2)) * std::size_t(side_) + std::size_t(bin_at(p.y(), 1));
    std::vector<std::int32_t> crossed;
    for (std::size_t i = first_[bin]; i < first_[bin + 1]; ++i) {
      const std::int32_t t = triangles_[i];
      const std::int32_t other = parts_.of_triangle[std::size_t(t)];
      if (std::size_t(other) != part && crosses(t, p)) crossed.push_back(other);
    }
    std::sort(crossed.begin(), crossed.end());
    std::vector<std::int32_t> enclosing;  // Those crossed an odd number of times.
    for (const std::int32_t other : crossed) {
      if (!enclosing.empty() && enclosing.back() == other) {
        enclosing.pop_back();
      } else {
        enclosing.push_back(other);
      }
    }
    return enclosing;
  }

 private:
  static constexpr int kMaxSide = 1024;

  [[nodiscard]] int bin_at(double coordinate, int axis) const {
    const double fraction = (coordinate - box_.min()[axis]) / (box_.sizes()[axis] + 1e-300);
    return std::clamp(int(fraction * side_), 0, side_ - 1);
  }

  template <class Body>
  void for_each_bin(const Body& body) const {
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
      std::array<int, 2> low{}, high{};
      for (int axis = 1; axis < 3; ++axis) {
        const auto [minimum, maximum] = std::minmax(
            {mesh_.corner(t, 0)[axis], mesh_.corner(t, 1)[axis], mesh_.corner(t, 2)[axis]});
        low[std::size_t(axis - 1)] = bin_at(minimum, axis);
        high[std::size_t(axis - 1)] = bin_at(maximum, axis);
      }
      for (int z = low[1]; z <= high[1]; ++z)
        for (int y = low[0]; y <= high[0]; ++y)
          body(std::size_t(z) * std::size_t(side_) + std::size_t(y), t);
    }
  }

  /// True if the ray from `p` along +x crosses a triangle.
  [[nodiscard]] bool crosses(std::int32_t t, const Vec3& p) const {
    const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
    const double u = EdgeFunctionYz(b, c).evaluate(p.y(), p.z()),
                 v = EdgeFunctionYz(c, a).evaluate(p.y(), p.z()),
                 w = EdgeFunctionYz(a, b).evaluate(p.y(), p.z());
    const bool all_left = u > 0.0 && v > 0.0 && w > 0.0;
    const bool all_right = u < 0.0 && v < 0.0 && w < 0.0;
    if (!all_left && !all_right) return false;
    return (u * a.x() + v * b.x() + w * c.x()) / (u + v + w) > p.x();
  }

  const TriangleMesh& mesh_;
  const Parts& parts_;
  Box3 box_;
  int side_ = 1;
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> triangles_;
};

/// Flips closed components with negative volume that no other component encloses, together with all
/// components inside them.
void flip_inward_parts(PreparedSurface& surface, const Parts& parts) {
  TriangleMesh& mesh = surface.mesh_B;
  std::vector<std::size_t> candidates;
  for (std::size_t part = 0; part < parts.count(); ++part)
    if (parts.is_inward(part)) candidates.push_back(part);
  if (candidates.empty()) return;

  const EnclosureTest enclosure(mesh, parts);
  std::vector<bool> flip(parts.count(), false);
  bool any = false;
  for (const std::size_t part : candidates) {
    flip[part] = enclosure.of(part).empty();
    any = any || flip[part];
  }
  if (!any) return;
  const std::vector<bool> outermost = flip;
  for (std::size_t part = 0; part < parts.count(); ++part)
    for (const std::int32_t enclosing : enclosure.of(part))
      if (outermost[std::size_t(enclosing)]) flip[part] = true;

  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!flip[std::size_t(parts.of_triangle[t])]) continue;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    ++surface.report.flipped_triangles;
  }
}

bool is_balanced(const TriangleMesh& mesh, const IrregularEdge& edge) {
  Index forward = 0;
  for (const HalfEdge& s : edge.sides) forward += is_canonical_direction(mesh, s) ? 1 : 0;
  return 2 * forward == Index(edge.sides.size());
}

}  // namespace

std::vector<std::string> describe(const MeshRepairReport& report) {
  std::vector<std::string> sentences;
  const auto describe_repair = [&](Index count, std::string_view one, std::string_view many,
                                   std::string_view what) {
    if (count > 0)
      sentences.push_back(fmt::format("{} {} {}", count, count == 1 ? one : many, what));
  };
  describe_repair(report.degenerate_triangles, "triangle", "triangles",
                  "with coincident corners dropped");
  describe_repair(report.duplicate_triangles, "triangle", "triangles", "dropped as redundant");
  describe_repair(report.opposite_duplicates, "triangle", "triangles",
                  "with an opposite duplicate: they enclose no volume");
  describe_repair(report.flipped_triangles, "triangle", "triangles", "flipped to face outward");
  describe_repair(report.boundary_edges, "edge", "edges",
                  "with one triangle: the surface is open, signs outside the band are unknown");
  describe_repair(report.non_manifold_edges, "edge", "edges", "with more than two triangles");
  describe_repair(
      report.inconsistent_edges, "edge", "edges",
      "of inconsistent orientation that flipping cannot repair: signs may be wrong nearby");
  return sentences;
}

Result<PreparedSurface> prepare_surface(const geometry::TriangleMesh& surface_B) {
  LEFORT_TRY_VOID(geometry::check_surface(surface_B));
  PreparedSurface surface;
  surface.mesh_B = geometry::weld_vertices(surface_B);
  TriangleMesh& mesh = surface.mesh_B;
  if (mesh.triangles.empty())
    return fail(ErrorCode::kMeshInvalid,
                "all triangles of the surface are points or lines, one must have three corners");
  surface.report.duplicate_vertices = surface_B.vertex_count() - mesh.vertex_count();
  surface.report.degenerate_triangles = surface_B.triangle_count() - mesh.triangle_count();

  EdgeIncidence sides(mesh);
  std::vector<IrregularEdge> odd = irregular_edges(mesh, sides);
  if (!odd.empty()) {
    find_repeated(surface, odd);
    if (surface.report.duplicate_triangles > 0) sides = EdgeIncidence(mesh);
    surface.report.inconsistent_edges = orient_consistently(surface, sides);
    sides = EdgeIncidence(mesh);
    odd = irregular_edges(mesh, sides);
  }
  surface.closed = true;
  for (const IrregularEdge& edge : odd) {
    surface.closed = surface.closed && is_balanced(mesh, edge);
    if (edge.sides.size() == 1) ++surface.report.boundary_edges;
    if (edge.sides.size() > 2) ++surface.report.non_manifold_edges;
  }
  const Parts parts = find_parts(mesh, sides);
  surface.components = Index(parts.count());
  if (surface.closed) {
    const Index before = surface.report.flipped_triangles;
    flip_inward_parts(surface, parts);
    if (surface.report.flipped_triangles != before) sides = EdgeIncidence(mesh);
  }
  surface.normals = geometry::Pseudonormals(mesh, sides);
  return surface;
}

}  // namespace lefort::field
