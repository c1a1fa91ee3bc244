#include <lefort/bench/calculix.h>
#include <lefort/bench/solve_block.h>
#include <lefort/bench/solve_task.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/core/version.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

namespace lefort::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Slope of the line through (ln x, ln y) by least squares.
double exponent(std::span<const double> x, std::span<const double> y) {
  double sum_u = 0.0, sum_v = 0.0, sum_uu = 0.0, sum_uv = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y[i]);
    sum_u += u;
    sum_v += v;
    sum_uu += u * u;
    sum_uv += u * v;
  }
  const auto n = double(x.size());
  return (n * sum_uv - sum_u * sum_v) / (n * sum_uu - sum_u * sum_u);
}

/// The three outputs.
struct Tables {
  std::string markdown;
  std::string csv =
      "part,solver,shape,cells,dofs,threads,run,wall_seconds,seconds,peak_bytes,newton_iterations,"
      "linear_iterations,max_residual_n,load\n";
  Json json = Json::object();

  void add_row(const std::string& part, const std::string& solver, const BlockProblem& block,
               double dofs, int threads, int run, const Json& result) {
    const auto number = [&](const char* key) {
      return result.contains(key) && result.at(key).is_number()
                 ? fmt::format("{:.9g}", result.at(key).get<double>())
                 : std::string();
    };
    double newton = 0.0;
    if (result.contains("newton_iterations"))
      for (const Json& count : result.at("newton_iterations")) newton += count.get<double>();
    csv += fmt::format("{},{},{},{},{:.0f},{},{},{},{},{},{:.0f},{},{},{}\n", part, solver,
                       mesh::name_of(block.shape), block.cells, dofs, threads, run,
                       number("wall_seconds"), number("seconds"), number("peak_bytes"), newton,
                       number("linear_iterations"), number("max_residual_n"), number("load"));
  }
};

Result<void> write(const Tables& tables, const fs::path& folder) {
  LEFORT_TRY_VOID(io::write_text(folder / "solve.md", tables.markdown));
  LEFORT_TRY_VOID(io::write_text(folder / "solve.csv", tables.csv));
  return io::write_text(folder / "solve.json", tables.json.dump(1) + "\n");
}

Result<VectorX> read_displacements(const fs::path& file) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t(1) << 30;
  LEFORT_TRY(const std::string bytes, io::read_text(file, kMaxBytes));
  std::vector<double> u(bytes.size() / sizeof(double));
  std::memcpy(u.data(), bytes.data(), u.size() * sizeof(double));
  return VectorX(VectorX::Map(u.data(), Index(u.size())));
}

/// Results of CalculiX with one of its linear solvers.
struct CalculixResults {
  CalculixSolver solver;
  std::vector<double> ratios = {};  ///< Its wall time over ours, of the same turn.
  double difference = 0.0;          ///< Of displacements, relative to the largest one.
};

int sum_of(const Json& counts) {
  int sum = 0;
  for (const Json& count : counts) sum += count.get<int>();
  return sum;
}

/// Solves one block with lefort and CalculiX in turns: same mesh, law, increments and threads.
class CalculixComparison {
 public:
  CalculixComparison(const SolveOptions& options, Tables& tables)
      : options_(options),
        tables_(tables),
        block_{.cells = options.pair_cells, .shape = mesh::ElementShape::kTet10},
        calculix_{.block = block_,
                  .threads = options.threads,
                  .increments = options.increments,
                  .folder = options.output / "calculix"},
        lefort_{.block = block_,
                .threads = options.threads,
                .increments = options.increments,
                .relative_tolerance = calculix_.tolerance,
                .displacements = options.output / "displacements.f64"} {}

  [[nodiscard]] Result<void> run(Progress& progress) {
    for (int turn = 1; turn <= options_.repeats; ++turn) LEFORT_TRY_VOID(run_turn(turn, progress));
    write_summary();
    return {};
  }

 private:
  void add_row(int turn, const char* name, const Json& result, const std::string& ratio) {
    tables_.add_row("pair", name, block_, dofs_, options_.threads, turn, result);
    const double residual_n = result.at("max_residual_n").get<double>();
    rows_ += fmt::format("| {} | {} | {:.2f} | {} | {} | {:.2f} | {} |\n", turn, name,
                         result.at("wall_seconds").get<double>(), ratio,
                         sum_of(result.at("newton_iterations")),
                         result.at("peak_bytes").get<double>() * 1e-9,
                         residual_n > 0.0 ? fmt::format("{:.1e}", residual_n)
                                          : std::string("< 1e-6"));  // ccx prints six digits.
  }

