/// \file
/// A mesh with its element terms and their assembler.
#pragma once

#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/mesh/volume_mesh.h>

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lefort::test {

/// May be moved: the terms stay where they are in memory.
struct Body {
  mesh::VolumeMesh mesh;
  std::vector<fem::PrescribedDisplacement> prescribed;
  std::vector<std::unique_ptr<const fem::ForceTerm>> terms;
  fem::Assembler assembler;

  /// \param extra  further terms, not owned.
  Body(mesh::VolumeMesh volume, const fem::RegionMaterials& materials,
       std::vector<fem::PrescribedDisplacement> conditions,
       const std::vector<const fem::ForceTerm*>& extra = {},
       fem::VolumetricIntegration volumetric_integration =
           fem::VolumetricIntegration::kMeanDilatation)
      : mesh(std::move(volume)),
        prescribed(std::move(conditions)),
        terms(fem::make_element_terms(mesh, materials, volumetric_integration).value()),
        assembler(make_assembler(extra)) {}

  [[nodiscard]] VectorX at_rest() const { return VectorX::Zero(3 * mesh.node_count()); }

  [[nodiscard]] fem::NewtonOutcome solve(const fem::NewtonOptions& options = {}) const {
    linear::LinearSolver solver;
    return fem::find_equilibrium(assembler, prescribed, at_rest(), solver, options);
  }

 private:
  [[nodiscard]] fem::Assembler make_assembler(const std::vector<const fem::ForceTerm*>& extra) {
    std::vector<const fem::ForceTerm*> all;
    for (const auto& term : terms) all.push_back(term.get());
    all.insert(all.end(), extra.begin(), extra.end());
    return {mesh.nodes_L, fem::DofMap::build(mesh.node_count(), prescribed).value(), all};
  }
};

/// Names of the cases of a test of several shapes.
[[nodiscard]] inline std::string shape_name(
    const testing::TestParamInfo<mesh::ElementShape>& shape) {
  return std::string(mesh::name_of(shape.param));
}

/// All element shapes.
inline constexpr mesh::ElementShape kAllElements[] = {
    mesh::ElementShape::kTet4, mesh::ElementShape::kPyramid5, mesh::ElementShape::kWedge6,
    mesh::ElementShape::kHex8, mesh::ElementShape::kTet10,    mesh::ElementShape::kWedge15,
    mesh::ElementShape::kHex20};

/// \returns the displacements u = A X + b of all nodes, 3 per node.
[[nodiscard]] inline VectorX affine(const mesh::VolumeMesh& mesh, const Mat3& A, const Vec3& b) {
  VectorX u(3 * mesh.node_count());
  for (Index n = 0; n < mesh.node_count(); ++n)
    u.segment<3>(3 * n) = A * mesh.nodes_L[std::size_t(n)] + b;
  return u;
}

/// Prescribes the displacements `u` [3 per node] of `nodes`.
[[nodiscard]] inline std::vector<fem::PrescribedDisplacement> prescribe(
    const std::vector<std::int32_t>& nodes, const VectorX& u) {
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (const std::int32_t node : nodes)
    for (int c = 0; c < 3; ++c)
      prescribed.push_back(
          {.node = node, .component = c, .displacement_mm = u[3 * Index(node) + c]});
  return prescribed;
}

/// Prescribes one component of `nodes`.
[[nodiscard]] inline std::vector<fem::PrescribedDisplacement> prescribe_component(
    const std::vector<std::int32_t>& nodes, int component, double displacement_mm) {
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (const std::int32_t node : nodes)
    prescribed.push_back(
        {.node = node, .component = component, .displacement_mm = displacement_mm});
  return prescribed;
}

[[nodiscard]] inline std::vector<fem::PrescribedDisplacement> joined(
    std::initializer_list<std::vector<fem::PrescribedDisplacement>> parts) {
  std::vector<fem::PrescribedDisplacement> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace lefort::test
