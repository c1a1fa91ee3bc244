/// \file
/// Symmetric matrices for tests: random ones, and the stiffness of a block.
#pragma once

#include <lefort/core/types.h>
#include <lefort/linear/sparse_matrix.h>

#include <Eigen/Dense>

#include <cmath>

#include "fem/body.h"
#include "fem/random_deformation.h"
#include "support/box_mesh.h"

namespace lefort::test {

/// B B^T + shift I, where B has a fraction `filled` of nonzero entries.
[[nodiscard]] inline Eigen::MatrixXd random_positive_definite(Index size, double filled,
                                                              double shift, unsigned seed) {
  RandomDeformation random(seed);
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(size, size);
  for (Index i = 0; i < size; ++i)
    for (Index j = 0; j < size; ++j)
      if (std::abs(random.number()) < filled) B(i, j) = random.number();
  return B * B.transpose() + shift * Eigen::MatrixXd::Identity(size, size);
}

/// The lower triangle with the whole diagonal.
[[nodiscard]] inline linear::SparseMatrix lower_triangle(const Eigen::MatrixXd& A) {
  linear::SparseMatrix L(A.rows(), A.cols());
  for (Index j = 0; j < A.cols(); ++j)
    for (Index i = j; i < A.rows(); ++i)
      if (i == j || A(i, j) != 0.0) L.insert(i, j) = A(i, j);
  L.makeCompressed();
  return L;
}

/// Stiffness matrix of a cube in the reference configuration, `cells` cells per edge, one face
/// fixed.
[[nodiscard]] inline linear::SparseMatrix block_stiffness(
    int cells, double poisson, mesh::ElementShape shape = mesh::ElementShape::kTet4) {
  mesh::VolumeMesh mesh = box_mesh({.cells = {cells, cells, cells}, .shape = shape});
  auto held = fem::prescribe_zero(mesh.node_sets.at("x0"));
  const Body body(std::move(mesh), {{0, fem::NeoHookean::from_young_poisson(1.0, poisson).value()}},
                  std::move(held));
  return body.assembler.tangent(body.at_rest());
}

}  // namespace lefort::test
