#include <lefort/linear/linear_solver.h>
#include <lefort/solve/find_weakest_mode.h>

#include <cmath>

namespace lefort::solve {
namespace {

constexpr double kFirstShift = 1e-9;  ///< Relative to the mean diagonal entry.
constexpr double kShiftGrowth = 10.0;
constexpr double kLastShift = 1e3;
constexpr int kIterations = 4;

/// Start vector of the inverse iteration: fixed, and orthogonal to no mode in practice.
VectorX irregular(Index size) {
  VectorX x(size);
  for (Index i = 0; i < size; ++i) x[i] = std::sin(1.0 + 12.9898 * double(i));
  return x;
}

}  // namespace

std::optional<WeakestMode> find_weakest_mode(const fem::Assembler& assembler, const VectorX& u,
                                             Progress& progress) {
  const fem::DofMap& dofs = assembler.dofs();
  if (dofs.free_count() == 0 || !assembler.forces(u)) return std::nullopt;
  linear::SparseMatrix K = assembler.tangent(u);
  linear::LinearSolver solver(
      {.kind = linear::LinearSolverKind::kDirect});  // Only this kind detects an indefinite matrix.
  if (progress.stop_requested()) return std::nullopt;
  linear::LinearSolveStatus outcome = solver.factorize(K);
  const double scale = K.diagonal().cwiseAbs().mean();
  double shift = 0.0;
  for (double next = kFirstShift;
       outcome == linear::LinearSolveStatus::kNotPositiveDefinite && next <= kLastShift;
       next *= kShiftGrowth) {
    if (progress.stop_requested()) return std::nullopt;
    K.diagonal().array() += (next - shift) * scale;
    shift = next;
    outcome = solver.factorize(K);
  }
  if (outcome != linear::LinearSolveStatus::kDone) return std::nullopt;

  VectorX motion = irregular(dofs.free_count());
  for (int n = 0; n < kIterations; ++n) {
    const auto next = solver.solve(motion);
    if (!next || !(next->norm() > 0.0)) return std::nullopt;
    motion = *next / next->norm();
  }
  const VectorX all = dofs.with_free_part(VectorX::Zero(u.size()), motion);
  WeakestMode mode{.resists = shift == 0.0};
  double max_squared = -1.0;
  for (Index node = 0; node < dofs.node_count(); ++node) {
    const Vec3 moved = all.segment<3>(3 * node);
    if (!(moved.squaredNorm() > max_squared)) continue;
    max_squared = moved.squaredNorm();
    mode.node = std::int32_t(node);
    mode.direction = moved.normalized();
  }
  return mode;
}

}  // namespace lefort::solve
