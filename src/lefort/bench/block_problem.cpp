#include <lefort/bench/block_problem.h>
#include <lefort/core/check.h>
#include <lefort/mesh/box_grid.h>

namespace lefort::bench {

mesh::VolumeMesh BlockProblem::mesh() const {
  LEFORT_CHECK(cells >= 1);
  return mesh::make_box(shape, {cells, cells, cells}, Vec3::Constant(kSide_mm));
}

fem::RegionMaterials BlockProblem::materials() {
  return {{0, fem::DecoupledLaw<fem::IsochoricNeoHookean>{
                  .isochoric = {.mu_mpa = kMu_mpa},
                  .volume = {.form = fem::VolumetricForm::kQuadratic, .kappa_mpa = kKappa_mpa}}}};
}

std::vector<fem::PrescribedDisplacement> BlockProblem::prescribed(const mesh::VolumeMesh& mesh,
                                                                  double t) {
  std::vector<fem::PrescribedDisplacement> all = fem::prescribe_zero(mesh.node_sets.at(kBelow));
  for (const std::int32_t node : mesh.node_sets.at(kAbove))
    for (int c = 0; c < 3; ++c)
      all.push_back({.node = node, .component = c, .displacement_mm = moved_mm(t)[c]});
  return all;
}

}  // namespace lefort::bench
