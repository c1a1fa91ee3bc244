#include <lefort/core/check.h>
#include <lefort/uncertainty/chaos_basis.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace lefort::uncertainty {
namespace {

constexpr double kHyperbolic = 0.75;

/// (sum a_j^q)^(1/q).
double q_norm(const ChaosTerm& term, double q) {
  double sum = 0.0;
  for (const int degree : term)
    if (degree > 0) sum += std::pow(double(degree), q);
  return std::pow(sum, 1.0 / q);
}

/// All terms with a norm of at most `degree`, by total degree, then in lexicographic order; empty
/// if they are more than `max_terms`.
class TermSearch {
 public:
  TermSearch(std::span<const ChaosInput> inputs, int degree, double q, Index max_terms)
      : inputs_(inputs), degree_(degree), q_(q), max_terms_(max_terms), term_(inputs.size(), 0) {}

  [[nodiscard]] std::vector<ChaosTerm> find() {
    extend(0);
    if (Index(found_.size()) > max_terms_) return {};
    std::stable_sort(found_.begin(), found_.end(), [](const ChaosTerm& a, const ChaosTerm& b) {
      return std::accumulate(a.begin(), a.end(), 0) < std::accumulate(b.begin(), b.end(), 0);
    });
    return found_;
  }

 private:
  void extend(std::size_t input) {
    if (Index(found_.size()) > max_terms_) return;
    if (input == inputs_.size()) {
      found_.push_back(term_);
      return;
    }
    for (int n = 0; n <= std::min(degree_, inputs_[input].max_degree); ++n) {
      term_[input] = n;
      constexpr double kRoundOff = 1e-9;
      if (q_norm(term_, q_) > degree_ + kRoundOff) break;
      extend(input + 1);
    }
    term_[input] = 0;
  }

  std::span<const ChaosInput> inputs_;
  int degree_;
  double q_;
  Index max_terms_;
  ChaosTerm term_;
  std::vector<ChaosTerm> found_;
};

}  // namespace

ChaosBasis make_basis(std::vector<ChaosInput> inputs, const BasisOptions& options) {
  LEFORT_CHECK(!inputs.empty() && options.max_degree >= 1);
  ChaosBasis basis{.inputs = std::move(inputs), .terms = {}, .candidate_ends = {}};
  std::set<ChaosTerm> known;
  const auto add = [&](int degree, double q, Index max_terms) {
    const std::vector<ChaosTerm> found = TermSearch(basis.inputs, degree, q, max_terms).find();
    for (const ChaosTerm& term : found)
      if (known.insert(term).second) basis.terms.push_back(term);
    if (!found.empty() &&
        (basis.candidate_ends.empty() || basis.candidate_ends.back() < Index(basis.terms.size())))
      basis.candidate_ends.push_back(Index(basis.terms.size()));
    return !found.empty();
  };
  add(1, 1.0, Index(basis.inputs.size()) + 1);  // Always: it is the smallest set.
  for (int degree = 2; degree <= options.max_degree; ++degree) {
    if (!add(degree, kHyperbolic, options.max_terms)) break;
    if (!add(degree, 1.0, options.max_terms)) break;
  }
  return basis;
}

Eigen::MatrixXd evaluate(const ChaosBasis& basis, const Eigen::MatrixXd& points) {
  LEFORT_CHECK(points.cols() == Index(basis.inputs.size()));
  Eigen::MatrixXd values = Eigen::MatrixXd::Ones(points.rows(), Index(basis.terms.size()));
  for (std::size_t j = 0; j < basis.inputs.size(); ++j) {
    int degree = 0;
    for (const ChaosTerm& term : basis.terms) degree = std::max(degree, term[j]);
    if (degree == 0) continue;
    const VectorX column = points.col(Index(j));
    const std::vector<std::vector<double>> factors = orthonormal_polynomials(
        basis.inputs[j].distribution, degree, {column.data(), column.data() + column.size()});
    for (std::size_t t = 0; t < basis.terms.size(); ++t)
      if (const int n = basis.terms[t][j]; n > 0)
        for (Index i = 0; i < points.rows(); ++i)
          values(i, Index(t)) *= factors[std::size_t(i)][std::size_t(n)];
  }
  return values;
}

Eigen::MatrixXd points_at(std::span<const Distribution> distributions,
                          const Eigen::MatrixXd& probabilities) {
  LEFORT_CHECK(probabilities.cols() == Index(distributions.size()));
  Eigen::MatrixXd points(probabilities.rows(), probabilities.cols());
  for (Index j = 0; j < points.cols(); ++j) {
    const VectorX column = probabilities.col(j);
    const std::vector<double> values =
        quantiles(distributions[std::size_t(j)], {column.data(), column.data() + column.size()});
    points.col(j) = Eigen::Map<const VectorX>(values.data(), points.rows());
  }
  return points;
}

}  // namespace lefort::uncertainty