  [[nodiscard]] Result<void> run_turn(int turn, Progress& progress) {
    progress.begin_stage(fmt::format("turn {} of {}: lefort", turn, options_.repeats));
    LEFORT_TRY(const Json result, solve_in_process(lefort_, progress));
    LEFORT_TRY(const VectorX u, read_displacements(lefort_.displacements));
    dofs_ = result.at("dofs").get<double>();
    add_row(turn, "lefort", result, "");
    Json run = {{"lefort", result}};
    for (CalculixResults& results : results_) {
      const char* const name = name_of(results.solver);
      progress.begin_stage(
          fmt::format("turn {} of {}: CalculiX, {}", turn, options_.repeats, name));
      LEFORT_TRY(run[name], run_calculix_once(turn, results, u,
                                              result.at("wall_seconds").get<double>(), progress));
    }
    runs_.push_back(std::move(run));
    return {};
  }

  /// \param u             displacements of lefort.
  /// \param wall_seconds  of lefort.
  [[nodiscard]] Result<Json> run_calculix_once(int turn, CalculixResults& results, const VectorX& u,
                                               double wall_seconds, Progress& progress) {
    CalculixTask task = calculix_;
    task.solver = results.solver;
    LEFORT_TRY(const CalculixRun done, run_calculix(task, progress));
    if (u.size() != done.displacements_mm.size())
      return fail(ErrorCode::kFileCorrupt,
                  "lefort and CalculiX wrote displacements of different numbers of nodes");
    results.difference =
        std::max(results.difference, (u - done.displacements_mm).lpNorm<Eigen::Infinity>() /
                                         u.lpNorm<Eigen::Infinity>());
    results.ratios.push_back(done.wall_seconds / wall_seconds);
    Json result = {{"wall_seconds", done.wall_seconds},
                   {"peak_bytes", done.peak_bytes},
                   {"newton_iterations", Json::array({done.iterations})},
                   {"load", 1.0},
                   {"max_residual_n", done.max_residual_n}};
    add_row(turn, name_of(results.solver), result, fmt::format("{:.1f}", results.ratios.back()));
    return result;
  }

  void write_summary() {
    tables_.markdown += fmt::format(
        "## Comparison with CalculiX\n\nA cube of {0}³ cells of six tet10 / C3D10, {1:.0f} "
        "unknowns, compressed by a fifth of its height and sheared by as much in {2} increments; "
        "neo-Hookean, mu {3} MPa, kappa {4} MPa; {5} threads each, in turns. Wall time is that of "
        "the whole process, including CalculiX's reading of its input. CalculiX with both linear "
        "solvers of Debian's package: SPOOLES, which is direct, and conjugate gradients; the "
        "package has neither PARDISO nor PaStiX. Both programs stop at relative residuals of "
        "{7:.0e}, each by its own measure; the last column is the remaining residual.\n\n"
        "| turn | solver | s | over lefort | systems solved | GB | largest residual N |\n"
        "|---|---|---|---|---|---|---|\n{6}\n",
        options_.pair_cells, dofs_, options_.increments, BlockProblem::kMu_mpa,
        BlockProblem::kKappa_mpa, options_.threads, rows_, calculix_.tolerance);
    tables_.json["pair"] = {{"dofs", dofs_}, {"runs", runs_}};
    for (const CalculixResults& results : results_) {
      const char* const name = name_of(results.solver);
      tables_.markdown += fmt::format(
          "**CalculiX ({}) takes {:.1f} times as long** (median); displacements differ by {:.5f} % "
          "of the largest one.\n\n",
          name, median(results.ratios), 100.0 * results.difference);
      tables_.json["pair"][name] = {{"median_ratio", median(results.ratios)},
                                    {"difference_percent", 100.0 * results.difference}};
    }
  }

  const SolveOptions& options_;
  Tables& tables_;
  BlockProblem block_;
  CalculixTask calculix_;
  SolveTask lefort_;
  std::array<CalculixResults, 2> results_{
      {{.solver = CalculixSolver::kIterative}, {.solver = CalculixSolver::kSpooles}}};
  double dofs_ = 0.0;
  Json runs_ = Json::array();
  std::string rows_;
};

