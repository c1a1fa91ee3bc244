#include <lefort/core/check.h>
#include <lefort/linear/block_product.h>
#include <lefort/linear/conjugate_gradients.h>
#include <lefort/linear/multigrid.h>
#include <lefort/linear/sparse_cholesky.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <utility>
#include <vector>

namespace lefort::linear {
namespace {

constexpr std::int64_t kCoarsestBytes = std::int64_t(1) << 32;

/// The inverses of the diagonal blocks of a matrix; nothing if a block is not positive definite.
template <int kRows>
std::optional<std::vector<Eigen::Matrix<double, kRows, kRows>>> inverse_diagonal(
    const BlockMatrix<kRows, kRows>& A) {
  std::vector<Eigen::Matrix<double, kRows, kRows>> inverse(std::size_t(A.rows()));
  const double failures = deterministic_sum(A.rows(), 0.0, [&](Index i) {
    for (Index k = A.row_begin(i); k < A.row_end(i); ++k) {
      if (A.column[std::size_t(k)] != i) continue;
      const Eigen::Matrix<double, kRows, kRows> block = A.block(k);
      const Eigen::LLT<Eigen::Matrix<double, kRows, kRows>> factor(block);
      inverse[std::size_t(i)] = factor.solve(Eigen::Matrix<double, kRows, kRows>::Identity());
      return factor.info() == Eigen::Success ? 0.0 : 1.0;
    }
    return 1.0;
  });
  if (failures > 0.0) return std::nullopt;
  return inverse;
}

/// One level of the hierarchy: matrix, smoother, and transfer to the next level.
template <int kRows>
struct Level {
  using Diagonal = std::vector<Eigen::Matrix<double, kRows, kRows>>;
  BlockMatrix<kRows, kRows> own_A;  ///< Empty on the finest level.
  const BlockMatrix<kRows, kRows>* A = nullptr;
  Diagonal inverse;             ///< Blocks of D^-1.
  double max_eigenvalue = 0.0;  ///< Estimate for D^-1 A.
  VectorX eigenvector;          ///< Estimate of its eigenvector.
  BlockMatrix<kRows, 6> to_fine;
  BlockMatrix<6, kRows> to_coarse;

