/// \file
/// Smoothed aggregation multigrid for elasticity, as a preconditioner.
///
/// After \cite vanek1996 nodes are grouped into aggregates; what a body barely resists, its rigid
/// motions, spans the coarse space on each; one step of Jacobi's method smooths that; and the
/// equations there, six unknowns an aggregate, are treated likewise until they are few.
#pragma once

#include <lefort/core/types.h>
#include <lefort/linear/aggregate.h>
#include <lefort/linear/block_matrix.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace lefort::linear {

/// Constants of the method, for trials; the defaults were measured.
struct MultigridOptions {
  double strong_coupling = 0.02;    ///< See aggregate(); halved from level to level.
  int smoothing_degree = 2;         ///< Of Chebyshev's polynomial, before and after; >= 1.
  double smoothed_range = 20.0;     ///< From the largest eigenvalue down to this part of it.
  std::int32_t direct_rows = 3000;  ///< So few rows are solved directly.
};

class Multigrid {
 public:
  /// \param A      symmetric; has to live as long as this.
  /// \param modes  rigid motions of the rows of A.
  /// \returns nothing if A is not positive definite, as far as that is seen.
  [[nodiscard]] static std::optional<Multigrid> build(const BlockMatrix<3, 3>& A, Modes<3> modes,
                                                      const MultigridOptions& options = {});
  ~Multigrid();
  Multigrid(Multigrid&&) noexcept;
  Multigrid& operator=(Multigrid&&) noexcept;

  /// Says that A has got other values. The smoother of the finest level is made for them; coarser
  /// levels stay those of the matrix it was built for, so that a cycle is worth less the further A
  /// is from that one.
  ///
  /// \returns false if a diagonal block of A is not positive definite.
  [[nodiscard]] bool follow();

  /// One V-cycle: an approximation of A^-1 b, symmetric and positive definite.
  [[nodiscard]] VectorX cycle(const VectorX& b) const;

  [[nodiscard]] int level_count() const;
  /// Numbers in the matrices of all levels by those of A.
  [[nodiscard]] double operator_complexity() const;

 private:
  struct Hierarchy;
  explicit Multigrid(std::unique_ptr<Hierarchy> hierarchy);
  std::unique_ptr<Hierarchy> hierarchy_;
};

/// The rigid motions of points: three translations, three rotations about their middle.
///
/// \param points      where each row of the matrix acts [mm],
/// \param components  and along which axis, 0 to 2.
/// \param blocks      where the rows of the matrix are among those of its blocks.
[[nodiscard]] Modes<3> rigid_modes(std::span<const Vec3> points,
                                   std::span<const std::int32_t> components,
                                   const SymmetricBlocks& blocks);

}  // namespace lefort::linear
