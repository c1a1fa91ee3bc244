#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
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

/// So few rows are not worth a hierarchy.
constexpr Index kMultigridRows = 3000;

bool all_finite(const SparseMatrix& A) {
  const double* values = A.valuePtr();
  // A sum of magnitudes is finite exactly if every term is (but for overflow, as bad).
  return std::isfinite(
      deterministic_sum(A.nonZeros(), 0.0, [&](Index k) { return std::abs(values[k]); }));
}

/// The pattern of a matrix.
struct Pattern {
  std::vector<int> columns, rows;

  [[nodiscard]] bool is_of(const SparseMatrix& A) const {
    return Index(columns.size()) == A.cols() + 1 && Index(rows.size()) == A.nonZeros() &&
           std::equal(columns.begin(), columns.end(), A.outerIndexPtr()) &&
           std::equal(rows.begin(), rows.end(), A.innerIndexPtr());
  }
  void become_that_of(const SparseMatrix& A) {
    columns.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1);
    rows.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
  }
};

LinearSolveStatus meaning_of(CgStop stop) {
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

  std::vector<Vec3> points_L;            ///< Where the rows act,
  std::vector<std::int32_t> components;  ///< and along which axis.

  std::optional<SparseCholesky> cholesky;  ///< Direct, lagged.
  std::optional<SymmetricBlocks> blocks;   ///< Lagged, multigrid: the matrix.
  std::optional<Multigrid> multigrid;
  bool multigrid_is_new = false;      ///< It was built for this matrix.
  bool multigrid_is_worn = false;     ///< It has become too old.
  double iterations_per_digit = 0.0;  ///< Of conjugate gradients when it was new.
  std::vector<double> values;         ///< Lagged: of the matrix, for the next factor.
  bool has_factor = false;            ///< Lagged: there is one,
  bool factor_is_new = false;         ///< it is that of the matrix,
  bool factor_is_worn = false;        ///< it has become too old.

  [[nodiscard]] LinearSolverKind kind_for(Index rows) const {
    const bool described = Index(points_L.size()) == rows;
    switch (options.kind) {
      case LinearSolverKind::kDirect:
      case LinearSolverKind::kReusedFactor:
        return options.kind;
      case LinearSolverKind::kMultigrid:
        LEFORT_CHECK(described);
        return rows <= kMultigridRows ? LinearSolverKind::kDirect : options.kind;
      case LinearSolverKind::kAutomatic:
        break;
    }
    return described && rows > options.direct_rows && !multigrid_failed
               ? LinearSolverKind::kMultigrid
               : LinearSolverKind::kDirect;
  }

  /// Lays out what depends on the pattern alone.
  [[nodiscard]] LinearSolveStatus analyze(const SparseMatrix& A, LinearSolverKind wanted) {
    kind.reset();
    cholesky.reset();  // The memory is needed.
    blocks.reset();
    multigrid.reset();
    has_factor = factor_is_worn = false;
    ++statistics.analyzes;
    statistics.factor_entries = 0.0;
    if (wanted != LinearSolverKind::kMultigrid) {
      std::optional<CholeskyPlan> plan = plan_cholesky(A);
      if (!plan) return LinearSolveStatus::kOutOfMemory;
      statistics.factor_entries = double(plan->factor_numbers);
      cholesky.emplace(*std::move(plan), options.memory_bytes);
    }
    if (wanted != LinearSolverKind::kDirect) blocks.emplace(A);
    pattern.become_that_of(A);
    kind = wanted;
    return LinearSolveStatus::kDone;
  }

  [[nodiscard]] LinearSolveStatus factorize_values(std::span<const double> of_A) {
    ++statistics.factorizations;
    const LinearSolveStatus outcome = cholesky->factorize(of_A);
    has_factor = factor_is_new = outcome == LinearSolveStatus::kDone;
    factor_is_worn = false;
    return outcome;
  }

  [[nodiscard]] LinearSolveStatus prepare(const SparseMatrix& A) {
    if (!all_finite(A)) return LinearSolveStatus::kNotFinite;
    if (!pattern.is_of(A)) multigrid_failed = false;
    const LinearSolverKind wanted = kind_for(A.rows());
    if (kind != wanted || !pattern.is_of(A)) {
      const LinearSolveStatus analyzed = analyze(A, wanted);
      if (analyzed != LinearSolveStatus::kDone) return analyzed;
    }
    const std::span<const double> of_A(A.valuePtr(), std::size_t(A.nonZeros()));
    if (wanted == LinearSolverKind::kDirect) return factorize_values(of_A);
    blocks->set_values(of_A);
    if (wanted == LinearSolverKind::kReusedFactor) {
      values.assign(of_A.begin(), of_A.end());
      factor_is_new = false;
      return has_factor && !factor_is_worn ? LinearSolveStatus::kDone : factorize_values(of_A);
    }
    if (!multigrid || multigrid_is_worn) return build_multigrid();
    multigrid_is_new = false;
    return multigrid->follow() ? LinearSolveStatus::kDone : LinearSolveStatus::kNotPositiveDefinite;
  }

  [[nodiscard]] LinearSolveStatus build_multigrid() {
    ++statistics.factorizations;
    multigrid.reset();  // The memory is needed.
    multigrid = Multigrid::build(blocks->matrix(), rigid_modes(points_L, components, *blocks));
    multigrid_is_new = true;
    multigrid_is_worn = false;
    return multigrid ? LinearSolveStatus::kDone : LinearSolveStatus::kNotPositiveDefinite;
  }

  /// Conjugate gradients with `precondition` on vectors of the blocks' rows.
  template <class Precondition>
  [[nodiscard]] CgOutcome iterate(const VectorX& b, const Precondition& precondition,
                                  double tolerance, int max_iterations) {
    CgOutcome outcome =
        conjugate_gradients([&](const VectorX& x, VectorX& y) { multiply(blocks->matrix(), x, y); },
                            precondition, b, VectorX::Zero(b.size()), tolerance, max_iterations);
    statistics.iterations += outcome.iterations;
    return outcome;
  }

  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve_directly(const VectorX& b) const {
    std::optional<VectorX> x = cholesky->solve(b);
    if (!x) return tl::unexpected(LinearSolveStatus::kOutOfMemory);
    return *std::move(x);
  }

  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve_by_multigrid(const VectorX& b,
                                                                            double tolerance) {
    constexpr double kWorthAHierarchy = 8.0;  // Iterations that take as long as to build one.
    const CgOutcome outcome = iterate(
        blocks->to_blocks(b), [&](const VectorX& r, VectorX& z) { z = multigrid->cycle(r); },
        tolerance, options.max_iterations);
    if (outcome.stop == CgStop::kConverged) {
      const double digits = std::max(-std::log10(tolerance), 1.0);
      if (multigrid_is_new) iterations_per_digit = outcome.iterations / digits;
      multigrid_is_worn = outcome.iterations > iterations_per_digit * digits + kWorthAHierarchy;
      return blocks->from_blocks(outcome.x);
    }
    if (!multigrid_is_new && outcome.stop != CgStop::kNotPositiveDefinite) {
      const LinearSolveStatus renewed = build_multigrid();
      return renewed == LinearSolveStatus::kDone ? solve_by_multigrid(b, tolerance)
                                                 : tl::unexpected(renewed);
    }
    multigrid_failed = outcome.stop == CgStop::kTooManyIterations;
    return tl::unexpected(meaning_of(outcome.stop));
  }

  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve_by_lagged(const VectorX& b,
                                                                         double tolerance) {
    if (factor_is_new) return solve_directly(b);
    bool out_of_memory = false;
    const int worth = iterations_worth_a_factor();
    const CgOutcome outcome = iterate(
        blocks->to_blocks(b),
        [&](const VectorX& r, VectorX& z) {
          const std::optional<VectorX> x = cholesky->solve(blocks->from_blocks(r));
          out_of_memory = !x;
          z = x ? blocks->to_blocks(*x) : VectorX::Zero(r.size());
        },
        tolerance, worth);
    if (out_of_memory) return tl::unexpected(LinearSolveStatus::kOutOfMemory);
    if (outcome.stop == CgStop::kNotPositiveDefinite)
      return tl::unexpected(LinearSolveStatus::kNotPositiveDefinite);
    factor_is_worn = 2 * outcome.iterations > worth;
    if (outcome.stop == CgStop::kConverged) return blocks->from_blocks(outcome.x);
    const LinearSolveStatus renewed = factorize_values(values);
    if (renewed != LinearSolveStatus::kDone) return tl::unexpected(renewed);
    return solve_directly(b);
  }

  /// How many solutions take about as long as a factorization: by the work in them, so that it is
  /// the same on every machine.
  [[nodiscard]] int iterations_worth_a_factor() const {
    constexpr double kMultiplicationsPerEntryRead = 30.0;  // In the same time; measured.
    constexpr double kMinimum = 8.0, kMaximum = 100.0;
    const CholeskyPlan& plan = cholesky->plan();
    const double ratio =
        plan.work() / (kMultiplicationsPerEntryRead * std::max(1.0, double(plan.factor_numbers)));
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
        return parts.solve_by_lagged(b, tolerance);
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
