#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/linear_solver.h>

#include <suitesparse/cholmod.h>

#include <algorithm>
#include <cmath>
#include <vector>

// There if the BLAS is OpenBLAS, or CHOLMOD was built with OpenMP; null otherwise.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));
extern "C" void omp_set_max_active_levels(int levels) __attribute__((weak));

namespace lefort::fem {
namespace {

/// Below this reciprocal condition (squared ratio of extreme pivots) a factor is noise.
constexpr double kSingular = 1e-15;

/// Keeps the libraries below to the calling thread. Debian's CHOLMOD asks OpenMP for four threads,
/// however many cores there are, and OpenBLAS for one per core; they wait for each other by
/// spinning, thousands of times a factorisation. On a shared machine a step then takes minutes
/// instead of seconds. One thread also keeps the bits independent of the number of cores.
void use_one_thread() {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
  if (omp_set_max_active_levels != nullptr) omp_set_max_active_levels(0);
}

/// Eigen's arrays seen as CHOLMOD's; CHOLMOD only reads them.
cholmod_sparse view(const SparseMatrix& A) {
  cholmod_sparse view{};
  view.nrow = std::size_t(A.rows());
  view.ncol = std::size_t(A.cols());
  view.nzmax = std::size_t(A.nonZeros());
  view.p = const_cast<int*>(A.outerIndexPtr());
  view.i = const_cast<int*>(A.innerIndexPtr());
  view.x = const_cast<double*>(A.valuePtr());
  view.stype = -1;  // The lower triangle stands for both.
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

bool all_finite(const SparseMatrix& A) {
  const double* values = A.valuePtr();
  // A sum of magnitudes is finite exactly if every term is (but for overflow, as bad).
  return std::isfinite(
      deterministic_sum(A.nonZeros(), 0.0, [&](Index k) { return std::abs(values[k]); }));
}

}  // namespace

struct LinearSolver::Cholmod {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  bool factorised = false;
  std::vector<int> columns;  ///< Pattern of the matrix that was analysed.
  std::vector<int> rows;

  Cholmod() {
    use_one_thread();
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
  }
  ~Cholmod() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  [[nodiscard]] bool knows_pattern_of(const SparseMatrix& A) const {
    return factor != nullptr && Index(columns.size()) == A.cols() + 1 &&
           Index(rows.size()) == A.nonZeros() &&
           std::equal(columns.begin(), columns.end(), A.outerIndexPtr()) &&
           std::equal(rows.begin(), rows.end(), A.innerIndexPtr());
  }

  /// \returns false if memory ran out.
  [[nodiscard]] bool analyse(const SparseMatrix& A) {
    cholmod_free_factor(&factor, &common);
    cholmod_sparse matrix = view(A);
    factor = cholmod_analyze(&matrix, &common);
    if (factor == nullptr) return false;
    columns.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1);
    rows.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
    return true;
  }
};

LinearSolver::LinearSolver() : cholmod_(std::make_unique<Cholmod>()) {}
LinearSolver::~LinearSolver() = default;
LinearSolver::LinearSolver(LinearSolver&&) noexcept = default;
LinearSolver& LinearSolver::operator=(LinearSolver&&) noexcept = default;

Factorisation LinearSolver::factorise(const SparseMatrix& A) {
  use_one_thread();  // OpenMP keeps this for each thread of ours.
  LEFORT_CHECK(A.rows() == A.cols() && A.isCompressed());
  Cholmod& self = *cholmod_;
  self.factorised = false;
  if (!all_finite(A)) return Factorisation::kNotFinite;
  if (!self.knows_pattern_of(A) && !self.analyse(A)) return Factorisation::kOutOfMemory;

  cholmod_sparse matrix = view(A);
  cholmod_factorize(&matrix, self.factor, &self.common);
  if (self.common.status < CHOLMOD_OK) return Factorisation::kOutOfMemory;
  if (self.common.status == CHOLMOD_NOT_POSDEF ||
      (A.cols() > 0 && !(cholmod_rcond(self.factor, &self.common) > kSingular)))
    return Factorisation::kNotPositiveDefinite;
  self.factorised = true;
  return Factorisation::kDone;
}

std::optional<VectorX> LinearSolver::solve(const VectorX& b) const {
  Cholmod& self = *cholmod_;
  LEFORT_CHECK(self.factorised && b.size() == Index(self.factor->n));
  cholmod_dense right{};
  right.nrow = right.d = right.nzmax = std::size_t(b.size());
  right.ncol = 1;
  right.x = const_cast<double*>(b.data());  // Only read.
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;

  // No iterative refinement: within Newton the next step corrects this one.
  cholmod_dense* solution = cholmod_solve(CHOLMOD_A, self.factor, &right, &self.common);
  if (solution == nullptr) return std::nullopt;
  VectorX x = Eigen::Map<const VectorX>(static_cast<const double*>(solution->x), b.size());
  cholmod_free_dense(&solution, &self.common);
  return x;
}

double LinearSolver::factor_entries() const {
  return cholmod_->factor == nullptr ? 0.0 : double(cholmod_->factor->xsize);
}

}  // namespace lefort::fem
