#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/trace.h>
#include <lefort/linear/conjugate_gradients.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/linear/multigrid.h>
#include <lefort/linear/sparse_cholesky.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lefort::linear {
namespace {

/// Smaller matrices are solved directly instead of with a multigrid hierarchy.
constexpr Index kMultigridRows = 3000;

bool all_finite(const SparseMatrix& A) {
  const double* values = A.valuePtr();
  // The sum of magnitudes is finite exactly if every term is, except for overflow, which is
  // rejected, too.
  return std::isfinite(
      deterministic_sum(A.nonZeros(), 0.0, [&](Index k) { return std::abs(values[k]); }));
}

/// The pattern of a matrix.
struct Pattern {
  std::vector<int> columns, rows;

  [[nodiscard]] bool matches(const SparseMatrix& A) const {
    return Index(columns.size()) == A.cols() + 1 && Index(rows.size()) == A.nonZeros() &&
           std::equal(columns.begin(), columns.end(), A.outerIndexPtr()) &&
           std::equal(rows.begin(), rows.end(), A.innerIndexPtr());
  }
  void assign(const SparseMatrix& A) {
    columns.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1);
    rows.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
  }
};

LinearSolveStatus status_of(CgStop stop) {
  return stop == CgStop::kTooManyIterations ? LinearSolveStatus::kNotConverged
                                            : LinearSolveStatus::kNotPositiveDefinite;
}

}  // namespace

struct LinearSolver::Parts {
  LinearSolverOptions options;
  Statistics statistics;
  Pattern pattern;
  std::optional<LinearSolverKind> kind;  ///< For this pattern.
  bool multigrid_failed = false;         ///< With this pattern.
  bool ready = false;

  std::vector<Vec3> points_L;            ///< Where each row acts.
  std::vector<std::int32_t> components;  ///< Axis along which each row acts, 0 to 2.

  std::optional<SparseCholesky> cholesky;  ///< Direct, reused factor.
  std::optional<SymmetricBlocks> blocks;   ///< The matrix, for iterative kinds.
  std::optional<Multigrid> multigrid;
  bool multigrid_is_new = false;       ///< It was built for the current matrix.
  bool multigrid_is_outdated = false;  ///< It converges too slowly and will be rebuilt.
  double iterations_per_digit = 0.0;   ///< Of conjugate gradients when the hierarchy was new.
  std::vector<double> values;  ///< Reused factor: of the current matrix, for its factorization.
  bool has_factor = false;     ///< Reused factor: `cholesky` contains a factor.
  bool factor_is_new = false;  ///< It is the factor of the current matrix.
  bool factor_is_outdated = false;  ///< It converges too slowly and will be recomputed.

  [[nodiscard]] LinearSolverKind kind_for(Index rows) const {
    const bool has_points = Index(points_L.size()) == rows;
    switch (options.kind) {
      case LinearSolverKind::kDirect:
      case LinearSolverKind::kReusedFactor:
        return options.kind;
      case LinearSolverKind::kMultigrid:
        LEFORT_CHECK(has_points);
        return rows <= kMultigridRows ? LinearSolverKind::kDirect : options.kind;
      case LinearSolverKind::kAutomatic:
        break;
    }
    return has_points && rows > options.direct_rows && !multigrid_failed
               ? LinearSolverKind::kMultigrid
               : LinearSolverKind::kDirect;
  }

  /// Prepares everything that depends on the pattern only.
  [[nodiscard]] LinearSolveStatus analyze(const SparseMatrix& A, LinearSolverKind wanted) {
    kind.reset();
    cholesky.reset();  // Frees memory first.
    blocks.reset();
    multigrid.reset();
    has_factor = factor_is_outdated = false;
    ++statistics.analyses;
    statistics.factor_entries = 0.0;
    if (wanted != LinearSolverKind::kMultigrid) {
      const TraceSpan span("analyze matrix");
      std::optional<CholeskyPlan> plan = plan_cholesky(A);
      if (!plan) return LinearSolveStatus::kOutOfMemory;
      statistics.factor_entries = double(plan->factor_entries);
      cholesky.emplace(*std::move(plan), options.memory_bytes);
    }
    if (wanted != LinearSolverKind::kDirect) blocks.emplace(A);
    pattern.assign(A);
    kind = wanted;
    return LinearSolveStatus::kDone;
  }

