/// \file
/// Sums the local items of all force terms into energy, forces and tangent.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/fem/assembly/tangent.h>
#include <lefort/linear/sparse_matrix.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lefort::fem {

/// Energy and forces at one state, on all components.
struct AssembledForces {
  double energy_mj = 0.0;  ///< Of the conservative terms.
  /// Sum of all terms [N], 3 per node. At a prescribed component of a body in equilibrium this is
  /// the reaction: the force that the support exerts on the body.
  VectorX residual_n;
  /// What terms that are not conservative have added to it [N]; empty if there are none.
  VectorX follower_n = {};
  /// Norm over the free components of the sum of absolute local forces [N]: the size of what has to
  /// cancel there. Unlike the first residual or the reactions it does not depend on how the load
  /// comes in, and round-off in the residual is always a few 1e-16 of it.
  double residual_reference_n = 0.0;
  Index contacts = 0;       ///< Points in contact, of all items.
  double deepest_mm = 0.0;  ///< How deep one of them lies, at most [mm].
  /// Bound on what rounding of positions and sums may have done to energy_mj [mJ].
  double energy_round_off_mj = 0.0;
};

/// The change of energy between two states: where forces have none, minus their work along the
/// straight way, by the trapezoidal rule.
[[nodiscard]] double energy_change_mj(const AssembledForces& from, const VectorX& u_from,
                                      const AssembledForces& to, const VectorX& u_to);

/// Assembles the same terms over and over: lays out matrix and summation order once.
///
/// \note Items are evaluated in parallel, and every sum is taken by one task in the order of terms
///   and items: same bits for any number of threads. Memory for local matrices is bounded, however
///   many items there are.
class Assembler {
 public:
  /// \param nodes_L  reference positions of all nodes [mm].
  /// \param dofs     which components are free; made for as many nodes.
  /// \param terms    must outlive the assembler; their nodes must exist.
  Assembler(std::vector<Vec3> nodes_L, DofMap dofs, std::vector<const ForceTerm*> terms);
  ~Assembler();
  Assembler(Assembler&&) noexcept;
  Assembler& operator=(Assembler&&) noexcept;

  [[nodiscard]] const DofMap& dofs() const;
  [[nodiscard]] std::span<const Vec3> nodes_L() const;

  /// \param u  displacements of all components [mm].
  /// \returns nothing if an item is inadmissible at u.
  [[nodiscard]] std::optional<AssembledForces> forces(const VectorX& u) const;

  /// \returns the lower triangle of the tangent on the free components [N/mm]; its pattern is
  ///   always the same, whatever the kind. \pre u is admissible.
  [[nodiscard]] linear::SparseMatrix tangent(const VectorX& u,
                                             Tangent kind = Tangent::kExact) const;

  /// \returns the strictly lower triangle L of the antisymmetric part L - L^T of the derivative of
  ///   forces() by the free components [N/mm]; 0 by 0 if all terms are conservative.
  /// \pre u is admissible.
  [[nodiscard]] linear::SparseMatrix antisymmetric_tangent(const VectorX& u) const;

  /// \returns (tangent on all components) * du [N], without building that tangent.
  /// \pre u is admissible.
  [[nodiscard]] VectorX tangent_times(const VectorX& u, const VectorX& du) const;

  /// How much of each component of forces() rounding of the positions may be, at most about:
  /// epsilon times |stiffness| |x|, summed over the items [N]; 3 per node.
  /// \pre u is admissible.
  [[nodiscard]] VectorX force_round_off_n(const VectorX& u) const;

 private:
  struct Plan;
  std::unique_ptr<const Plan> plan_;
};

}  // namespace lefort::fem
