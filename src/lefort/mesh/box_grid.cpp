#include <lefort/core/check.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/elevate_order.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::mesh {
namespace {

/// Position of a cell, counted in cells from the origin.
using Cell = std::array<int, 3>;

/// Fills a mesh cell by cell with linear elements.
class BoxBuilder {
 public:
  BoxBuilder(std::array<int, 3> cells, const Vec3& size_mm) : cells_(cells) {
    LEFORT_CHECK(std::min({cells[0], cells[1], cells[2]}) >= 1 && size_mm.minCoeff() > 0.0);
    // At most 12 tetrahedra per grid node; 32 bits must number all elements.
    LEFORT_CHECK(12.0 * (cells[0] + 1.0) * (cells[1] + 1.0) * (cells[2] + 1.0) <
                 std::numeric_limits<std::int32_t>::max());
    const auto fraction = [&](int n, int axis) { return double(n) / cells[std::size_t(axis)]; };
    for (int k = 0; k <= cells[2]; ++k)
      for (int j = 0; j <= cells[1]; ++j)
        for (int i = 0; i <= cells[0]; ++i)
          mesh_.nodes_L.emplace_back(
              Vec3(fraction(i, 0), fraction(j, 1), fraction(k, 2)).cwiseProduct(size_mm));
  }

  void add_hex(const Cell& cell) { add(ElementShape::kHex8, corners(cell)); }

  void add_wedges(const Cell& cell) {
    const auto v = corners(cell);
    add(ElementShape::kWedge6, std::array{v[0], v[2], v[1], v[4], v[6], v[5]});
    add(ElementShape::kWedge6, std::array{v[0], v[3], v[2], v[4], v[7], v[6]});
  }

  /// One tetrahedron per order of the three axes on the way from corner 0 to corner 6.
  void add_tets(const Cell& cell) {
    constexpr std::array<std::array<int, 3>, 6> kOrders{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (std::size_t o = 0; o < kOrders.size(); ++o) {
      Cell at = cell;
      std::array<std::int32_t, 4> tet{node(at)};
      for (std::size_t s = 0; s < 3; ++s) {
        ++at[std::size_t(kOrders[o][s])];
        tet[s + 1] = node(at);
      }
      if (o >= 3) std::swap(tet[2], tet[3]);  // Odd permutations have the opposite orientation.
      add(ElementShape::kTet4, tet);
    }
  }

  enum class Side { kQuadrilateral, kTwoTriangles };

  /// Adds pyramids from the faces to a node at the center; for the face towards x1, if it is joined
  /// to tetrahedra, two tetrahedra instead.
  void add_pyramids(const Cell& cell, Side x1) {
    const auto v = corners(cell);
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t n : v) sum += mesh_.nodes_L[std::size_t(n)];
    const auto apex = std::int32_t(mesh_.nodes_L.size());
    mesh_.nodes_L.emplace_back(sum / 8.0);
    for (const LocalFace& local : faces_of(ElementShape::kHex8)) {
      const auto& f = face_of(v.data(), local).nodes;
      const bool is_x1 = local.nodes[0] == 1;  // The face 1, 2, 6, 5.
      if (is_x1 && x1 == Side::kTwoTriangles) {
        add(ElementShape::kTet4, std::array{f[0], f[2], f[1], apex});
        add(ElementShape::kTet4, std::array{f[0], f[3], f[2], apex});
      } else {
        add(ElementShape::kPyramid5, std::array{f[0], f[3], f[2], f[1], apex});
      }
    }
  }

  [[nodiscard]] VolumeMesh finished() && { return std::move(mesh_); }

 private:
  [[nodiscard]] std::int32_t node(const Cell& at) const {
    return at[0] + (cells_[0] + 1) * (at[1] + (cells_[1] + 1) * at[2]);
  }
  [[nodiscard]] std::array<std::int32_t, 8> corners(const Cell& c) const {
    const auto at = [&](int i, int j, int k) { return node({c[0] + i, c[1] + j, c[2] + k}); };
    return {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0),
            at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)};
  }
  void add(ElementShape shape, std::span<const std::int32_t> nodes) {
    auto block = std::find_if(mesh_.blocks.begin(), mesh_.blocks.end(),
                              [&](const ElementBlock& b) { return b.shape == shape; });
    if (block == mesh_.blocks.end())
      block = mesh_.blocks.insert(block, {.shape = shape, .nodes = {}, .region = {}});
    block->nodes.insert(block->nodes.end(), nodes.begin(), nodes.end());
    block->region.push_back(0);
  }

  std::array<int, 3> cells_;
  VolumeMesh mesh_;
};

/// Calls fill(cell) for all cells, x fastest.
template <class Fill>
void for_each_cell(const std::array<int, 3>& cells, const Fill& fill) {
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) fill(Cell{i, j, k});
}