  [[nodiscard]] LinearSolveStatus factorize_values(std::span<const double> of_A) {
    const TraceSpan span("factorize");
    ++statistics.factorizations;
    const LinearSolveStatus outcome = cholesky->factorize(of_A);
    has_factor = factor_is_new = outcome == LinearSolveStatus::kDone;
    factor_is_outdated = false;
    return outcome;
  }

  [[nodiscard]] LinearSolveStatus prepare(const SparseMatrix& A) {
    if (!all_finite(A)) return LinearSolveStatus::kNotFinite;
    if (!pattern.matches(A)) multigrid_failed = false;
    const LinearSolverKind wanted = kind_for(A.rows());
    if (kind != wanted || !pattern.matches(A)) {
      const LinearSolveStatus analyzed = analyze(A, wanted);
      if (analyzed != LinearSolveStatus::kDone) return analyzed;
    }
    const std::span<const double> of_A(A.valuePtr(), std::size_t(A.nonZeros()));
    if (wanted == LinearSolverKind::kDirect) return factorize_values(of_A);
    blocks->set_values(of_A);
    if (wanted == LinearSolverKind::kReusedFactor) {
      values.assign(of_A.begin(), of_A.end());
      factor_is_new = false;
      return has_factor && !factor_is_outdated ? LinearSolveStatus::kDone : factorize_values(of_A);
    }
    if (!multigrid || multigrid_is_outdated) return build_multigrid();
    multigrid_is_new = false;
    return multigrid->update_smoother() ? LinearSolveStatus::kDone
                                        : LinearSolveStatus::kNotPositiveDefinite;
  }

  [[nodiscard]] LinearSolveStatus build_multigrid() {
    const TraceSpan span("build multigrid");
    ++statistics.factorizations;
    multigrid.reset();  // Frees memory first.
    auto built = Multigrid::build(blocks->matrix(), rigid_modes(points_L, components, *blocks));
    if (!built) return built.error();
    multigrid = *std::move(built);
    multigrid_is_new = true;
    multigrid_is_outdated = false;
    return LinearSolveStatus::kDone;
  }

  /// Conjugate gradients with `precondition`, on vectors over the rows of the blocks.
  template <class Precondition>
  [[nodiscard]] CgOutcome iterate(const VectorX& b, const Precondition& precondition,
                                  double tolerance, int max_iterations) {
    const TraceSpan span("conjugate gradients");
    CgOutcome outcome =
        conjugate_gradients([&](const VectorX& x, VectorX& y) { multiply(blocks->matrix(), x, y); },
                            precondition, b, VectorX::Zero(b.size()), tolerance, max_iterations);
    statistics.iterations += outcome.iterations;
    return outcome;
  }

  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve_directly(const VectorX& b) const {
    const TraceSpan span("solve with factor");
    std::optional<VectorX> x = cholesky->solve(b);
    if (!x) return tl::unexpected(LinearSolveStatus::kOutOfMemory);
    return *std::move(x);
  }

  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve_by_multigrid(const VectorX& b,
                                                                            double tolerance) {
    // Iterations that cost as much as building a hierarchy.
    constexpr double kIterationsPerHierarchy = 8.0;
    const CgOutcome outcome = iterate(
        blocks->to_blocks(b), [&](const VectorX& r, VectorX& z) { z = multigrid->cycle(r); },
        tolerance, options.max_iterations);
    if (outcome.stop == CgStop::kConverged) {
      const double digits = std::max(-std::log10(tolerance), 1.0);
      if (multigrid_is_new) iterations_per_digit = outcome.iterations / digits;
      multigrid_is_outdated =
          outcome.iterations > iterations_per_digit * digits + kIterationsPerHierarchy;
      return blocks->from_blocks(outcome.x);
    }
    if (!multigrid_is_new && outcome.stop != CgStop::kNotPositiveDefinite) {
      const LinearSolveStatus rebuilt = build_multigrid();
      return rebuilt == LinearSolveStatus::kDone ? solve_by_multigrid(b, tolerance)
                                                 : tl::unexpected(rebuilt);
    }
    multigrid_failed = outcome.stop == CgStop::kTooManyIterations;
    return tl::unexpected(status_of(outcome.stop));
  }

  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve_by_reused_factor(const VectorX& b,
                                                                                double tolerance) {
    if (factor_is_new) return solve_directly(b);
    bool out_of_memory = false;
    const int max_iterations = iterations_per_factorization();
    const CgOutcome outcome = iterate(
        blocks->to_blocks(b),
        [&](const VectorX& r, VectorX& z) {
          const std::optional<VectorX> x = cholesky->solve(blocks->from_blocks(r));
          out_of_memory = !x;
          z = x ? blocks->to_blocks(*x) : VectorX::Zero(r.size());
        },
        tolerance, max_iterations);
    if (out_of_memory) return tl::unexpected(LinearSolveStatus::kOutOfMemory);
    if (outcome.stop == CgStop::kNotPositiveDefinite)
      return tl::unexpected(LinearSolveStatus::kNotPositiveDefinite);
    factor_is_outdated = 2 * outcome.iterations > max_iterations;
    if (outcome.stop == CgStop::kConverged) return blocks->from_blocks(outcome.x);
    const LinearSolveStatus rebuilt = factorize_values(values);
    if (rebuilt != LinearSolveStatus::kDone) return tl::unexpected(rebuilt);
    return solve_directly(b);
  }

