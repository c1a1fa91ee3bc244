#include <lefort/bench/calculix.h>
#include <lefort/bench/solve_block.h>
#include <lefort/bench/solve_task.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/core/version.h>
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

/// The three outputs in the making.
struct Tables {
  std::string markdown;
  std::string csv =
      "part,solver,shape,cells,dofs,threads,run,wall_seconds,seconds,peak_bytes,newton_iterations,"
      "linear_iterations,largest_residual_n,load\n";
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
                       number("linear_iterations"), number("largest_residual_n"), number("load"));
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

/// What CalculiX did with one of its linear solvers, run by run.
struct Peer {
  CalculixSolver solver;
  std::vector<double> ratios = {};  ///< Its wall time over ours, of the same turn.
  double difference = 0.0;          ///< Of displacements, over the largest one.
};

int sum_of(const Json& counts) {
  int sum = 0;
  for (const Json& count : counts) sum += count.get<int>();
  return sum;
}

/// CalculiX and we by turns, the same mesh, law, increments and threads.
Result<void> compare_with_calculix(const SolveOptions& options, Tables& tables,
                                   Progress& progress) {
  const BlockProblem block{.cells = options.pair_cells, .shape = mesh::ElementShape::kTet10};
  const CalculixTask theirs{.block = block,
                            .threads = options.threads,
                            .increments = options.increments,
                            .folder = options.output / "calculix"};
  const SolveTask ours{.block = block,
                       .threads = options.threads,
                       .increments = options.increments,
                       .relative_tolerance = theirs.tolerance,
                       .displacements = options.output / "displacements.f64"};
  std::array<Peer, 2> peers{{{.solver = CalculixSolver::kIterative},  //
                             {.solver = CalculixSolver::kSpooles}}};
  double dofs = 0.0;
  Json runs = Json::array();
  std::string rows;
  const auto add_row = [&](int run, const char* name, const Json& result,
                           const std::string& ratio) {
    tables.add_row("pair", name, block, dofs, options.threads, run, result);
    const double residual_n = result.at("largest_residual_n").get<double>();
    rows += fmt::format("| {} | {} | {:.2f} | {} | {} | {:.2f} | {} |\n", run, name,
                        result.at("wall_seconds").get<double>(), ratio,
                        sum_of(result.at("newton_iterations")),
                        result.at("peak_bytes").get<double>() * 1e-9,
                        residual_n > 0.0 ? fmt::format("{:.1e}", residual_n)
                                         : std::string("< 1e-6"));  // ccx prints six digits.
  };
  for (int run = 1; run <= options.repeats; ++run) {
    progress.begin_stage(fmt::format("turn {} of {}: lefort", run, options.repeats));
    LEFORT_TRY(const Json result, solve_in_process(ours, progress));
    LEFORT_TRY(const VectorX u, read_displacements(ours.displacements));
    dofs = result.at("dofs").get<double>();
    add_row(run, "lefort", result, "");
    Json turn = {{"lefort", result}};
    for (Peer& peer : peers) {
      const char* const name = name_of(peer.solver);
      progress.begin_stage(fmt::format("turn {} of {}: CalculiX, {}", run, options.repeats, name));
      CalculixTask task = theirs;
      task.solver = peer.solver;
      LEFORT_TRY(const CalculixRun done, run_calculix(task, progress));
      if (u.size() != done.displacements_mm.size())
        return fail(ErrorCode::kFileCorrupt,
                    "both tell displacements of different numbers of nodes");
      peer.difference =
          std::max(peer.difference, (u - done.displacements_mm).lpNorm<Eigen::Infinity>() /
                                        u.lpNorm<Eigen::Infinity>());
      peer.ratios.push_back(done.wall_seconds / result.at("wall_seconds").get<double>());
      const Json peer_json = {{"wall_seconds", done.wall_seconds},
                              {"peak_bytes", done.peak_bytes},
                              {"newton_iterations", Json::array({done.iterations})},
                              {"load", 1.0},
                              {"largest_residual_n", done.max_residual_n}};
      add_row(run, name, peer_json, fmt::format("{:.1f}", peer.ratios.back()));
      turn[name] = peer_json;
    }
    runs.push_back(std::move(turn));
  }
  tables.markdown += fmt::format(
      "## Beside CalculiX\n\nA cube of {0}³ cells of six tet10 / C3D10, {1:.0f} unknowns, pressed "
      "by a fifth of its height and sheared by as much in {2} increments; neo-Hookean, mu {3} MPa, "
      "kappa {4} MPa; {5} threads each, by turns. Wall time is of the whole process, CalculiX's "
      "reading of its input included. CalculiX with both linear solvers of Debian's package: "
      "SPOOLES, a direct one, and conjugate gradients; it has neither PARDISO nor PaStiX. Both "
      "stop at relative residuals of {7:.0e}, each by its own measure; the last "
      "column tells what "
      "was left.\n\n"
      "| turn | solver | s | over lefort | systems solved | GB | largest residual N |\n"
      "|---|---|---|---|---|---|---|\n{6}\n",
      options.pair_cells, dofs, options.increments, BlockProblem::kMu_mpa, BlockProblem::kKappa_mpa,
      options.threads, rows, theirs.tolerance);
  tables.json["pair"] = {{"dofs", dofs}, {"runs", runs}};
  for (const Peer& peer : peers) {
    const char* const name = name_of(peer.solver);
    tables.markdown += fmt::format(
        "**CalculiX ({}) takes {:.1f} times as long** (median); displacements differ by {:.5f} % "
        "of "
        "the largest one.\n\n",
        name, median(peer.ratios), 100.0 * peer.difference);
    tables.json["pair"][name] = {{"median_ratio", median(peer.ratios)},
                                 {"difference_percent", 100.0 * peer.difference}};
  }
  return {};
}

/// One linear system after another, larger and larger.
Result<void> measure_growth(const SolveOptions& options, Tables& tables, Progress& progress) {
  tables.markdown += fmt::format(
      "## Growth\n\nOne linear system: a cube of hex8 at rest, volume ratios not averaged, its "
      "upper side moved; neo-Hookean, mu {} MPa, kappa {} MPa; to 1e-8 of the right side by "
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

/// A million unknowns, a nonlinear equilibrium by multigrid.
Result<void> solve_large(const SolveOptions& options, Tables& tables, Progress& progress) {
  constexpr int kCells = 70;
  constexpr double kHalf = 0.5;  // Towards the whole, meshes so fine take ever more Newton steps.
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
      "## A million unknowns\n\nA cube of {}³ hex8, {:.0f} unknowns, pressed by a "
      "tenth of its height and sheared by as much, by multigrid: "
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
                fmt::format("cannot make {}: {}", options.output.string(), error.message()));
  Tables tables;
  tables.markdown = fmt::format("# The solver\n\nlefort {}, `lefort bench solve`.\n\n", kVersion);
  // Each part takes minutes; what is known is written before the next begins.
  if (options.repeats > 0) {
    LEFORT_TRY_VOID(compare_with_calculix(options, tables, progress));
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