/// Solves one linear system on each of a series of growing meshes.
Result<void> measure_growth(const SolveOptions& options, Tables& tables, Progress& progress) {
  tables.markdown += fmt::format(
      "## Growth\n\nOne linear system: a cube of hex8 at rest, full integration, with a moved "
      "upper side; neo-Hookean, mu {} MPa, kappa {} MPa; to 1e-8 of the right-hand side by "
      "multigrid. {} threads.\n\n",
      BlockProblem::kMu_mpa, BlockProblem::kKappa_mpa, options.threads);
  for (const linear::LinearSolverKind kind :
       {linear::LinearSolverKind::kDirect, linear::LinearSolverKind::kMultigrid}) {
    std::vector<double> dofs, seconds, bytes, assembly;
    std::string rows;
    for (const int cells : options.growth_cells) {
      const BlockProblem block{.cells = cells, .shape = mesh::ElementShape::kHex8};
      progress.begin_stage(fmt::format("{}, {} cells a side", name_of(kind), cells));
      LEFORT_TRY(Json result,
                 solve_in_process(
                     {.block = block, .solver = kind, .threads = options.threads, .increments = 0},
                     progress));
      const auto number = [&](const char* key) { return result.at(key).get<double>(); };
      dofs.push_back(number("dofs"));
      assembly.push_back(number("assembly_seconds"));
      seconds.push_back(number("preparation_seconds") + number("solution_seconds"));
      bytes.push_back(number("peak_bytes"));
      rows += fmt::format("| {:.0f} | {:.3f} | {:.3f} | {:.3f} | {:.0f} | {:.3f} | {:.1e} |\n",
                          dofs.back(), assembly.back(), number("preparation_seconds"),
                          number("solution_seconds"), number("linear_iterations"),
                          bytes.back() * 1e-9, number("relative_residual"));
      tables.add_row("growth", name_of(kind), block, dofs.back(), options.threads, 1, result);
      tables.json["growth"][name_of(kind)].push_back(std::move(result));
    }
    tables.markdown += fmt::format(
        "### {}\n\n| unknowns | assembly s | preparation s | solution s | iterations | peak GB | "
        "residual |\n|---|---|---|---|---|---|---|\n{}",
        name_of(kind), rows);
    if (dofs.size() > 1) {
      const double time = exponent(dofs, seconds), memory = exponent(dofs, bytes);
      tables.markdown +=
          fmt::format("| **exponent** | {:.2f} | {:.2f} | (with preparation) | | {:.2f} | |\n",
                      exponent(dofs, assembly), time, memory);
      tables.json["exponents"][name_of(kind)] = {{"seconds", time}, {"bytes", memory}};
    }
    tables.markdown += "\n";
  }
  return {};
}

/// Solves a nonlinear equilibrium of a million unknowns with multigrid.
Result<void> solve_large(const SolveOptions& options, Tables& tables, Progress& progress) {
  constexpr int kCells = 70;
  // At larger loads such fine meshes need ever more Newton steps.
  constexpr double kHalf = 0.5;
  const BlockProblem block{.cells = kCells, .shape = mesh::ElementShape::kHex8};
  progress.begin_stage("a million unknowns");
  LEFORT_TRY(Json result, solve_in_process({.block = block,
                                            .solver = linear::LinearSolverKind::kMultigrid,
                                            .threads = options.threads,
                                            .increments = options.increments,
                                            .load = kHalf},
                                           progress));
  const double dofs = result.at("dofs").get<double>();
  tables.add_row("large", "multigrid", block, dofs, options.threads, 1, result);
  tables.markdown += fmt::format(
      "## A million unknowns\n\nA cube of {}³ hex8, {:.0f} unknowns, compressed by a tenth of its "
      "height and sheared by as much, by multigrid: "
      "**{:.0f} s**, {} increments ({} were too large and halved), {} Newton steps, {} linear "
      "iterations in all, {:.1f} GB.\n\n",
      kCells, dofs, result.at("wall_seconds").get<double>(), result.at("load_levels").size(),
      result.at("failed_attempts").get<int>(), sum_of(result.at("newton_iterations")),
      result.at("linear_iterations").get<int>(), result.at("peak_bytes").get<double>() * 1e-9);
  tables.json["large"] = std::move(result);
  return {};
}

}  // namespace

Result<std::string> run_solve_bench(const SolveOptions& options, Progress& progress) {
  std::error_code error;
  fs::create_directories(options.output, error);
  if (error)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("cannot create {}: {}", options.output.string(), error.message()));
  Tables tables;
  tables.markdown = fmt::format("# The solver\n\nlefort {}, `lefort bench solve`.\n\n", kVersion);
  // Each part takes minutes; results are written before the next one begins.
  if (options.repeats > 0) {
    LEFORT_TRY_VOID(CalculixComparison(options, tables).run(progress));
    LEFORT_TRY_VOID(write(tables, options.output));
  }
  if (!options.growth_cells.empty()) {
    LEFORT_TRY_VOID(measure_growth(options, tables, progress));
    LEFORT_TRY_VOID(write(tables, options.output));
  }
  if (options.large) {
    LEFORT_TRY_VOID(solve_large(options, tables, progress));
    LEFORT_TRY_VOID(write(tables, options.output));
  }
  return tables.markdown;
}

}  // namespace lefort::bench
