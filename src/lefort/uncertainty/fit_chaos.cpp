#include <lefort/core/check.h>
#include <lefort/uncertainty/fit_chaos.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::uncertainty {
namespace {

/// Terms are at most this fraction of the points: drawn points of the bootstrap, of which 63 % are
/// distinct, then determine the coefficients.
constexpr double kTermsPerPoint = 1.0 / 3.0;
/// A column whose part orthogonal to the selected ones is smaller than this adds nothing.
constexpr double kDependent = 1e-8;

/// Selects columns of a matrix by orthogonal least squares.
class ForwardSelection {
 public:
  ForwardSelection(const Eigen::MatrixXd& basis, Index columns, const VectorX& values)
      : basis_(basis),
        remaining_(basis.leftCols(columns)),
        norm2_(remaining_.colwise().squaredNorm().transpose()),
        residual_(values),
        leverage_(VectorX::Zero(values.size())),
        is_selected_(std::size_t(columns), false) {}

  /// Adds a column. \returns false if it depends on the selected ones.
  bool add(Index column) {
    is_selected_[std::size_t(column)] = true;
    const double norm = remaining_.col(column).norm();
    if (!(norm > kDependent * std::sqrt(norm2_[column]))) return false;
    const VectorX q = remaining_.col(column) / norm;
    remaining_.noalias() -= q * (q.transpose() * remaining_).eval();
    residual_ -= q * q.dot(residual_);
    leverage_ += q.cwiseAbs2();
    add_to_inverse(column, q, norm);
    selected_.push_back(column);
    return true;
  }

  /// The column that reduces the residual most; -1 if none is left.
  [[nodiscard]] Index best() const {
    Index found = -1;
    double most = 0.0;
    for (Index j = 0; j < remaining_.cols(); ++j) {
      if (is_selected_[std::size_t(j)]) continue;
      const double left = remaining_.col(j).squaredNorm();
      if (!(left > kDependent * kDependent * norm2_[j])) continue;
      const double along = remaining_.col(j).dot(residual_);
      if (along * along / left > most) {
        most = along * along / left;
        found = j;
      }
    }
    return found;
  }

  /// Corrected mean of the squares of the leave-one-out residuals.
  [[nodiscard]] double loo_error() const {
    const auto n = double(residual_.size());
    const auto p = double(selected_.size());
    if (!(n > p)) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (Index i = 0; i < residual_.size(); ++i) {
      const double rest = 1.0 - leverage_[i];
      if (!(rest > 1e-10)) return std::numeric_limits<double>::infinity();
      sum += residual_[i] * residual_[i] / (rest * rest);
    }
    // tr(C^-1) / N = tr((A^T A)^-1), the sum of the squares of the entries of R^-1.
    return sum / (n - p) * (1.0 + trace_);
  }

  [[nodiscard]] const std::vector<Index>& selected() const { return selected_; }

 private:
  /// The new column of R^-1 of A = Q R: that of (-R^-1 Q^T a, 1) / norm.
  void add_to_inverse(Index column, const VectorX& q, double norm) {
    VectorX fresh = VectorX::Zero(Index(selected_.size()) + 1);
    for (std::size_t k = 0; k < selected_.size(); ++k) {
      const double along = q_[k].dot(basis_.col(column));
      for (Index i = 0; i < inverse_[k].size(); ++i) fresh[i] -= inverse_[k][i] * along;
    }
    fresh[Index(selected_.size())] = 1.0;
    fresh /= norm;
    trace_ += fresh.squaredNorm();
    inverse_.push_back(std::move(fresh));
    q_.push_back(q);
  }

