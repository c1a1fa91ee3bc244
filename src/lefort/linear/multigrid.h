/// \file
/// Smoothed aggregation multigrid for elasticity, as a preconditioner.
///
/// Nodes are grouped into aggregates (\cite vanek1996). On each aggregate the coarse space is
/// spanned by the near null space (the rigid-body modes), smoothed by one damped Jacobi step. The
/// coarse matrix has six unknowns per aggregate and is coarsened in the same way until it is small.
#pragma once

#include <lefort/core/types.h>
#include <lefort/linear/aggregate.h>
#include <lefort/linear/block_matrix.h>
#include <lefort/linear/linear_solve_status.h>

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lefort::linear {

/// Constants of the method; the defaults were chosen by measurements.
struct MultigridOptions {
  double strong_coupling = 0.02;  ///< Threshold of aggregate(); halved on each level.
  /// Degree of the Chebyshev smoother, before and after the coarse correction; >= 1.
  int smoothing_degree = 2;
  /// The smoother damps the eigenvalues of D^-1 A between the largest one and the largest one
  /// divided by this number; D: the diagonal blocks of A.
  double smoothed_range = 20.0;
  /// The first coarse matrix with at most this many rows, or with hardly fewer than the finer
  /// matrix, is solved directly.
  std::int32_t direct_rows = 3000;
};

/// A hierarchy of matrices and its V-cycle.
class Multigrid {
 public:
  /// Builds the hierarchy of a matrix.
  ///
  /// \param A        symmetric; must outlive the hierarchy.
  /// \param modes    rigid-body modes of the rows of A.
  /// \param options  constants of the method.
  /// \returns the hierarchy, or
  ///   - kNotPositiveDefinite  A is found not to be positive definite;
  ///   - kOutOfMemory          the factor of the coarsest matrix exceeds 4 GiB or the memory.
  [[nodiscard]] static tl::expected<Multigrid, LinearSolveStatus> build(
      const BlockMatrix<3, 3>& A, Modes<3> modes, const MultigridOptions& options = {});
  ~Multigrid();
  Multigrid(Multigrid&&) noexcept;
  Multigrid& operator=(Multigrid&&) noexcept;

  /// Adapts the smoother of the finest level to new values of A. Coarser levels remain those of the
  /// matrix the hierarchy was built for, so a cycle is less effective the more A has changed.
  ///
  /// \returns false if a diagonal block of A is not positive definite.
  [[nodiscard]] bool update_smoother();

  /// One V-cycle: applies a symmetric positive definite approximation of A^-1 to b.
  [[nodiscard]] VectorX cycle(const VectorX& b) const;

  [[nodiscard]] int level_count() const;
  /// Entries of the matrices of all levels, divided by those of A.
  [[nodiscard]] double operator_complexity() const;

 private:
  struct Hierarchy;
  explicit Multigrid(std::unique_ptr<Hierarchy> hierarchy);
  std::unique_ptr<Hierarchy> hierarchy_;
};

/// The rigid-body modes of points: three translations, three rotations about their centroid.
///
/// \param points      where each row of the matrix acts [mm].
/// \param components  axis along which it acts, 0 to 2.
/// \param blocks      the matrix.
[[nodiscard]] Modes<3> rigid_modes(std::span<const Vec3> points,
                                   std::span<const std::int32_t> components,
                                   const SymmetricBlocks& blocks);

}  // namespace lefort::linear