/// Adds the sets of the six sides and of the whole boundary.
VolumeMesh with_sets(VolumeMesh mesh, const Vec3& size_mm) {
  const std::vector<Face> boundary = boundary_faces(mesh);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto is_there = [&](std::int32_t node) {
        return mesh.nodes_L[std::size_t(node)][axis] == side * size_mm[axis];
      };
      std::vector<Face> faces;
      for (const Face& face : boundary) {
        const auto nodes = nodes_of(face);
        if (std::all_of(nodes.begin(), nodes.end(), is_there)) faces.push_back(face);
      }
      const std::string name{"xyz"[axis], "01"[side]};
      mesh.node_sets[name] = nodes_of_faces(faces);
      mesh.face_sets[name] = std::move(faces);
    }
  mesh.node_sets["boundary"] = nodes_of_faces(boundary);
  mesh.face_sets["boundary"] = boundary;
  return mesh;
}

}  // namespace

VolumeMesh make_box(ElementShape shape, std::array<int, 3> cells, const Vec3& size_mm) {
  BoxBuilder box(cells, size_mm);
  for_each_cell(cells, [&](const Cell& cell) {
    switch (corner_count(shape)) {
      case 4:
        return box.add_tets(cell);
      case 5:
        return box.add_pyramids(cell, BoxBuilder::Side::kQuadrilateral);
      case 6:
        return box.add_wedges(cell);
      default:
        return box.add_hex(cell);
    }
  });
  VolumeMesh mesh = std::move(box).finished();
  if (node_count(shape) > corner_count(shape)) mesh = elevate_order(std::move(mesh)).mesh;
  return with_sets(std::move(mesh), size_mm);
}

VolumeMesh make_mixed_box(BoxMix mix, std::array<int, 3> cells, const Vec3& size_mm) {
  LEFORT_CHECK(cells[0] >= (mix == BoxMix::kAllLinear ? 4 : mix == BoxMix::kHex20Wedge15 ? 2 : 1));
  LEFORT_CHECK(cells[2] >= (mix == BoxMix::kWedge15Tet10 ? 2 : 1));
  BoxBuilder box(cells, size_mm);
  // The index of the cell among `kinds` equal parts of the box along this axis.
  const auto part = [&](int at, int axis, int kinds) {
    return kinds * at / cells[std::size_t(axis)];
  };
  for_each_cell(cells, [&](const Cell& cell) {
    const int quarter = part(cell[0], 0, 4);
    switch (mix) {
      case BoxMix::kAllLinear:
        if (quarter == 0) return box.add_hex(cell);
        if (quarter == 1) return box.add_wedges(cell);
        if (quarter == 3) return box.add_tets(cell);
        return box.add_pyramids(cell, part(cell[0] + 1, 0, 4) == 3
                                          ? BoxBuilder::Side::kTwoTriangles
                                          : BoxBuilder::Side::kQuadrilateral);
      case BoxMix::kHex20Wedge15:
        return part(cell[0], 0, 2) == 0 ? box.add_hex(cell) : box.add_wedges(cell);
      case BoxMix::kWedge15Tet10:
        return part(cell[2], 2, 2) == 0 ? box.add_wedges(cell) : box.add_tets(cell);
    }
  });
  VolumeMesh mesh = std::move(box).finished();
  if (mix != BoxMix::kAllLinear) mesh = elevate_order(std::move(mesh)).mesh;
  return with_sets(std::move(mesh), size_mm);
}

VolumeMesh with_inner_nodes_moved(VolumeMesh mesh, const Vec3& max_displacement_mm,
                                  std::mt19937& random) {
  std::vector<char> is_corner(mesh.nodes_L.size(), 0), is_boundary(mesh.nodes_L.size(), 0);
  for (const std::int32_t node : nodes_of_faces(boundary_faces(mesh)))
    is_boundary[std::size_t(node)] = 1;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      for (int a = 0; a < corner_count(block.shape); ++a)
        is_corner[std::size_t(block.element(e)[a])] = 1;

  const auto number = [&] { return 2.0 * double(random()) / 4294967295.0 - 1.0; };
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n) {
    if (is_corner[n] == 0 || is_boundary[n] != 0) continue;
    const double x = number(), y = number(), z = number();
    mesh.nodes_L[n] += max_displacement_mm.cwiseProduct(Vec3(x, y, z));
  }
  for (const ElementBlock& block : mesh.blocks) {
    const int corners = corner_count(block.shape);
    if (node_count(block.shape) == corners) continue;
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::int32_t* node = block.element(e);
      int middle = corners;
      for (const auto& [i, j] : edges_of(block.shape)) {
        const auto at = std::size_t(node[middle++]);
        if (is_boundary[at] != 0) continue;
        mesh.nodes_L[at] =
            0.5 * (mesh.nodes_L[std::size_t(node[i])] + mesh.nodes_L[std::size_t(node[j])]);
      }
    }
  }
  return mesh;
}

}  // namespace lefort::mesh
