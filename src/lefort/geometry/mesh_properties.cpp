#include <lefort/core/parallel.h>
#include <lefort/geometry/edge_incidence.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace lefort::geometry {

namespace {

constexpr double kMaxCoordinate_mm = 1e6;
/// Three half-edges per triangle are counted in 32 bits.
constexpr Index kMaxTriangles = std::numeric_limits<std::int32_t>::max() / 3;

std::vector<bool> used_vertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) used[std::size_t(v)] = true;
  return used;
}

template <class Accept>
std::optional<EdgeCount> first_edge_not(const TriangleMesh& mesh, const Accept& accept) {
  const EdgeIncidence sides(mesh);
  std::optional<EdgeCount> found;
  for (std::int32_t v = 0; v < mesh.vertex_count() && !found; ++v)
    sides.for_each_edge_at(v, [&](std::int32_t from, std::int32_t to, auto there) {
      EdgeCount count{from, to, 0, 0};
      for (const HalfEdge& s : there)
        ++(is_canonical_direction(mesh, s) ? count.forward : count.backward);
      if (!found && !accept(count)) found = count;
    });
  return found;
}

/// Root of the tree of a vertex, with path halving.
std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t v) {
  while (parent[std::size_t(v)] != v) {
    parent[std::size_t(v)] = parent[std::size_t(parent[std::size_t(v)])];
    v = parent[std::size_t(v)];
  }
  return v;
}

/// Copies the vertices that triangles of `mesh` use, in their order, and renumbers them.
void number_vertices_used(TriangleMesh& mesh, const std::vector<Vec3>& vertices) {
  std::vector<std::int32_t> number(vertices.size(), -1);
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) number[std::size_t(v)] = 0;
  mesh.vertices.reserve(vertices.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = std::int32_t(mesh.vertices.size());
    mesh.vertices.push_back(vertices[v]);
  }
  for (Triangle& t : mesh.triangles)
    for (std::int32_t& v : t) v = number[std::size_t(v)];
}

/// For each vertex the lowest vertex number at its position.
class PositionTable {
 public:
  explicit PositionTable(const std::vector<Vec3>& vertices)
      : vertices_(vertices), slots_(std::bit_ceil(2 * vertices.size() + 1), kEmpty) {}

  /// The first vertex at the position of vertex `v`; may be `v` itself.
  std::int32_t first_at(std::int32_t v) {
    const Vec3& p = vertices_[std::size_t(v)];
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash(p) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kEmpty) return slots_[slot] = v;
      if (vertices_[std::size_t(slots_[slot])] == p) return slots_[slot];
    }
  }

 private:
  static constexpr std::int32_t kEmpty = -1;

  static std::size_t hash(const Vec3& p) {
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) {
      // Adding zero gives +0 and -0 the same bits.
      h = (h ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * 0x9E3779B97F4A7C15U;
      h ^= h >> 32;
    }
    return std::size_t(h);
  }

  const std::vector<Vec3>& vertices_;
  std::vector<std::int32_t> slots_;
};

}  // namespace

Result<void> check_surface(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    return fail(ErrorCode::kMeshInvalid, "the surface has no triangle, it must have at least one");
  if (mesh.triangle_count() > kMaxTriangles || mesh.vertex_count() > kMaxTriangles)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the surface has {} triangles and {} vertices, at most {} are possible",
                            mesh.triangle_count(), mesh.vertex_count(), kMaxTriangles));
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3& p = mesh.vertices[std::size_t(v)];
    if (!(p.cwiseAbs().maxCoeff() < kMaxCoordinate_mm && p.allFinite()))
      return fail(ErrorCode::kMeshInvalid,
                  fmt::format("vertex {} of the surface is at ({}, {}, {}) mm, coordinates must be "
                              "finite and below {:.0f} mm",
                              v, p.x(), p.y(), p.z(), kMaxCoordinate_mm));
  }
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    for (const std::int32_t v : mesh.triangles[std::size_t(t)])
      if (v < 0 || v >= mesh.vertex_count())
        return fail(
            ErrorCode::kMeshInvalid,
            fmt::format("triangle {} of the surface names vertex {}, it must be from 0 to {}", t, v,
                        mesh.vertex_count() - 1));
  return {};
}