  [[nodiscard]] VectorX divide_by_diagonal(const VectorX& r) const {
    VectorX z(r.size());
    parallel_for(
        A->rows(),
        [&](Index i) {
          z.segment<kRows>(kRows * i).noalias() =
              inverse[std::size_t(i)] * r.segment<kRows>(kRows * i);
        },
        kBlockRowsPerTask);
    return z;
  }
};

/// Computes D^-1 and estimates the largest eigenvalue of D^-1 A by power iteration, with a safety
/// factor because the iteration converges from below.
///
/// \returns false if D is not positive definite.
template <int kRows>
[[nodiscard]] bool prepare_smoother(Level<kRows>& level) {
  constexpr int kSteps = 15;
  constexpr int kStepsFromSimilar = 4;  ///< If started from the eigenvector of a similar matrix.
  constexpr double kSafety = 1.1;
  auto inverse = inverse_diagonal(*level.A);
  if (!inverse) return false;
  level.inverse = *std::move(inverse);

  VectorX& x = level.eigenvector;
  const int steps = x.size() > 0 ? kStepsFromSimilar : kSteps;
  if (x.size() == 0) {
    x = VectorX::Zero(Index(kRows) * level.A->rows());
    // Pseudorandom numbers, the same in each run.
    std::uint64_t state = 1;
    for (double& value : x) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      value = double(state >> 11) * 0x1p-53 - 0.5;
    }
  }
  VectorX Ax;
  double max_eigenvalue = 0.0;
  for (int step = 0; step < steps; ++step) {
    x /= std::sqrt(inner_product(x, x));
    multiply(*level.A, x, Ax);
    x = level.divide_by_diagonal(Ax);
    max_eigenvalue = std::sqrt(inner_product(x, x));
  }
  level.max_eigenvalue = kSafety * max_eigenvalue;
  return true;
}

/// Smooths x with the Chebyshev polynomial in D^-1 A (\cite saad2003, algorithm 12.1).
///
/// \param x  initial iterate; empty means zero.
template <int kRows>
void smooth(const Level<kRows>& level, const MultigridOptions& options, const VectorX& b,
            VectorX& x) {
  const double high = level.max_eigenvalue, low = high / options.smoothed_range;
  const double middle = 0.5 * (high + low), half = 0.5 * (high - low);
  VectorX r = b, Ad;
  if (x.size() == 0) {
    x = VectorX::Zero(b.size());
  } else {
    multiply(*level.A, x, Ad);
    r -= Ad;
  }
  VectorX d = level.divide_by_diagonal(r) / middle;
  double ratio = half / middle;
  for (int k = 1; k < options.smoothing_degree; ++k) {
    x += d;
    multiply(*level.A, d, Ad);
    r -= Ad;
    const double next = 1.0 / (2.0 * middle / half - ratio);
    d = (next * ratio) * d + (2.0 * next / half) * level.divide_by_diagonal(r);
    ratio = next;
  }
  x += d;
}

/// P = (I - omega D^-1 A) basis, the smoothed prolongation (\cite vanek1996).
template <int kRows>
BlockMatrix<kRows, 6> smoothed(const Level<kRows>& level, const BlockMatrix<kRows, 6>& basis) {
  constexpr double kDamping = 4.0 / 3.0;
  const double omega = kDamping / level.max_eigenvalue;
  BlockMatrix<kRows, 6> P = product(*level.A, basis);
  parallel_for(P.rows(), [&](Index i) {
    for (Index k = P.row_begin(i); k < P.row_end(i); ++k) {
      P.block(k) = (-omega * level.inverse[std::size_t(i)] * P.block(k)).eval();
      if (P.column[std::size_t(k)] == basis.column[std::size_t(i)]) P.block(k) += basis.block(i);
    }
  });
  return P;
}

/// Puts ones on the diagonal for missing modes, whose rows are zero.
void fill_missing(BlockMatrix<6, 6>& A, const Modes<6>& modes) {
  parallel_for(A.rows(), [&](Index i) {
    for (Index k = A.row_begin(i); k < A.row_end(i); ++k)
      if (A.column[std::size_t(k)] == i)
        for (int c = 0; c < 6; ++c)
          if (modes[std::size_t(i)](c, c) == 0.0) A.block(k)(c, c) = 1.0;
  });
}

SparseMatrix lower_triangle(const BlockMatrix<6, 6>& A) {
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index i = 0; i < A.rows(); ++i)
    for (Index k = A.row_begin(i); k < A.row_end(i); ++k) {
      const Index j = A.column[std::size_t(k)];
      if (j > i) continue;
      for (Index c = 0; c < 6; ++c)
        for (Index r = i == j ? c : 0; r < 6; ++r)
          entries.emplace_back(int(6 * i + r), int(6 * j + c), A.block(k)(r, c));
    }
  SparseMatrix lower(6 * A.rows(), 6 * A.rows());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

}  // namespace

struct Multigrid::Hierarchy {
  MultigridOptions options;
  Level<3> finest;
  std::vector<Level<6>> coarse;
  std::unique_ptr<SparseCholesky> coarsest;
  std::int32_t coarsest_rows = 0;
  double complexity = 1.0;

  /// Builds the transfer to the next level.
  ///
  /// \returns the matrix of the next level.
  template <int kRows>
  [[nodiscard]] std::optional<BlockMatrix<6, 6>> coarsen(Level<kRows>& level, double threshold,
                                                         const Modes<kRows>& modes,
                                                         Modes<6>& coarse_modes) const {
    if (!prepare_smoother(level)) return std::nullopt;
    CoarseSpace<kRows> space = coarse_space(aggregate(*level.A, threshold), modes);
    level.to_fine = smoothed(level, space.basis);
    level.to_coarse = transposed(level.to_fine);
    BlockMatrix<6, 6> next = product(level.to_coarse, product(*level.A, level.to_fine));
    fill_missing(next, space.modes);
    coarse_modes = std::move(space.modes);
    return next;
  }

  /// \throws std::bad_alloc if memory is exhausted.
  [[nodiscard]] VectorX solve_coarsest(const VectorX& b) const {
    std::optional<VectorX> x = coarsest->solve(b);
    if (!x) throw std::bad_alloc();
    return *std::move(x);
  }

  template <int kRows>
  [[nodiscard]] VectorX cycle(const Level<kRows>& level, std::size_t next, const VectorX& b) const {
    VectorX x;
    smooth(level, options, b, x);
    VectorX r, coarse_r, correction;
    multiply(*level.A, x, r);
    r = b - r;
    multiply(level.to_coarse, r, coarse_r);
    const VectorX coarse_x =
        next < coarse.size() ? cycle(coarse[next], next + 1, coarse_r) : solve_coarsest(coarse_r);
    multiply(level.to_fine, coarse_x, correction);
    x += correction;
    smooth(level, options, b, x);
    return x;
  }
};

