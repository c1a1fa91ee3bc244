/// \file
/// Follows a load from one level to the next in increments as large as converge.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/solve/newton.h>

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace lefort::fem {

/// A converged state.
struct LoadState {
  double t = 0.0;  ///< Load level: whatever the caller's solve understands by it.
  VectorX u;       ///< [mm]
};

struct LoadStepOptions {
  double first_increment = 1.0;       ///< Of t, > 0; cut to the distance to the next level.
  double min_increment = 1.0 / 1024;  ///< Of t, > 0, <= first; failing at this size ends the run.
  double max_increment = std::numeric_limits<double>::infinity();  ///< Of t, >= first.
  double growth_factor = 2.0;  ///< An easy increment is multiplied by this, >= 1.
  int target_iterations = 6;   ///< Newton needed at most so many: the increment was easy.
  int max_attempts = 1000;     ///< Calls of solve for one advance_to(), at most; >= 1.
};

/// \returns kInvalidArgument, naming the option that lies outside its range.
[[nodiscard]] Result<void> validate(const LoadStepOptions& options);

/// How one call of solve went.
struct LoadAttempt {
  double t_from = 0.0;
  double t_to = 0.0;
  bool extrapolated = false;  ///< The start was extrapolated from the last two states.
  NewtonStop stop = NewtonStop::kConverged;
  std::string reason;  ///< Newton's sentence.
  std::vector<NewtonIterate> history;
};

/// Equilibrium at load level t from a start guess for u.
using SolveAtLoad = std::function<NewtonOutcome(double t, const VectorX& start)>;

/// Told each converged state; an error ends the walk there.
using OnLoadState = std::function<Result<void>(const LoadState&)>;

/// Walks along a load path and remembers how.
class LoadStepper {
 public:
  /// \param start    a converged state, for example the body at rest.
  /// \param options  \pre valid.
  LoadStepper(LoadState start, SolveAtLoad solve, const LoadStepOptions& options = {});

  /// All that the next step depends on.
  struct Checkpoint {
    LoadState last;
    std::optional<LoadState> before_last;
    double increment = 0.0;
  };
  [[nodiscard]] Checkpoint checkpoint() const { return {last_, before_last_, increment_}; }

  /// Goes on as the stepper would have whose memory it was; attempts() begin anew.
  [[nodiscard]] static LoadStepper resumed(Checkpoint checkpoint, SolveAtLoad solve,
                                           const LoadStepOptions& options);

  /// Advances to load level `t_end` > state().t.
  ///
  /// An increment that fails is halved, one that was easy lets the next grow; each call begins
  /// with first_increment at least. The start guess is extrapolated from the last two converged
  /// states; where that is inadmissible, soon gets stuck or leads to what is refused, the last
  /// state serves.
  ///
  /// \returns nothing if state() is now at t_end; or
  ///   - kNotConverged     the smallest increment failed, or max_attempts were not enough; the
  ///     sentence says where and why;
  ///   - kOutOfMemory      Newton's factor does not fit into memory, however small the increment;
  ///   - kInvalidArgument  t_end is not finite or does not lie ahead;
  ///   - kCancelled        `progress` asked to stop;
  ///   - what `on_state` returned, which may be empty.
  /// After an error state() is the last converged state, and attempts() tells all that was tried.
  [[nodiscard]] Result<void> advance_to(double t_end, Progress& progress = Progress::none(),
                                        const OnLoadState& on_state = {});

  [[nodiscard]] const LoadState& state() const { return last_; }
  [[nodiscard]] const std::vector<LoadAttempt>& attempts() const { return attempts_; }

 private:
  [[nodiscard]] NewtonOutcome attempt(double t, bool extrapolate);
  [[nodiscard]] VectorX extrapolated(double t) const;

  LoadState last_;
  std::optional<LoadState> before_last_;
  SolveAtLoad solve_;
  LoadStepOptions options_;
  double increment_;
  std::vector<LoadAttempt> attempts_;
};

}  // namespace lefort::fem
