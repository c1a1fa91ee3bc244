/// \file
/// Structured boxes of elements for tests, optionally distorted, with named sides.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <random>

namespace lefort::test {

struct BoxMeshOptions {
  std::array<int, 3> cells{2, 2, 2};  ///< Along x, y, z.
  Vec3 size_mm = Vec3::Ones();        ///< The box extends from the origin to this point.
  double distortion = 0.0;            ///< Inner nodes move by up to this fraction of a cell, < 0.2.
  unsigned seed = 7;                  ///< Of the distortion.
  mesh::ElementShape shape = mesh::ElementShape::kTet4;
};

/// Distorted mesh::make_box(); its set "boundary" is also named "outside".
inline mesh::VolumeMesh box_mesh(const BoxMeshOptions& options = {}) {
  const auto [nx, ny, nz] = options.cells;
  mesh::VolumeMesh mesh = mesh::make_box(options.shape, options.cells, options.size_mm);
  mesh.node_sets["outside"] = mesh.node_sets.at("boundary");
  if (options.distortion == 0.0) return mesh;
  std::mt19937 generator(options.seed);
  const Vec3 cell_mm = options.size_mm.cwiseQuotient(Vec3(nx, ny, nz));
  return mesh::with_inner_nodes_moved(std::move(mesh), options.distortion * cell_mm, generator);
}

}  // namespace lefort::test
