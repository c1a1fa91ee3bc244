#include <lefort/bench/convergence.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/contact/contact_surface.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/version.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/write_atomically.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace lefort::bench {
namespace {

/// A case predicted by one method.
struct MethodRun {
  std::string case_name;
  std::string mesh_name;  ///< Of the case, for any number of steps.
  ContactMethod method{};
  predict::FacePrediction prediction;
  int steps_requested = 0;
  std::vector<std::int32_t> skin;  ///< Nodes; none in a synthetic case.
  double seconds = 0.0;
  /// Of all points once, at the final positions; NaN before.
  double detection_seconds = std::numeric_limits<double>::quiet_NaN();
  std::size_t detection_points = 0;

  [[nodiscard]] bool is_whole() const {
    return std::ssize(prediction.steps) == std::ptrdiff_t(steps_requested);
  }
  [[nodiscard]] std::vector<fem::LoadAttempt> attempts() const {
    std::vector<fem::LoadAttempt> all;
    for (const predict::PredictionStep& step : prediction.steps)
      all.insert(all.end(), step.attempts.begin(), step.attempts.end());
    all.insert(all.end(), prediction.failed_attempts.begin(), prediction.failed_attempts.end());
    return all;
  }
};

double relative(const fem::NewtonIterate& iterate) {
  return iterate.residual_reference_n > 0.0 ? iterate.residual_n / iterate.residual_reference_n
                                            : 0.0;
}

/// Quadrature points of the contact faces.
std::vector<Vec3> detection_points(const predict::FaceModel& model, std::span<const Vec3> x_L) {
  std::vector<Vec3> points;
  for (const mesh::Face& face : model.tissue.face_sets.at(predict::sets::kContact))
    for (const auto& point : fem::triangle_12()) {
      const double xi = point.xi[0], eta = point.xi[1];
      points.emplace_back((1.0 - xi - eta) * x_L[std::size_t(face.nodes[0])] +
                          xi * x_L[std::size_t(face.nodes[1])] +
                          eta * x_L[std::size_t(face.nodes[2])]);
    }
  return points;
}

/// Called after each converged step; an error ends the run.
using OnStep = std::function<Result<void>(const MethodRun& so_far)>;

Result<MethodRun> follow(const ConvergenceCase& task, const ContactMethod& method,
                         const ConvergenceOptions& options, const OnStep& on_converged_step,
                         Progress& progress) {
  predict::PredictionOptions prediction = task.options;
  prediction.contact.detection = method.detection;
  prediction.contact.integration = contact::Integration::kQuadrature;
  prediction.contact.penetration_tolerance_mm = method.penetration_tolerance_mm;
  prediction.solver.relative_tolerance = options.relative_tolerance;
  prediction.solver.max_iterations = options.max_iterations;

  MethodRun run;
  run.case_name = task.name;
  run.mesh_name = task.mesh_name;
  run.method = method;
  run.steps_requested = geometry::steps_of(task.paths);
  const auto skin = task.model.tissue.node_sets.find(predict::sets::kSkin);
  if (skin != task.model.tissue.node_sets.end()) run.skin = skin->second;
  const Stopwatch watch;
  Result<void> written;
  const auto on_step = [&](const predict::PredictionStep& step) {
    progress.note(fmt::format("  {}, {}: {:5.1f} %, {} iterations in {} increments, {:.1f} s",
                              task.name, method.name, 100.0 * step.path_fraction,
                              step.newton_iterations(), step.attempts.size(), watch.seconds()));
    run.prediction.steps.push_back(step);
    run.seconds = watch.seconds();
    if (written) written = on_converged_step(run);
  };
  LEFORT_TRY(run.prediction,
             predict::predict_face(task.model, task.paths, prediction,
                                   {.on_step = on_step, .on_restart = {}}, progress));
  run.seconds = watch.seconds();
  LEFORT_TRY_VOID(written);

  std::vector<Vec3> x_L = task.model.tissue.nodes_L;
  std::vector<contact::RigidObstacle> bones;
  for (const predict::ContactBone& segment : task.model.segments) {
    LEFORT_TRY(auto distance_query_B, predict::bone_distance_query(segment, method.detection));
    bones.push_back({std::move(distance_query_B)});
  }
  if (!run.prediction.steps.empty()) {
    const predict::PredictionStep& last = run.prediction.steps.back();
    for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += last.displacement_mm[n];
    for (std::size_t k = 0; k < bones.size(); ++k) bones[k].X_LB = last.segments[k].X_LB;
  }
  const std::vector<Vec3> points = detection_points(task.model, x_L);
  std::vector<contact::Gap> gaps(points.size());
  std::vector<double> seconds;
  for (int n = 0; n < 5; ++n) {
    const Stopwatch once;
    for (const contact::RigidObstacle& bone : bones)
      contact::measure_gaps(bone, points, contact::Derivatives::kSecond, gaps);
    seconds.push_back(once.seconds());
  }
  run.detection_seconds = *std::min_element(seconds.begin(), seconds.end());
  run.detection_points = points.size() * bones.size();
  return run;
}

/// Statistics of one run.
struct Tally {
  Index iterations = 0;
  Index failed_attempts = 0;
  Index failed_iterations = 0;
  Index rises = 0;          ///< Iterations that increased the residual.
  double max_final = 0.0;   ///< Relative residual at the end of a step that converged.
  double max_p99_mm = 0.0;  ///< Largest P99 of the penetration increase.
};

Tally tally(const MethodRun& run) {
  Tally sum;
  for (const fem::LoadAttempt& attempt : run.attempts()) {
    const auto iterations = std::max<Index>(Index(attempt.history.size()) - 1, 0);
    sum.iterations += iterations;
    if (attempt.stop != fem::NewtonStop::kConverged) {
      ++sum.failed_attempts;
      sum.failed_iterations += iterations;
    }
    for (std::size_t i = 1; i < attempt.history.size(); ++i)
      if (relative(attempt.history[i]) > relative(attempt.history[i - 1])) ++sum.rises;
  }
  for (const predict::PredictionStep& step : run.prediction.steps) {
    sum.max_final = std::max(sum.max_final, step.relative_residual);
    sum.max_p99_mm = std::max(sum.max_p99_mm, step.contact().p99_penetration_increase_mm);
  }
  return sum;
}

std::string table(std::span<const MethodRun> runs) {
  std::string text =
      "| case | method | steps converged | failed increments | iterations (in failed ones) | per "
      "converged step | residual increased | largest final relative residual | nodes in contact | "
      "largest P99 of depth | depth P99 / max mm at the end | µs per point "
      "detected | s per detection | "
      "walk s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const MethodRun& run : runs) {
    const Tally sum = tally(run);
    const auto& steps = run.prediction.steps;
    const contact::ContactStatistics last =
        steps.empty() ? contact::ContactStatistics{} : steps.back().contact();
    Index in_steps = 0;
    for (const predict::PredictionStep& step : steps) in_steps += step.newton_iterations();
    text += fmt::format(
        "| {} | {} | {} of {} | {} | {} ({}) | {:.1f} | {} | {:.1e} | {} | {:.3f} | {:.3f} / "
        "{:.3f} | {:.3f} | {:.4f} | {:.1f} |\n",
        run.case_name, run.method.name, steps.size(), run.steps_requested, sum.failed_attempts,
        sum.iterations, sum.failed_iterations,
        steps.empty() ? std::nan("") : double(in_steps) / double(steps.size()), sum.rises,
        sum.max_final, last.nodes, sum.max_p99_mm, last.p99_penetration_increase_mm,
        last.max_penetration_increase_mm,
        1e6 * run.detection_seconds / double(std::max<std::size_t>(run.detection_points, 1)),
        run.detection_seconds, run.seconds);
  }
  return text;
}