  const Eigen::MatrixXd& basis_;
  Eigen::MatrixXd remaining_;  ///< Orthogonal to the selected columns.
  VectorX norm2_;
  VectorX residual_, leverage_;
  std::vector<bool> is_selected_;
  std::vector<Index> selected_;
  std::vector<VectorX> inverse_, q_;  ///< Columns of R^-1 and Q.
  double trace_ = 0.0;
};

struct Selection {
  std::vector<Index> terms;
  double error = std::numeric_limits<double>::infinity();
};

/// The best of the sets of growing size.
Selection select_terms(const Eigen::MatrixXd& basis, Index columns, const VectorX& values) {
  ForwardSelection forward(basis, columns, values);
  forward.add(0);
  Selection best{{0}, forward.loo_error()};
  const Index most =
      std::min(columns, std::max<Index>(2, Index(kTermsPerPoint * double(values.size()))));
  const Index max_since = std::max<Index>(10, most / 5);
  const double round_off = 1e-28 * values.squaredNorm() / double(values.size());
  for (Index since = 0; Index(forward.selected().size()) < most && since < max_since;) {
    const Index column = forward.best();
    if (column < 0 || !forward.add(column)) break;
    const double error = forward.loo_error();
    if (error < best.error) {
      best = {forward.selected(), error};
      since = 0;
    } else {
      ++since;
    }
    if (best.error <= round_off) break;
  }
  return best;
}

/// Least squares over some rows.
VectorX solve_rows(const Eigen::MatrixXd& basis, const std::vector<Index>& terms,
                   const VectorX& values, std::span<const Index> rows) {
  Eigen::MatrixXd a(Index(rows.size()), Index(terms.size()));
  VectorX b(Index(rows.size()));
  for (Index i = 0; i < a.rows(); ++i) {
    b[i] = values[rows[std::size_t(i)]];
    for (Index j = 0; j < a.cols(); ++j)
      a(i, j) = basis(rows[std::size_t(i)], terms[std::size_t(j)]);
  }
  return a.colPivHouseholderQr().solve(b);
}

std::vector<Index> all_rows(Index count) {
  std::vector<Index> rows(std::size_t(count), 0);
  for (Index i = 0; i < count; ++i) rows[std::size_t(i)] = i;
  return rows;
}

}  // namespace

ChaosFit fit_chaos(const Eigen::MatrixXd& basis, std::span<const Index> candidate_ends,
                   const VectorX& values) {
  LEFORT_CHECK(basis.rows() == values.size() && values.size() >= 3);
  ChaosFit fit{.terms = {0}, .coefficients = {}, .candidate = 0, .q2 = 0.0};
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < candidate_ends.size(); ++n) {
    Selection selection = select_terms(basis, candidate_ends[n], values);
    if (!(selection.error < best)) continue;
    best = selection.error;
    fit.terms = std::move(selection.terms);
    fit.candidate = Index(n);
  }
  fit.coefficients = solve_rows(basis, fit.terms, values, all_rows(values.size()));
  const double variance =
      (values.array() - values.mean()).square().sum() / double(values.size() - 1);
  fit.q2 = variance > 0.0 ? 1.0 - best / variance : 1.0;
  return fit;
}

VectorX refit(const Eigen::MatrixXd& basis, const ChaosFit& fit, const VectorX& values,
              std::span<const Index> drawn) {
  return solve_rows(basis, fit.terms, values, drawn);
}

VectorX cross_validate(const Eigen::MatrixXd& basis, std::span<const Index> candidate_ends,
                       Index candidate, const VectorX& values, Index folds) {
  LEFORT_CHECK(folds >= 2 && folds <= values.size());
  VectorX errors(values.size());
  for (Index fold = 0; fold < folds; ++fold) {
    std::vector<Index> kept;
    for (Index i = 0; i < values.size(); ++i)
      if (i % folds != fold) kept.push_back(i);
    Eigen::MatrixXd a(Index(kept.size()), basis.cols());
    VectorX b(Index(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      a.row(Index(k)) = basis.row(kept[k]);
      b[Index(k)] = values[kept[k]];
    }
    const Selection selection = select_terms(a, candidate_ends[std::size_t(candidate)], b);
    const VectorX coefficients = solve_rows(a, selection.terms, b, all_rows(b.size()));
    for (Index i = fold; i < values.size(); i += folds) {
      double predicted = 0.0;
      for (std::size_t k = 0; k < selection.terms.size(); ++k)
        predicted += coefficients[Index(k)] * basis(i, selection.terms[k]);
      errors[i] = predicted - values[i];
    }
  }
  return errors;
}

}  // namespace lefort::uncertainty
