#include <lefort/core/check.h>
#include <lefort/inverse/optimize_motion.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::inverse {
namespace {

/// The overlap penalty grows by this factor until the minimum is within the limit, this many times
/// (quadratic penalty method, \cite nocedal2006, section 17.1).
constexpr double kPenaltyGrowth = 10.0;
constexpr int kPenalties = 5;

/// The steps of bisection towards a point without too much overlap.
constexpr int kBisections = 12;

/// A search in progress.
class Search {
 public:
  Search(LiveFace& coarse, LiveFace* fine, const MotionProblem& problem,
         const MotionOptions& options, const OnMotionNote& note, Progress& progress)
      : fine_(fine),
        problem_(problem),
        options_(options),
        note_(note),
        progress_(progress),
        objective_(coarse, problem, coarse.response->at_rest(), progress) {
    if (fine != nullptr)
      fine_objective_.emplace(*fine, problem, fine->response->at_rest(), progress);
  }

  [[nodiscard]] Result<MotionResult> run(const VectorX& start);

 private:
  [[nodiscard]] Result<VectorX> find_feasible(const VectorX& start) const;
  [[nodiscard]] Result<LeastSquaresResult> minimize(const VectorX& from);
  [[nodiscard]] Result<void> check_gradient(const VectorX& start);
  [[nodiscard]] VectorX moved_back(const VectorX& x);
  [[nodiscard]] bool is_feasible(const VectorX& x) const {
    return problem_.clearance.is_within(problem_.clearance.deepest(problem_.variables.poses(x)));
  }
  [[nodiscard]] Result<void> correct(LeastSquaresResult found);
  void keep_bounds_of_result();
  [[nodiscard]] Result<void> may_end(const Error& error, bool has_result) const;
  void note(const std::string& text) const {
    if (note_) note_(text);
  }

  LiveFace* fine_;
  const MotionProblem& problem_;
  const MotionOptions& options_;
  const OnMotionNote& note_;
  Progress& progress_;
  FaceObjective objective_;
  std::optional<FaceObjective> fine_objective_;
  VectorX anchor_;  ///< A point without too much overlap.
  MotionResult result_;
};

Result<VectorX> Search::find_feasible(const VectorX& start) const {
  const MotionVariables& variables = problem_.variables;
  const VectorX none =
      VectorX::Zero(variables.count()).cwiseMax(variables.lower()).cwiseMin(variables.upper());
  for (const VectorX& x : {start, variables.start(), none})
    if (is_feasible(x)) return x;
  const DeepestOverlap overlap = problem_.clearance.deepest(variables.poses(variables.start()));
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} and {} overlap by {}{:.2f} mm in the given plan, and also without "
                          "movement; limits.overlap_mm is {:g} mm",
                          overlap.first, overlap.second, overlap.is_lower_bound ? "more than " : "",
                          overlap.depth_mm, problem_.clearance.allowed_mm()));
}

/// The last point on the way from the anchor to x without too much overlap.
VectorX Search::moved_back(const VectorX& x) {
  result_.is_limited_by_overlap = !is_feasible(x);
  if (!result_.is_limited_by_overlap) return x;
  double good = 0.0, bad = 1.0;
  for (int n = 0; n < kBisections; ++n) {
    const double middle = 0.5 * (good + bad);
    (is_feasible(anchor_ + middle * (x - anchor_)) ? good : bad) = middle;
  }
  return anchor_ + good * (x - anchor_);
}

Result<void> Search::check_gradient(const VectorX& start) {
  if (options_.check_step <= 0.0) return {};
  LEFORT_TRY([[maybe_unused]] const double value, objective_.evaluate(start));
  objective_.accept();
  LEFORT_TRY(const QuadraticModel model, objective_.linearize());
  LEFORT_TRY(result_.gradient_error,
             objective_.gradient_error(model.gradient, options_.check_step));
  note(
      fmt::format("gradient: largest difference from central differences {:.1e} of its largest "
                  "component",
                  *result_.gradient_error));
  return {};
}

Result<LeastSquaresResult> Search::minimize(const VectorX& from) {
  const MotionVariables& variables = problem_.variables;
  result_.starts.push_back(result_.history.size());
  const auto minimize_from = [&](const VectorX& x) -> Result<LeastSquaresResult> {
    LEFORT_TRY(LeastSquaresResult found,
               minimize_least_squares(objective_, x, variables.lower(), variables.upper(),
                                      options_.coarse, progress_));
    result_.history.insert(result_.history.end(), found.history.begin(), found.history.end());
    note(fmt::format("coarse model: objective {:.4g} mm^2 after {} trial points", found.objective,
                     found.history.size()));
    return found;
  };
  LEFORT_TRY(LeastSquaresResult found, minimize_from(from));
  for (int n = 0; n < kPenalties && !is_feasible(found.x); ++n) {
    objective_.scale_overlap_weight(kPenaltyGrowth);
    LEFORT_TRY(found, minimize_from(found.x));
  }
  if (is_feasible(found.x)) anchor_ = found.x;
  return found;
}

