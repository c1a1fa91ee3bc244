/// \file
/// Interface of everything that exerts forces on nodes: elements, loads, contact.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/tangent.h>

#include <cstdint>
#include <span>
#include <string>

namespace lefort::fem {

/// Max number of nodes of one local item. In a good mesh of tet10 the elements around one corner
/// have 65 to 130 nodes.
inline constexpr int kMaxLocalNodes = 192;

/// Energy, residual and stiffness of one local item. The Assembler owns the memory and sets it to
/// zero before evaluate().
struct LocalEquations {
  double energy_mj = 0.0;          ///< W [mJ].
  Eigen::Map<VectorX> residual_n;  ///< dW/dx [N]: x, y, z of the first node, of the second, ...
  Eigen::Map<Eigen::MatrixXd> stiffness_n_per_mm;  ///< d2W/dx2 [N/mm]; 0 by 0 if not needed.
  /// Kind of the stiffness that is needed. A term may return the exact one for kStabilized.
  /// kAntisymmetric is needed only if is_conservative() is false.
  Tangent tangent = Tangent::kExact;
  Index contacts = 0;       ///< Points in contact, for the history.
  double deepest_mm = 0.0;  ///< Max penetration increase of these points [mm].

  /// \returns false if only energy and residual are needed.
  [[nodiscard]] bool wants_stiffness() const { return stiffness_n_per_mm.size() > 0; }
};

/// A list of local items (elements, contact faces), each of which couples a few nodes.
///
/// The nodes of an item never change, so that the solver can lay out its matrix once. The
/// contribution of an item may be zero (a contact face far from the bone). Between two solves the
/// owner of a term may change its state (the pose of an obstacle), but not its items or their
/// nodes.
class ForceTerm {
 public:
  virtual ~ForceTerm() = default;

  /// \returns the number of local items, >= 0.
  [[nodiscard]] virtual Index item_count() const = 0;

  /// \returns the nodes that `item` couples, all different, at most kMaxLocalNodes.
  [[nodiscard]] virtual std::span<const std::int32_t> nodes(Index item) const = 0;

  /// Evaluates one item at the current positions of its nodes.
  ///
  /// \param item   0 to item_count() - 1.
  /// \param x_L    current positions of nodes(item), in their order [mm].
  /// \param local  receives energy, residual and, if needed, both triangles of the stiffness.
  /// \returns false if x_L is inadmissible (an inverted element, NaN); `local` is then ignored, and
  ///   the solver shortens its step.
  /// \note Called by many threads at once, millions of times: it must not allocate memory, and must
  ///   not change data that items share.
  [[nodiscard]] virtual bool evaluate(Index item, std::span<const Vec3> x_L,
                                      LocalEquations& local) const = 0;

  /// \returns why evaluate() returns false, for messages: a clause without a full stop.
  [[nodiscard]] virtual std::string inadmissible_cause() const { return "an element is inverted"; }

  /// \param dofs  which components are free.
  /// \returns whether the residual, summed over all items, is the gradient of the energy with
  ///   respect to the free components. If not (a follower pressure on a surface with a free
  ///   border), the residual is still the force, the energy is ignored, and the stiffness is the
  ///   symmetric or, for kAntisymmetric, the antisymmetric part of the derivative of the residual.
  [[nodiscard]] virtual bool is_conservative(const DofMap& /*dofs*/) const { return true; }
};

}  // namespace lefort::fem
