/// \file
/// Extends displacements of boundary nodes into a tetrahedral mesh by Laplace's equation.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/internal/layer_constraints.h>
#include <lefort/mesh/volume_mesh.h>

#include <Eigen/SparseCore>

namespace lefort::mesh::internal {

using Displacements =
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< One row per node [mm].

/// Finite-element Laplacian of linear tetrahedra, in the reference configuration.
class HarmonicExtension {
 public:
  /// \param tets         one block of kTet4 with positive volumes.
  /// \param constraints  of the nodes of `tets`; must outlive this object.
  HarmonicExtension(const VolumeMesh& tets, const LayerConstraints& constraints);

  /// Solves Laplace's equation for each component of the displacement. If the prescribed
  /// displacements are linear in space, so is the solution, and all elements have the same strain.
  ///
  /// Conjugate gradients (\cite nocedal2006, algorithm 5.3), preconditioned by the diagonal, in the
  /// subspace of the displacements that the constraints allow. All three components are solved at
  /// once, because a cut plane couples them.
  ///
  /// \param prescribed  displacements of the nodes; those of fixed nodes are kept, the others are
  ///   the start of the iteration.
  /// \returns the displacements of all nodes [mm].
  [[nodiscard]] Displacements solve(const Displacements& prescribed) const;

 private:
  [[nodiscard]] Displacements times_laplacian(const Displacements& u) const;
  /// \returns `u` without displacements of fixed nodes and normal to cut planes.
  [[nodiscard]] Displacements free_part(Displacements u) const;

  const LayerConstraints& constraints_;
  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> laplacian_;
  VectorX diagonal_;
};

}  // namespace lefort::mesh::internal
