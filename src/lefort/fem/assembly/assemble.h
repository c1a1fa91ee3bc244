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
#include <string>
#include <vector>

namespace lefort::fem {

/// Energy and forces at one state, for all components.
struct AssembledForces {
  double energy_mj = 0.0;  ///< Of the conservative terms.
  /// Sum of all terms [N], 3 per node. At a prescribed component of a body in equilibrium this is
  /// the reaction: the force that the support exerts on the body.
  VectorX residual_n;
  /// Part of residual_n from terms that are not conservative [N]; empty if there are none.
  VectorX follower_n = {};
  /// Residual reference [N]: the absolute local forces are summed for each free component, and the
  /// residual reference is the norm of these sums. It is the size of the forces that cancel in the
  /// residual. Unlike the first residual or the reactions, it does not depend on how the load is
  /// applied. The round-off of the residual is a few 1e-16 times the residual reference.
  double residual_reference_n = 0.0;
  Index contacts = 0;       ///< Points in contact, of all items.
  double deepest_mm = 0.0;  ///< Max penetration increase of these points [mm].
  /// Bound of the round-off of energy_mj [mJ], from the rounding of positions and of sums.
  double energy_round_off_mj = 0.0;
};

/// \param from    forces at the first state.
/// \param u_from  displacements of the first state [mm].
/// \param to      forces at the second state.
/// \param u_to    displacements of the second state [mm].
/// \returns the change of energy_mj plus the integral of follower_n along the straight path, by the
///   trapezoidal rule [mJ].
[[nodiscard]] double energy_change_mj(const AssembledForces& from, const VectorX& u_from,
                                      const AssembledForces& to, const VectorX& u_to);

/// Assembles the same terms repeatedly; the layout of matrix and sums is computed once.
///
/// \note Items are evaluated in parallel. One task computes each sum in the order of terms and
///   items, so that results are bitwise identical for any number of threads. The memory for local
///   matrices does not grow with the number of items.
class Assembler {
 public:
  /// \param nodes_L  reference positions of all nodes [mm].
  /// \param dofs     which components are free; \pre has as many nodes as `nodes_L`.
  /// \param terms    must outlive the assembler; their nodes must exist.
  Assembler(std::vector<Vec3> nodes_L, DofMap dofs, std::vector<const ForceTerm*> terms);
  ~Assembler();
  Assembler(Assembler&&) noexcept;
  Assembler& operator=(Assembler&&) noexcept;

  [[nodiscard]] const DofMap& dofs() const;
  [[nodiscard]] std::span<const Vec3> nodes_L() const;

  /// \param u  displacements of all components [mm].
  /// \returns the forces, or nothing if an item is inadmissible at u.
  [[nodiscard]] std::optional<AssembledForces> forces(const VectorX& u) const;

  /// \param u  displacements of all components [mm].
  /// \returns why forces() returns nothing: the cause of the first inadmissible item, and the
  ///   position of its first node; or that a displacement is not finite. Empty if u is admissible,
  ///   or only a force is not finite.
  [[nodiscard]] std::string inadmissible_cause(const VectorX& u) const;

  /// \param u     displacements of all components [mm]; \pre admissible.
  /// \param kind  kExact or kStabilized.
  /// \returns the lower triangle of the tangent of the free components [N/mm]. Its pattern is the
  ///   same for all u and kinds.
  [[nodiscard]] linear::SparseMatrix tangent(const VectorX& u,
                                             Tangent kind = Tangent::kExact) const;

  /// \param u  displacements of all components [mm]; \pre admissible.
  /// \returns the strictly lower triangle L of the antisymmetric part L - L^T of the derivative of
  ///   the residual with respect to the free components [N/mm]; 0 by 0 if all terms are
  ///   conservative.
  [[nodiscard]] linear::SparseMatrix antisymmetric_tangent(const VectorX& u) const;

  /// \param u     displacements of all components [mm]; \pre admissible.
  /// \param du    displacement increments of all components [mm].
  /// \param kind  kExact or kStabilized.
  /// \returns (tangent of all components) * du [N], computed item by item.
  [[nodiscard]] VectorX tangent_times(const VectorX& u, const VectorX& du,
                                      Tangent kind = Tangent::kExact) const;

  /// \param u  displacements of all components [mm]; \pre admissible.
  /// \returns an estimate of the round-off of each component of the residual from the rounding of
  ///   positions: machine epsilon times |stiffness| |x|, summed over the items [N]; 3 per node.
  [[nodiscard]] VectorX force_round_off_n(const VectorX& u) const;

 private:
  struct Plan;
  std::unique_ptr<const Plan> plan_;
};

}  // namespace lefort::fem