/// Difference between the final faces of two runs on one mesh [mm].
struct FaceDifference {
  double p99_mm = 0.0;         ///< Of all nodes of the skin.
  double p99_moving_mm = 0.0;  ///< Of those that move in either run, see kMoves_mm.
  double max_mm = 0.0;
};

/// Skin with a smaller displacement counts as stationary.
constexpr double kMoves_mm = 0.5;

/// \param values  at least one.
double p99(std::vector<double> values) {
  const std::size_t at = (values.size() - 1) * 99 / 100;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
  return values[at];
}

FaceDifference difference(const MethodRun& a, const MethodRun& b) {
  const auto& u_a = a.prediction.steps.back().displacement_mm;
  const auto& u_b = b.prediction.steps.back().displacement_mm;
  std::vector<double> all_mm{0.0}, moving_mm{0.0};
  for (const std::int32_t node : a.skin) {
    const Vec3 &there = u_a[std::size_t(node)], &here = u_b[std::size_t(node)];
    all_mm.push_back((there - here).norm());
    if (std::max(there.norm(), here.norm()) > kMoves_mm) moving_mm.push_back(all_mm.back());
  }
  return {p99(all_mm), p99(moving_mm), *std::max_element(all_mm.begin(), all_mm.end())};
}

/// Compares complete runs of the same method with the one with the most steps; empty if there is
/// only one run of each method.
std::string face_table(std::span<const MethodRun> runs) {
  std::string text;
  for (const MethodRun& run : runs) {
    const auto is_like = [&](const MethodRun& other) {
      return other.mesh_name == run.mesh_name && other.method.name == run.method.name &&
             !other.skin.empty() && other.is_whole();
    };
    const MethodRun* finest = nullptr;
    for (const MethodRun& other : runs)
      if (is_like(other) && (!finest || other.steps_requested > finest->steps_requested))
        finest = &other;
    if (!finest || finest == &run || !is_like(run)) continue;
    const auto [p99_mm, p99_moving_mm, max_mm] = difference(run, *finest);
    text += fmt::format("| {} | {} | {} | {} | {:.3f} | {:.3f} | {:.3f} |\n", run.mesh_name,
                        run.method.name, run.steps_requested, finest->steps_requested, p99_mm,
                        p99_moving_mm, max_mm);
  }
  if (text.empty()) return text;
  return fmt::format(
             "\nDifferences between faces at the final positions of the skin's nodes:\n\n"
             "| case | method | steps | compared with | P99 mm | P99 mm where it moves over {:g} "
             "mm | max "
             "mm |\n|---|---|---|---|---|---|---|\n",
             kMoves_mm) +
         text;
}