/// Ends the corrections without a result of the last one.
/// \returns the error, unless a face was found before and a solve did not converge.
Result<void> Search::may_end(const Error& error, bool has_result) const {
  if (!has_result || error.code != ErrorCode::kNotConverged) return tl::unexpected(error);
  note("a solve did not converge; the best result so far is kept: " + error.message);
  return {};
}

/// A bound at which the last minimum of the coarse model lies is one of the result only if the
/// result lies there, too.
void Search::keep_bounds_of_result() {
  const VectorX lower = problem_.variables.lower(), upper = problem_.variables.upper();
  for (std::size_t i = 0; i < result_.at_lower.size(); ++i) {
    result_.at_lower[i] = result_.at_lower[i] && result_.face.x[Index(i)] <= lower[Index(i)];
    result_.at_upper[i] = result_.at_upper[i] && result_.face.x[Index(i)] >= upper[Index(i)];
  }
}

Result<void> Search::correct(LeastSquaresResult found) {
  VectorX x = moved_back(found.x);
  std::optional<FaceAt> best;
  for (int n = 0; n < options_.max_corrections; ++n) {
    // The coarse face at x, from which the fine one differs.
    const Result<double> coarse = objective_.evaluate(x);
    if (!coarse) LEFORT_TRY_VOID(may_end(coarse.error(), best.has_value()));
    if (!coarse) break;
    const FaceAt coarse_face = objective_.trial();
    const Result<double> fine = fine_objective_->evaluate(x);
    if (!fine) LEFORT_TRY_VOID(may_end(fine.error(), best.has_value()));
    if (!fine) break;
    fine_objective_->accept();
    const FaceAt& fine_face = fine_objective_->present();
    const double step = result_.corrections.empty()
                            ? 0.0
                            : (x - result_.corrections.back().x).lpNorm<Eigen::Infinity>();
    result_.corrections.push_back({x, *coarse, *fine, step});
    note(fmt::format("fine model {}: objective {:.4g} mm^2, movement changed by {:.3f}", n + 1,
                     *fine, step));
    if (!best || *fine < best->objective) best = fine_face;
    std::vector<Vec3> correction_mm = objective_.correction_mm();
    for (std::size_t v = 0; v < correction_mm.size(); ++v)
      correction_mm[v] += fine_face.skin_mm[v] - coarse_face.skin_mm[v];
    objective_.set_correction(std::move(correction_mm));
    LEFORT_TRY(found, minimize(x));
    const VectorX next = moved_back(found.x);
    if ((next - x).lpNorm<Eigen::Infinity>() <= options_.correction_tolerance) {
      result_.converged = found.stop == LeastSquaresStop::kConverged;
      break;
    }
    x = next;
  }
  result_.at_lower = std::move(found.at_lower);
  result_.at_upper = std::move(found.at_upper);
  result_.face = *std::move(best);
  return {};
}

Result<MotionResult> Search::run(const VectorX& start) {
  LEFORT_TRY(anchor_, find_feasible(start));
  LEFORT_TRY_VOID(check_gradient(start));
  LEFORT_TRY(LeastSquaresResult found, minimize(start));
  if (fine_ != nullptr) {
    LEFORT_TRY_VOID(correct(std::move(found)));
  } else {
    const VectorX x = moved_back(found.x);
    LEFORT_TRY([[maybe_unused]] const double value, objective_.evaluate(x));
    result_.face = objective_.trial();
    result_.converged = found.stop == LeastSquaresStop::kConverged;
    result_.at_lower = std::move(found.at_lower);
    result_.at_upper = std::move(found.at_upper);
  }
  result_.target_gradients = objective_.target_gradients();
  result_.directions = determined_motions(objective_.target_hessian());
  keep_bounds_of_result();
  const std::vector<RigidTransform> X_LB = problem_.variables.poses(result_.face.x);
  result_.overlap = problem_.clearance.deepest(X_LB);
  result_.is_limited_by_overlap =
      result_.is_limited_by_overlap || !problem_.clearance.rows(X_LB, {}).empty();
  LEFORT_CHECK(problem_.clearance.is_within(result_.overlap));
  return std::move(result_);
}

}  // namespace

Result<MotionResult> optimize_motion(LiveFace& coarse, LiveFace* fine, const MotionProblem& problem,
                                     const VectorX& start, const MotionOptions& options,
                                     const OnMotionNote& note, Progress& progress) {
  LEFORT_CHECK(options.max_corrections >= 1);
  return Search(coarse, fine, problem, options, note, progress).run(start);
}

}  // namespace lefort::inverse
