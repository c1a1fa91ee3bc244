/// \file
/// Incremental loading with adaptive increments.
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

/// Equilibrium at one load level.
struct LoadState {
  double t = 0.0;  ///< Load level, as passed to SolveAtLoad.
  VectorX u;       ///< [mm]
};

/// Control of the increments.
struct LoadStepOptions {
  double first_increment = 1.0;  ///< Of t, > 0; shortened to end at t_end.
  /// Of t, > 0, <= first_increment; if an increment of this size fails, advance_to() ends.
  double min_increment = 1.0 / 1024;
  double max_increment = std::numeric_limits<double>::infinity();  ///< Of t, >= first_increment.
  /// Factor from an increment with at most target_iterations to the next; >= 1.
  double growth_factor = 2.0;
  int target_iterations = 6;  ///< Newton iterations up to which the next increment grows; >= 0.
  int max_attempts = 1000;    ///< Number of solves in one advance_to() after which it ends; >= 1.
};

/// \returns kInvalidArgument, naming the option that lies outside its range.
[[nodiscard]] Result<void> validate(const LoadStepOptions& options);

/// One call of SolveAtLoad.
struct LoadAttempt {
  double t_from = 0.0;
  double t_to = 0.0;
  bool extrapolated = false;  ///< The start was extrapolated from the last two states.
  NewtonStop stop = NewtonStop::kConverged;
  std::string reason;  ///< NewtonOutcome::reason.
  std::vector<NewtonIterate> history;
};

/// Finds the equilibrium at load level t from an initial guess of u.
using SolveAtLoad = std::function<NewtonOutcome(double t, const VectorX& start)>;

/// Called with each converged state; an error ends advance_to().
using OnLoadState = std::function<Result<void>(const LoadState&)>;

/// Follows a load path and records all attempts.
class LoadStepper {
 public:
  /// \param start    a converged state, for example the reference configuration.
  /// \param solve    \pre not empty.
  /// \param options  \pre valid.
  LoadStepper(LoadState start, SolveAtLoad solve, const LoadStepOptions& options = {});

  /// State on which the next step depends.
  struct Checkpoint {
    LoadState last;
    std::optional<LoadState> before_last;
    double increment = 0.0;
  };
  [[nodiscard]] Checkpoint checkpoint() const { return {last_, before_last_, increment_}; }

  /// \param checkpoint  of another stepper with the same path and options.
  /// \param solve       \pre not empty.
  /// \param options     \pre valid.
  /// \returns a stepper that continues like the other one; its attempts() are empty.
  [[nodiscard]] static LoadStepper resumed(Checkpoint checkpoint, SolveAtLoad solve,
                                           const LoadStepOptions& options);

  /// Advances to load level `t_end` > state().t.
  ///
  /// An increment that fails is halved. After one with at most target_iterations the next is
  /// growth_factor times as large, up to max_increment. The first increment of each call is at
  /// least first_increment, unless t_end is closer. The initial guess is extrapolated from the last
  /// two converged states. If this guess is inadmissible, or the solve from it stagnates within
  /// target_iterations or ends in a rejected state, the increment is tried again with the last
  /// state as guess.
  ///
  /// \param t_end     load level.
  /// \param progress  checked before each increment for a request to stop.
  /// \param on_state  called with each converged state; may be empty.
  /// \returns nothing if state() is now at t_end; or
  ///   - kNotConverged     an increment of min_increment failed, or max_attempts were not enough;
  ///     the message has the load levels and the reason;
  ///   - kOutOfMemory      the factor of the tangent does not fit into memory;
  ///   - kInvalidArgument  t_end is not finite, or not greater than state().t;
  ///   - kCancelled        a stop was requested;
  ///   - the error that `on_state` returned.
  /// After an error state() is the last converged state; attempts() has all attempts.
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
