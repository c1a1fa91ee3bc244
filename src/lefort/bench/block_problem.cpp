#include <lefort/bench/block_problem.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace lefort::bench {
namespace {

/// A point of the lattice of a mesh.
using Place = std::array<int, 3>;

Place middle(const Place& a, const Place& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

/// The orders in which the axes are walked from one corner of a cell to the opposite one: each
/// walk passes the corners of one of its six tetrahedra (Kuhn's subdivision). Whether the walk is
/// right-handed tells which way round they are.
struct Walk {
  std::array<int, 3> axes;
  bool right_handed;
};
constexpr std::array<Walk, 6> kWalks{{{{0, 1, 2}, true},
                                      {{1, 2, 0}, true},
                                      {{2, 0, 1}, true},
                                      {{0, 2, 1}, false},
                                      {{2, 1, 0}, false},
                                      {{1, 0, 2}, false}}};

/// The ten places of a tetrahedron, `step` lattice points along each side of its cell.
std::array<Place, 10> tetrahedron(const Place& origin, const Walk& walk, int step) {
  std::array<Place, 4> corner{origin, origin, origin, origin};
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k + 1] = corner[k];
    corner[k + 1][std::size_t(walk.axes[k])] += step;
  }
  if (!walk.right_handed) std::swap(corner[1], corner[2]);
  return {corner[0],
          corner[1],
          corner[2],
          corner[3],
          middle(corner[0], corner[1]),
          middle(corner[1], corner[2]),
          middle(corner[2], corner[0]),
          middle(corner[0], corner[3]),
          middle(corner[1], corner[3]),
          middle(corner[2], corner[3])};
}

std::array<Place, 8> hexahedron(const Place& o) {
  const auto at = [&](int x, int y, int z) { return Place{o[0] + x, o[1] + y, o[2] + z}; };
  return {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0),
          at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)};
}

}  // namespace

mesh::VolumeMesh BlockProblem::mesh() const {
  LEFORT_CHECK(cells >= 1);
  LEFORT_CHECK(shape == mesh::ElementShape::kTet10 || shape == mesh::ElementShape::kHex8);
  const int step = shape == mesh::ElementShape::kTet10 ? 2 : 1;
  const int last = step * cells;
  const auto number = [&](const Place& p) {
    return std::int32_t(p[0] + (last + 1) * (p[1] + (last + 1) * p[2]));
  };
  mesh::VolumeMesh mesh;
  for (int k = 0; k <= last; ++k)
    for (int j = 0; j <= last; ++j)
      for (int i = 0; i <= last; ++i) {
        if (k == 0) mesh.node_sets["below"].push_back(number({i, j, k}));
        if (k == last) mesh.node_sets["above"].push_back(number({i, j, k}));
        mesh.nodes_L.emplace_back(kSide_mm / last * Vec3(i, j, k));
      }
  mesh::ElementBlock& block = mesh.blocks.emplace_back();
  block.shape = shape;
  const auto add = [&](const auto& places) {
    for (const Place& place : places) block.nodes.push_back(number(place));
    block.region.push_back(0);
  };
  for (int k = 0; k < last; k += step)
    for (int j = 0; j < last; j += step)
      for (int i = 0; i < last; i += step) {
        if (shape == mesh::ElementShape::kHex8)
          add(hexahedron({i, j, k}));
        else
          for (const Walk& walk : kWalks) add(tetrahedron({i, j, k}, walk, step));
      }
  return mesh;
}

fem::RegionMaterials BlockProblem::materials() {
  return {{0, fem::Split<fem::IsochoricNeoHookean>{
                  .shear = {.mu_mpa = kMu_mpa},
                  .volume = {.form = fem::VolumetricForm::kQuadratic, .kappa_mpa = kKappa_mpa}}}};
}

std::vector<fem::PrescribedDisplacement> BlockProblem::prescribed(const mesh::VolumeMesh& mesh,
                                                                  double t) {
  std::vector<fem::PrescribedDisplacement> all = fem::fix(mesh.node_sets.at("below"));
  for (const std::int32_t node : mesh.node_sets.at("above"))
    for (int c = 0; c < 3; ++c)
      all.push_back({.node = node, .component = c, .displacement_mm = moved_mm(t)[c]});
  return all;
}

}  // namespace lefort::bench
