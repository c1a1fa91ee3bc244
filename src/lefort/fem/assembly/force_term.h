/// \file
/// The seam of the solver: whatever stores energy in nodes pushes on them, and says how stiffly.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/tangent.h>

#include <cstdint>
#include <span>

namespace lefort::fem {

/// The most nodes one local item may couple. The elements around one node of a good mesh of
/// tetrahedra have fifteen to fifty.
inline constexpr int kMaxLocalNodes = 64;

/// What one local item adds to the balance. The solver owns the memory; it is zero on entry.
struct LocalEquations {
  double energy_mj = 0.0;          ///< W [mJ].
  Eigen::Map<VectorX> residual_n;  ///< dW/dx [N]: x, y, z of the first node, of the second, ...
  Eigen::Map<Eigen::MatrixXd> stiffness_n_per_mm;  ///< d2W/dx2 [N/mm]; 0 by 0 if not wanted.
  /// Which stiffness is wanted. Instead of a convex one the exact one is allowed; the antisymmetric
  /// one is asked for only where is_conservative() says no.
  Tangent tangent = Tangent::kExact;
  Index contacts = 0;       ///< Points at which a body is touched now, for the history.
  double deepest_mm = 0.0;  ///< How deep one of them lies, for who watches [mm].

  /// False on the cheaper path: energy and residual only.
  [[nodiscard]] bool wants_stiffness() const { return stiffness_n_per_mm.size() > 0; }
};

/// A list of local items (elements, contact faces), each coupling a few nodes.
///
/// The nodes of an item never change, so that the solver can lay out its matrix once; what an item
/// adds may be zero (a contact face far from the bone). Between two solves the owner of a term may
/// change its state (the pose of an obstacle), but neither its items nor their nodes.
class ForceTerm {
 public:
  virtual ~ForceTerm() = default;

  /// How many local items there are, >= 0.
  [[nodiscard]] virtual Index item_count() const = 0;

  /// The nodes coupled by `item`, all different, at most kMaxLocalNodes.
  [[nodiscard]] virtual std::span<const std::int32_t> nodes(Index item) const = 0;

  /// Evaluates one item where its nodes are now.
  ///
  /// \param item   0 to item_count() - 1.
  /// \param x_L    current positions of nodes(item), in their order [mm].
  /// \param local  receives energy, residual and, if wanted, the stiffness with both triangles
  ///   filled.
  /// \returns false if the item has no energy at x_L (an element turned inside out, NaN); `local`
  ///   is then ignored and the solver backs off.
  /// \note Called from many threads at once, millions of times: must not allocate, nor change
  ///   anything that two items share.
  [[nodiscard]] virtual bool evaluate(Index item, std::span<const Vec3> x_L,
                                      LocalEquations& local) const = 0;

  /// Whether the residual, summed over all items, is the gradient of the energy by the free
  /// components. If not (a pressure that follows a surface with a free rim), it still is the force;
  /// the energy is ignored, and the stiffness is that part of the residual's derivative, symmetric
  /// or antisymmetric, which is asked for.
  [[nodiscard]] virtual bool is_conservative(const DofMap& /*dofs*/) const { return true; }
};

}  // namespace lefort::fem