tl::expected<Multigrid, LinearSolveStatus> Multigrid::build(const BlockMatrix<3, 3>& A,
                                                            Modes<3> modes,
                                                            const MultigridOptions& options) {
  constexpr double kMaxRowRatio = 0.8;  // Larger ratios of the rows of two levels do not pay.
  LEFORT_CHECK(Index(modes.size()) == A.rows());
  auto hierarchy = std::make_unique<Hierarchy>();
  hierarchy->options = options;
  hierarchy->finest.A = &A;
  Modes<6> coarse_modes;
  double threshold = options.strong_coupling;
  auto next = hierarchy->coarsen(hierarchy->finest, threshold, modes, coarse_modes);
  modes = {};
  std::size_t numbers = A.values.size();
  std::int32_t rows_before = 3 * A.rows();
  while (next) {
    numbers += next->values.size();
    const std::int32_t rows = 6 * next->rows();
    if (rows <= options.direct_rows || rows > kMaxRowRatio * rows_before) break;
    rows_before = rows;
    threshold *= 0.5;
    Level<6>& level = hierarchy->coarse.emplace_back();
    level.own_A = *std::move(next);
    level.A = nullptr;
    Modes<6> here = std::exchange(coarse_modes, {});
    level.A = &level.own_A;
    next = hierarchy->coarsen(level, threshold, here, coarse_modes);
  }
  if (!next) return tl::unexpected(LinearSolveStatus::kNotPositiveDefinite);
  // Growth of the vector has moved them.
  for (Level<6>& level : hierarchy->coarse) level.A = &level.own_A;
  hierarchy->complexity = double(numbers) / double(A.values.size());

  const SparseMatrix coarsest = lower_triangle(*next);
  std::optional<CholeskyPlan> plan = plan_cholesky(coarsest);
  if (!plan) return tl::unexpected(LinearSolveStatus::kOutOfMemory);
  hierarchy->coarsest = std::make_unique<SparseCholesky>(*std::move(plan), kCoarsestBytes);
  const LinearSolveStatus status =
      hierarchy->coarsest->factorize({coarsest.valuePtr(), std::size_t(coarsest.nonZeros())});
  if (status != LinearSolveStatus::kDone) return tl::unexpected(status);
  return Multigrid(std::move(hierarchy));
}

Multigrid::Multigrid(std::unique_ptr<Hierarchy> hierarchy) : hierarchy_(std::move(hierarchy)) {}
Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;
Multigrid& Multigrid::operator=(Multigrid&&) noexcept = default;

bool Multigrid::update_smoother() { return prepare_smoother(hierarchy_->finest); }

VectorX Multigrid::cycle(const VectorX& b) const {
  return hierarchy_->cycle(hierarchy_->finest, 0, b);
}

int Multigrid::level_count() const { return int(hierarchy_->coarse.size()) + 2; }
double Multigrid::operator_complexity() const { return hierarchy_->complexity; }

Modes<3> rigid_modes(std::span<const Vec3> points, std::span<const std::int32_t> components,
                     const SymmetricBlocks& blocks) {
  LEFORT_CHECK(points.size() == components.size());
  const auto n = Index(points.size());
  const Vec3 middle =
      deterministic_sum(n, Vec3(Vec3::Zero()), [&](Index i) { return points[std::size_t(i)]; }) /
      double(std::max<Index>(n, 1));
  // Scales rotations so that their mean displacement is that of translations.
  const double squared = deterministic_sum(
      n, 0.0, [&](Index i) { return (points[std::size_t(i)] - middle).squaredNorm(); });
  const double size = squared > 0.0 ? std::sqrt(squared / double(n)) : 1.0;
  Modes<3> modes(std::size_t(blocks.matrix().rows()), Modes<3>::value_type::Zero());
  for (Index i = 0; i < n; ++i) {
    const std::int32_t row = blocks.row_in_blocks(i);
    const std::int32_t c = components[std::size_t(i)];
    const Vec3 x = (points[std::size_t(i)] - middle) / size;
    auto mode = modes[std::size_t(row / 3)].row(row % 3);
    mode[c] = 1.0;
    for (int axis = 0; axis < 3; ++axis) mode[3 + axis] = Vec3::Unit(axis).cross(x)[c];
  }
  return modes;
}

}  // namespace lefort::linear