  /// Number of solves with the factor that cost as much as a factorization. It is estimated from
  /// operation counts, so that it is the same on every machine.
  [[nodiscard]] int iterations_per_factorization() const {
    // Operations per read from memory of equal cost; measured.
    constexpr double kOperationsPerRead = 30.0;
    constexpr double kMinimum = 8.0, kMaximum = 100.0;
    const CholeskyPlan& plan = cholesky->plan();
    const double ratio =
        plan.work() / (kOperationsPerRead * std::max(1.0, double(plan.factor_entries)));
    return int(std::clamp(ratio, kMinimum, kMaximum));
  }
};

LinearSolver::LinearSolver(const LinearSolverOptions& options) : parts_(std::make_unique<Parts>()) {
  LEFORT_CHECK(options.direct_rows >= 0 && options.max_iterations >= 1 && options.memory_bytes > 0);
  parts_->options = options;
}
LinearSolver::~LinearSolver() = default;
LinearSolver::LinearSolver(LinearSolver&&) noexcept = default;
LinearSolver& LinearSolver::operator=(LinearSolver&&) noexcept = default;

void LinearSolver::set_near_null_space(std::vector<Vec3> points_L,
                                       std::vector<std::int32_t> components) {
  LEFORT_CHECK(points_L.size() == components.size());
  parts_->points_L = std::move(points_L);
  parts_->components = std::move(components);
}

LinearSolveStatus LinearSolver::factorize(const SparseMatrix& A) {
  LEFORT_CHECK(A.rows() == A.cols() && A.isCompressed());
  parts_->ready = false;
  try {
    const LinearSolveStatus outcome = parts_->prepare(A);
    parts_->ready = outcome == LinearSolveStatus::kDone;
    return outcome;
  } catch (const std::bad_alloc&) {
    return LinearSolveStatus::kOutOfMemory;
  }
}

tl::expected<VectorX, LinearSolveStatus> LinearSolver::solve(const VectorX& b, double tolerance) {
  Parts& parts = *parts_;
  LEFORT_CHECK(parts.ready && b.size() == Index(parts.pattern.columns.size()) - 1);
  LEFORT_CHECK(tolerance > 0.0);
  try {
    switch (kind()) {
      case LinearSolverKind::kReusedFactor:
        return parts.solve_by_reused_factor(b, tolerance);
      case LinearSolverKind::kMultigrid:
        return parts.solve_by_multigrid(b, tolerance);
      default:
        return parts.solve_directly(b);
    }
  } catch (const std::bad_alloc&) {
    return tl::unexpected(LinearSolveStatus::kOutOfMemory);
  }
}

tl::expected<VectorX, LinearSolveStatus> LinearSolver::solve(
    const SparseMatrix& A, const VectorX& b, double tolerance,
    const std::function<void()>& on_factorized) {
  const auto attempt = [&]() -> tl::expected<VectorX, LinearSolveStatus> {
    const LinearSolveStatus outcome = factorize(A);
    if (outcome != LinearSolveStatus::kDone) return tl::unexpected(outcome);
    if (on_factorized) on_factorized();
    return solve(b, tolerance);
  };
  auto x = attempt();
  const bool may_be_direct = parts_->options.kind == LinearSolverKind::kAutomatic;
  if (!x && x.error() == LinearSolveStatus::kNotConverged && may_be_direct) return attempt();
  return x;
}

LinearSolverKind LinearSolver::kind() const {
  LEFORT_CHECK(parts_->kind.has_value());
  return *parts_->kind;
}

const LinearSolver::Statistics& LinearSolver::statistics() const { return parts_->statistics; }

}  // namespace lefort::linear
