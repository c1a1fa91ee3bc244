#include <lefort/mesh/box_grid.h>
#include <lefort/verify/mapped_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

namespace lefort::verify {
namespace {

using std::numbers::pi;

/// A position rounded to a millionth of a mm.
using Key = std::array<std::int64_t, 3>;

Key key_of(const Vec3& p) {
  const auto rounded = [](double x) { return std::int64_t(std::llround(x * 1e6)); };
  return {rounded(p.x()), rounded(p.y()), rounded(p.z())};
}

/// Number of the node at a position; rounding may have put it into a neighboring cell.
std::int32_t node_at(const Vec3& p, std::map<Key, std::int32_t>& known, std::vector<Vec3>& nodes) {
  const Key key = key_of(p);
  for (std::int64_t i = -1; i <= 1; ++i)
    for (std::int64_t j = -1; j <= 1; ++j)
      for (std::int64_t k = -1; k <= 1; ++k)
        if (const auto found = known.find({key[0] + i, key[1] + j, key[2] + k});
            found != known.end())
          return found->second;
  known.emplace(key, std::int32_t(nodes.size()));
  nodes.push_back(p);
  return std::int32_t(nodes.size()) - 1;
}

mesh::ElementBlock& block_of(mesh::VolumeMesh& mesh, mesh::ElementShape shape) {
  for (mesh::ElementBlock& block : mesh.blocks)
    if (block.shape == shape) return block;
  return mesh.blocks.emplace_back(mesh::ElementBlock{.shape = shape, .nodes = {}, .region = {}});
}

/// Exact rotation by n quarter turns about z.
Vec3 turned(Vec3 p, int n) {
  for (; n > 0; --n) p = Vec3(-p.y(), p.x(), p.z());
  return p;
}

}  // namespace

mesh::VolumeMesh mapped(mesh::VolumeMesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& node : mesh.nodes_L) node = map(node);
  return mesh;
}

mesh::VolumeMesh welded(const std::vector<mesh::VolumeMesh>& parts) {
  mesh::VolumeMesh whole;
  std::map<Key, std::int32_t> known;
  for (const mesh::VolumeMesh& part : parts) {
    std::vector<std::int32_t> number;
    for (const Vec3& p : part.nodes_L) number.push_back(node_at(p, known, whole.nodes_L));
    for (const mesh::ElementBlock& block : part.blocks) {
      mesh::ElementBlock& all = block_of(whole, block.shape);
      for (const std::int32_t node : block.nodes) all.nodes.push_back(number[std::size_t(node)]);
      all.region.insert(all.region.end(), block.region.begin(), block.region.end());
    }
    for (const auto& [name, faces] : part.face_sets)
      for (mesh::Face face : faces) {
        for (int a = 0; a < mesh::node_count(face.shape); ++a) {
          std::int32_t& node = face.nodes[std::size_t(a)];
          node = number[std::size_t(node)];
        }
        whole.face_sets[name].push_back(face);
      }
  }
  return whole;
}

double graded_corner(int i, int cells, double grading) {
  return 1.0 - std::pow(1.0 - double(i) / cells, grading);
}

mesh::VolumeMesh graded_cube(mesh::ElementShape shape, int cells, double side_mm, double grading) {
  const auto corner = [&](int i) { return graded_corner(i, cells, grading); };
  const auto moved =
      [&](double x) {  // Linear from corner to corner: a mid-side node stays in the middle.
        const int before = std::min(cells - 1, int(std::floor(x * cells + 1e-6)));
        const double fraction = x * cells - before;
        return side_mm * ((1.0 - fraction) * corner(before) + fraction * corner(before + 1));
      };
  return mapped(mesh::make_box(shape, {cells, cells, cells}, Vec3::Ones()),
                [&](const Vec3& p) { return Vec3(moved(p.x()), moved(p.y()), moved(p.z())); });
}

mesh::VolumeMesh quarter_ring(mesh::ElementShape shape, int cells, double a_mm, double b_mm,
                              double thickness_mm) {
  mesh::VolumeMesh ring = mapped(
      mesh::make_box(shape, {cells, 2 * cells, 1}, Vec3::Ones()), [&](const Vec3& p) -> Vec3 {
        const double r = a_mm + (b_mm - a_mm) * p.x();
        const double angle = 0.5 * pi * p.y();
        return {r * std::cos(angle), r * std::sin(angle), thickness_mm * p.z()};
      });
  ring.face_sets["inner"] = ring.face_sets.at("x0");
  return ring;
}

mesh::VolumeMesh octant_shell(mesh::ElementShape shape, int cells, double a_mm, double b_mm) {
  const mesh::VolumeMesh box = mesh::make_box(shape, {cells, cells, cells}, Vec3::Ones());
  std::vector<mesh::VolumeMesh> blocks;
  for (int axis = 0; axis < 3; ++axis) {
    // The third axis of the box points outwards, so that quadrilaterals of wedges match.
    blocks.push_back(mapped(box, [&](const Vec3& p) -> Vec3 {
      Vec3 direction;
      direction[axis] = 1.0;
      direction[(axis + 1) % 3] = std::tan(0.25 * pi * p.x());
      direction[(axis + 2) % 3] = std::tan(0.25 * pi * p.y());
      return (a_mm + (b_mm - a_mm) * p.z()) * direction.normalized();
    }));
    auto& sets = blocks.back().face_sets;
    const std::vector<mesh::Face> inner = sets.at("z0");
    sets.clear();
    sets["inner"] = inner;
  }
  return welded(blocks);
}

mesh::VolumeMesh round_column(mesh::ElementShape shape, int cells, int layers, double radius_mm,
                              double length_mm) {
  const double core_mm = 0.5 * radius_mm;
  const mesh::VolumeMesh box = mesh::make_box(shape, {cells, cells, layers}, Vec3::Ones());
  // The sides of the core are slightly curved, for better corners.
  const auto on_core = [&](double x, double y) {
    const double bulge = 1.0 + 0.15 * (1.0 - x * y);
    return Eigen::Vector2d(core_mm * bulge * x, core_mm * bulge * y);
  };
  std::vector<mesh::VolumeMesh> parts;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const auto add = [&](const auto& in_plane) {
      parts.push_back(mapped(box, [&](const Vec3& p) {
        const Eigen::Vector2d at = in_plane(p.x(), p.y());
        return turned({at.x(), at.y(), length_mm * p.z()}, quarter);
      }));
      auto& sets = parts.back().face_sets;
      std::erase_if(sets, [](const auto& set) { return set.first != "z0" && set.first != "z1"; });
    };
    add([&](double x, double y) { return on_core(x, y); });
    // From the sides x = 1 and y = 1 of the core to the surface.
    add([&](double x, double y) -> Eigen::Vector2d {
      const double angle = 0.25 * pi * y;
      return (1.0 - x) * on_core(1.0, y) +
             x * radius_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    });
    add([&](double x, double y) -> Eigen::Vector2d {
      const double angle = 0.5 * pi - 0.25 * pi * x;
      return (1.0 - y) * on_core(x, 1.0) +
             y * radius_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    });
  }
  return welded(parts);
}

}  // namespace lefort::verify