std::string csv(std::span<const MethodRun> runs) {
  std::string text =
      "case,method,attempt,from,to,extrapolated,converged,iteration,residual_n,relative_residual,"
      "contact_points,step_length,tangent_blend,diagonal_shift\n";
  for (const MethodRun& run : runs) {
    int number = 0;
    for (const fem::LoadAttempt& attempt : run.attempts()) {
      ++number;
      for (std::size_t i = 0; i < attempt.history.size(); ++i) {
        const fem::NewtonIterate& at = attempt.history[i];
        text +=
            fmt::format("{},{},{},{:.9g},{:.9g},{},{},{},{:.9g},{:.9g},{},{:.9g},{:.9g},{:.9g}\n",
                        run.case_name, run.method.name, number, attempt.t_from, attempt.t_to,
                        int(attempt.extrapolated), int(attempt.stop == fem::NewtonStop::kConverged),
                        i, at.residual_n, relative(at), at.contacts, at.step_length,
                        at.tangent_blend, at.diagonal_shift);
      }
    }
  }
  return text;
}

/// \param attempts  number of attempts of each run to plot, one after another.
std::string plot(std::span<const MethodRun> runs, const std::string& title, std::size_t attempts,
                 double tolerance) {
  report::LinePlot drawing{.title = title,
                           .x_label = "Newton iteration",
                           .y_label = "residual over residual reference",
                           .y_axis = report::Axis::kLog,
                           .threshold_y = tolerance,
                           .threshold_name = "converged"};
  for (const MethodRun& run : runs) {
    report::PlotLine line{.name = std::string(run.method.name)};
    double iteration = 0.0;
    const auto all = run.attempts();
    for (std::size_t a = 0; a < std::min(attempts, all.size()); ++a) {
      for (const fem::NewtonIterate& at : all[a].history) {
        line.x.push_back(iteration);
        line.y.push_back(relative(at));
        iteration += 1.0;
      }
      iteration -= 1.0;  // The next increment starts where this one ended.
      line.x.push_back(iteration);
      line.y.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    drawing.lines.push_back(std::move(line));
  }
  return report::plot_file(drawing);
}

/// \param of_case  those of the last case.
Result<void> write_results(std::span<const MethodRun> all, std::span<const MethodRun> of_case,
                           const ConvergenceOptions& options) {
  const std::string& name = of_case.front().case_name;
  LEFORT_TRY_VOID(
      io::write_text(options.output / (name + "-walk.svg"),
                     plot(of_case, name + ": whole path", std::numeric_limits<std::size_t>::max(),
                          options.relative_tolerance)));
  LEFORT_TRY_VOID(io::write_text(
      options.output / (name + "-first-step.svg"),
      plot(of_case, name + ": first increment, from rest", 1, options.relative_tolerance)));
  LEFORT_TRY_VOID(io::write_text(options.output / "convergence.csv", csv(all)));
  return io::write_text(
      options.output / "convergence.md",
      fmt::format("# Convergence of contact\n\nlefort {}, `lefort bench convergence`; relative "
                  "tolerance {:g}, at most {} iterations an increment.\n\n{}",
                  kVersion, options.relative_tolerance, options.max_iterations,
                  table(all) + face_table(all)));
}

}  // namespace

std::vector<ContactMethod> contact_methods() {
  using enum contact::DetectionMethod;
  return {{"bvh", kBvh},
          {"field-trilinear", kTrilinear},
          {"field-smooth", kSmooth},
          {"field-smooth-hardening", kSmooth, predict::ContactOptions{}.penetration_tolerance_mm}};
}

Result<std::string> run_convergence(std::span<const ConvergenceCase> cases,
                                    const ConvergenceOptions& options, Progress& progress) {
  std::vector<MethodRun> all;
  for (const ConvergenceCase& task : cases) {
    const std::size_t first = all.size();
    for (const ContactMethod& method : options.methods) {
      progress.begin_stage(fmt::format("{}: {}", task.name, method.name));
      all.emplace_back();
      // After every step: the next may take long, and a stopped run keeps its results.
      const auto write = [&](const MethodRun& so_far) {
        all.back() = so_far;
        return write_results(all, std::span<const MethodRun>(all).subspan(first), options);
      };
      LEFORT_TRY(const MethodRun run, follow(task, method, options, write, progress));
      LEFORT_TRY_VOID(write(run));
    }
  }
  return table(all) + face_table(all);
}

}  // namespace lefort::bench
