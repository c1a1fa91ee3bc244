#include <lefort/bench/run_process.h>
#include <lefort/bench/solve_task.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace lefort::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<mesh::ElementShape, const char*>, 2> kShapes{
    {{mesh::ElementShape::kTet10, "tet10"}, {mesh::ElementShape::kHex8, "hex8"}}};
constexpr std::array<std::pair<linear::LinearSolverKind, const char*>, 4> kSolvers{
    {{linear::LinearSolverKind::kAutomatic, "automatic"},
     {linear::LinearSolverKind::kDirect, "direct"},
     {linear::LinearSolverKind::kReusedFactor, "lagged"},
     {linear::LinearSolverKind::kMultigrid, "multigrid"}}};

template <class Names, class Value>
const char* name_in(const Names& names, Value value) {
  for (const auto& [known, name] : names)
    if (known == value) return name;
  return "";
}

template <class Value, class Names>
Result<Value> value_in(const Names& names, const std::string& wanted) {
  for (const auto& [value, name] : names)
    if (wanted == name) return value;
  return fail(ErrorCode::kInvalidArgument, fmt::format("the task does not support '{}'", wanted));
}

Result<SolveTask> parse(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::kInvalidArgument, "the task is not a JSON object");
  SolveTask task;
  try {
    LEFORT_TRY(task.block.shape,
               value_in<mesh::ElementShape>(kShapes, json.at("shape").get<std::string>()));
    LEFORT_TRY(task.solver,
               value_in<linear::LinearSolverKind>(kSolvers, json.at("solver").get<std::string>()));
    task.block.cells = json.at("cells").get<int>();
    task.threads = json.at("threads").get<int>();
    task.increments = json.at("increments").get<int>();
    task.load = json.at("load").get<double>();
    if (!(task.load > 0.0 && task.load <= 1.0))
      return fail(ErrorCode::kInvalidArgument, "the task's load must be > 0 and <= 1");
    task.relative_tolerance = json.at("relative_tolerance").get<double>();
    task.displacements = json.at("displacements").get<std::string>();
  } catch (const Json::exception& wrong) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("invalid task: {}", wrong.what()));
  }
  return task;
}

/// Mesh, force terms and assembler.
struct Body {
  mesh::VolumeMesh mesh;
  std::vector<std::unique_ptr<const fem::ForceTerm>> terms;
  std::optional<fem::Assembler> assembler;
};

Result<Body> make_body(const BlockProblem& block) {
  Body body;
  body.mesh = block.mesh();
  // Full integration, as in CalculiX's C3D10 and C3D8: the same discrete problem.
  LEFORT_TRY(body.terms, fem::make_element_terms(body.mesh, BlockProblem::materials(),
                                                 fem::VolumetricIntegration::kFullIntegration));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : body.terms) terms.push_back(term.get());
  LEFORT_TRY(fem::DofMap dofs,
             fem::DofMap::build(body.mesh.node_count(), BlockProblem::prescribed(body.mesh, 0.0)));
  body.assembler.emplace(body.mesh.nodes_L, std::move(dofs), std::move(terms));
  return body;
}

Error error_of(linear::LinearSolveStatus outcome) {
  switch (outcome) {
    case linear::LinearSolveStatus::kOutOfMemory:
      return {ErrorCode::kOutOfMemory, "the factor does not fit into memory"};
    case linear::LinearSolveStatus::kNotConverged:
      return {ErrorCode::kNotConverged, "the linear iterations did not converge"};
    default:
      return {ErrorCode::kNotConverged, "the stiffness is not positive definite"};
  }
}

/// Solves one linear system and measures its parts.
Result<Json> solve_system(const SolveTask& task, const Body& body) {
  constexpr double kTolerance = 1e-8;
  const fem::Assembler& assembler = *body.assembler;
  const fem::DofMap& dofs = assembler.dofs();
  const VectorX at_rest = VectorX::Zero(3 * dofs.node_count());
  Stopwatch watch;
  const linear::SparseMatrix K = assembler.tangent(at_rest);
  const double assembly = watch.lap();
  const VectorX moved = dofs.with_prescribed(at_rest, BlockProblem::prescribed(body.mesh, 0.01));
  const VectorX b = -dofs.free_part(assembler.tangent_times(at_rest, moved));

  linear::LinearSolver solver({.kind = task.solver});
  fem::set_near_null_space(solver, assembler);
  watch.lap();
  const linear::LinearSolveStatus prepared = solver.factorize(K);
  if (prepared != linear::LinearSolveStatus::kDone) return tl::unexpected(error_of(prepared));
  const double preparation = watch.lap();
  const auto x = solver.solve(b, kTolerance);
  if (!x) return tl::unexpected(error_of(x.error()));
  const double solution = watch.lap();
  const VectorX residual = K.selfadjointView<Eigen::Lower>() * *x - b;
  return Json{{"solver", name_of(solver.kind())},
              {"assembly_seconds", assembly},
              {"preparation_seconds", preparation},
              {"solution_seconds", solution},
              {"linear_iterations", solver.statistics().iterations},
              {"factor_entries", solver.statistics().factor_entries},
              {"relative_residual", residual.norm() / b.norm()}};
}