Box3 bounding_box(const TriangleMesh& mesh) {
  Box3 box;
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) box.extend(mesh.vertices[std::size_t(v)]);
  return box;
}

double area_mm2(const TriangleMesh& mesh) {
  return deterministic_sum(mesh.triangle_count(), 0.0, [&](Index t) {
    const Vec3& a = mesh.corner(t, 0);
    return 0.5 * (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm();
  });
}

double signed_volume_mm3(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0.0;
  const Vec3 origin = mesh.corner(0, 0);  // Near the surface, against cancellation.
  return deterministic_sum(mesh.triangle_count(), 0.0, [&](Index t) {
    const Vec3 a = mesh.corner(t, 0) - origin, b = mesh.corner(t, 1) - origin;
    return a.dot(b.cross(mesh.corner(t, 2) - origin)) / 6.0;
  });
}

Index euler_characteristic(const TriangleMesh& mesh) {
  const std::vector<bool> used = used_vertices(mesh);
  const Index vertices = std::count(used.begin(), used.end(), true);
  const EdgeIncidence sides(mesh);
  Index edges = 0;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v)
    sides.for_each_edge_at(v, [&](auto...) { ++edges; });
  return vertices - edges + mesh.triangle_count();
}

std::string describe(const EdgeCount& edge) {
  const int total = edge.forward + edge.backward;
  if (total == 2 && edge.forward != edge.backward)
    return fmt::format("edge {}-{} has 2 triangles of opposite orientation", edge.from, edge.to);
  return fmt::format("edge {}-{} has {} triangle{}", edge.from, edge.to, total,
                     total == 1 ? "" : "s");
}

std::optional<EdgeCount> first_open_edge(const TriangleMesh& mesh) {
  return first_edge_not(mesh, [](const EdgeCount& e) { return e.forward == 1 && e.backward == 1; });
}

std::optional<EdgeCount> first_unbalanced_edge(const TriangleMesh& mesh) {
  return first_edge_not(
      mesh, [](const EdgeCount& e) { return e.forward == e.backward || e.from == e.to; });
}

Components connected_components(const TriangleMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 1; k < 3; ++k) {
      const std::int32_t a = root_of(parent, t[0]), b = root_of(parent, t[k]);
      parent[std::size_t(std::max(a, b))] = std::min(a, b);
    }
  Components components;
  std::vector<std::int32_t> label(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles) {
    std::int32_t& of_root = label[std::size_t(root_of(parent, t[0]))];
    if (of_root < 0) of_root = components.count++;
    components.of_triangle.push_back(of_root);
  }
  return components;
}

TriangleMesh keep_triangles(const TriangleMesh& mesh, const std::function<bool(Index)>& keep) {
  TriangleMesh kept;
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    if (keep(t)) kept.triangles.push_back(mesh.triangles[std::size_t(t)]);
  number_vertices_used(kept, mesh.vertices);
  return kept;
}

TriangleMesh keep_components(const TriangleMesh& mesh,
                             const std::function<bool(const TriangleMesh&)>& keep) {
  const Components components = connected_components(mesh);
  std::vector<TriangleMesh> parts(std::size_t(components.count));
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);  // No vertex is in two components.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh& part = parts[std::size_t(components.of_triangle[t])];
    Triangle renumbered{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = std::size_t(mesh.triangles[t][k]);
      if (number[v] < 0) {
        number[v] = std::int32_t(part.vertices.size());
        part.vertices.push_back(mesh.vertices[v]);
      }
      renumbered[k] = number[v];
    }
    part.triangles.push_back(renumbered);
  }
  std::vector<bool> kept;
  for (const TriangleMesh& part : parts) kept.push_back(keep(part));
  return keep_triangles(
      mesh, [&](Index t) { return kept[std::size_t(components.of_triangle[std::size_t(t)])]; });
}

TriangleMesh weld_vertices(const TriangleMesh& mesh) {
  PositionTable table(mesh.vertices);
  std::vector<std::int32_t> first(mesh.vertices.size());
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) first[std::size_t(v)] = table.first_at(v);
  TriangleMesh welded;
  welded.triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const Triangle w = {first[std::size_t(t[0])], first[std::size_t(t[1])],
                        first[std::size_t(t[2])]};
    if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) welded.triangles.push_back(w);
  }
  number_vertices_used(welded, mesh.vertices);
  return welded;
}

}  // namespace lefort::geometry