/// Applies the load in adaptive increments.
Result<Json> solve_equilibrium(const SolveTask& task, const Body& body) {
  const fem::Assembler& assembler = *body.assembler;
  linear::LinearSolver solver({.kind = task.solver});
  const double increment = task.load / task.increments;
  fem::LoadStepper stepper(
      {0.0, VectorX::Zero(3 * body.mesh.node_count())},
      [&](double t, const VectorX& start) {
        return fem::find_equilibrium(assembler, BlockProblem::prescribed(body.mesh, t), start,
                                     solver, {.relative_tolerance = task.relative_tolerance});
      },
      {.first_increment = increment, .min_increment = increment / 64, .max_increment = increment});
  const Result<void> advanced = stepper.advance_to(task.load);
  if (!advanced) return tl::unexpected(advanced.error());
  const VectorX& u = stepper.state().u;
  const auto forces = assembler.forces(u);
  if (!forces) return fail(ErrorCode::kNotConverged, "the final state is inadmissible");
  if (!task.displacements.empty()) {
    const std::string_view bytes(reinterpret_cast<const char*>(u.data()),
                                 std::size_t(u.size()) * sizeof(double));
    LEFORT_TRY_VOID(io::write_text(task.displacements, bytes));
  }
  Json levels = Json::array(), iterations = Json::array();
  int failed = 0;
  for (const fem::LoadAttempt& attempt : stepper.attempts()) {
    iterations.push_back(std::max(int(attempt.history.size()) - 1, 0));
    if (attempt.stop == fem::NewtonStop::kConverged)
      levels.push_back(attempt.t_to);
    else
      ++failed;
  }
  return Json{
      {"solver", name_of(solver.kind())},
      {"load", task.load},
      {"load_levels", levels},
      {"failed_attempts", failed},
      {"newton_iterations", iterations},
      {"linear_iterations", solver.statistics().iterations},
      {"factorizations", solver.statistics().factorizations},
      {"max_residual_n", assembler.dofs().free_part(forces->residual_n).lpNorm<Eigen::Infinity>()},
      {"energy_mj", forces->energy_mj}};
}

}  // namespace

const char* name_of(linear::LinearSolverKind kind) { return name_in(kSolvers, kind); }

Json to_json(const SolveTask& task) {
  return {{"shape", mesh::name_of(task.block.shape)},
          {"cells", task.block.cells},
          {"solver", name_of(task.solver)},
          {"threads", task.threads},
          {"increments", task.increments},
          {"load", task.load},
          {"relative_tolerance", task.relative_tolerance},
          {"displacements", task.displacements.string()}};
}

Result<Json> run_solve_task(const std::string& text) {
  LEFORT_TRY(const SolveTask task, parse(text));
  const ThreadLimit limit(task.threads);
  const Stopwatch watch;
  LEFORT_TRY(const Body body, make_body(task.block));
  const double layout = watch.seconds();
  LEFORT_TRY(Json result,
             task.increments == 0 ? solve_system(task, body) : solve_equilibrium(task, body));
  result["dofs"] = body.assembler->dofs().free_count();
  result["layout_seconds"] = layout;
  result["seconds"] = watch.seconds();
  result["peak_bytes"] = peak_resident_bytes();
  return result;
}

Result<Json> solve_in_process(const SolveTask& task, Progress& progress) {
  LEFORT_TRY(const ProcessRun run, run_measured_process({"/proc/self/exe", "bench", "solve-task",
                                                         to_json(task).dump(), "--quiet", "--json"},
                                                        progress));
  if (run.exit_code != 0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the task {} ended with {}", to_json(task).dump(), run.exit_code));
  Json result = Json::parse(run.output, nullptr, false);
  if (result.is_discarded())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the task {} printed no JSON", to_json(task).dump()));
  result["wall_seconds"] = run.seconds;
  return result;
}

}  // namespace lefort::bench
