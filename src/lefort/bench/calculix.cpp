#include <lefort/bench/calculix.h>
#include <lefort/bench/run_process.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kPerLine = 12;  // Numbers; CalculiX reads at most 16 in a line.

std::string list_of(const std::vector<std::int32_t>& nodes) {
  std::string text;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    text += fmt::format("{},{}", nodes[k] + 1, (k + 1) % kPerLine == 0 ? "\n" : "");
  return text + (nodes.size() % kPerLine == 0 ? "" : "\n");
}

/// Nodes and elements; the order of nodes within them is VTK's.
std::string mesh_text(const mesh::VolumeMesh& mesh) {
  std::string text = "*NODE,NSET=ALL\n";
  for (Index n = 0; n < mesh.node_count(); ++n) {
    const Vec3& x = mesh.nodes_L[std::size_t(n)];
    text += fmt::format("{},{:.17g},{:.17g},{:.17g}\n", n + 1, x[0], x[1], x[2]);
  }
  const mesh::ElementBlock& block = mesh.blocks.front();
  const bool tets = block.shape == mesh::ElementShape::kTet10;
  text += fmt::format("*ELEMENT,TYPE={},ELSET=BLOCK\n", tets ? "C3D10" : "C3D8");
  for (Index e = 0; e < block.element_count(); ++e) {
    text += fmt::format("{}", e + 1);
    for (int a = 0; a < mesh::node_count(block.shape); ++a)
      text += fmt::format(",{}", block.element(e)[a] + 1);
    text += "\n";
  }
  return text + "*NSET,NSET=BELOW\n" + list_of(mesh.node_sets.at(BlockProblem::kBelow)) +
         "*NSET,NSET=ABOVE\n" + list_of(mesh.node_sets.at(BlockProblem::kAbove));
}

/// Material, step and boundary conditions. CalculiX's W = C10 (I1bar - 3) + (J - 1)^2 / D1 is ours
/// with C10 = mu / 2 and D1 = 2 / kappa.
std::string step_text(const CalculixTask& task) {
  const Vec3 moved_mm = BlockProblem::moved_mm(1.0);
  std::string text = fmt::format(
      "*MATERIAL,NAME=TISSUE\n*HYPERELASTIC,NEO HOOKE\n{:.17g},{:.17g}\n"
      "*SOLID SECTION,ELSET=BLOCK,MATERIAL=TISSUE\n*STEP,NLGEOM,INC=1000\n",
      0.5 * BlockProblem::kMu_mpa, 2.0 / BlockProblem::kKappa_mpa);
  // Residual force and correction, each relative to its mean, without exceptions.
  text += fmt::format("*CONTROLS,PARAMETERS=FIELD\n{0:g},{0:g},,,{0:g},1e-12,1e-12,1e-12\n",
                      task.tolerance);
  text += fmt::format("*STATIC,DIRECT,SOLVER={}\n{:.17g},1.\n*BOUNDARY\nBELOW,1,3\n",
                      name_of(task.solver), 1.0 / task.increments);
  for (int c = 0; c < 3; ++c) text += fmt::format("ABOVE,{0},{0},{1:.17g}\n", c + 1, moved_mm[c]);
  return text + fmt::format("*NODE PRINT,NSET=ALL,FREQUENCY={}\nU\n*END STEP\n", task.increments);
}

/// The number that follows the last `label`.
Result<double> last_number(std::string_view text, std::string_view label) {
  constexpr std::size_t kMaxLength = 40;
  if (const std::size_t at = text.rfind(label); at != std::string_view::npos) {
    const std::string number(text.substr(at + label.size(), kMaxLength));
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (end != number.c_str() && std::isfinite(value)) return value;
  }
  return fail(
      ErrorCode::kFileCorrupt,
      fmt::format("CalculiX's output, block.log, has no number after the last '{}'", label));
}

int count_of(std::string_view text, std::string_view label) {
  int count = 0;
  for (std::size_t at = text.find(label); at != std::string_view::npos;
       at = text.find(label, at + label.size()))
    ++count;
  return count;
}

Result<VectorX> displacements_in(const fs::path& file, Index nodes) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t(1) << 30;
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxBytes));
  const std::size_t begin = text.rfind("displacements");
  VectorX u = VectorX::Constant(3 * nodes, std::numeric_limits<double>::quiet_NaN());
  if (begin != std::string::npos) {
    std::istringstream lines(text.substr(text.find('\n', begin)));
    Index node = 0;
    for (double x = 0, y = 0, z = 0; lines >> node >> x >> y >> z;)
      if (node >= 1 && node <= nodes) u.segment<3>(3 * (node - 1)) = Vec3(x, y, z);
  }
  if (!u.allFinite())
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} does not have displacements of all nodes",
                                                     file.filename().string()));
  return u;
}

/// Runs ccx in the folder, because it writes files where it starts, and saves its output there.
Result<ProcessRun> run_ccx(const CalculixTask& task, Progress& progress) {
  constexpr int kNotFound = 127;  // Exit code of env if the program is missing.
  LEFORT_TRY(ProcessRun run, run_measured_process({"/usr/bin/env", "-C", task.folder.string(),
                                                   fmt::format("OMP_NUM_THREADS={}", task.threads),
                                                   "ccx", "-i", "block"},
                                                  progress));
  if (run.exit_code == kNotFound)
    return fail(ErrorCode::kInvalidArgument,
                "CalculiX's ccx is not installed (Debian: calculix-ccx); --repeats 0 omits it");
  const fs::path log = task.folder / "block.log";
  LEFORT_TRY_VOID(io::write_text(log, run.output));
  if (run.exit_code != 0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("CalculiX ({}) ended with {}; its output is in {}",
                            name_of(task.solver), run.exit_code, log.string()));
  return run;
}

}  // namespace

const char* name_of(CalculixSolver solver) {
  return solver == CalculixSolver::kSpooles ? "SPOOLES" : "ITERATIVE CHOLESKY";
}

Result<CalculixRun> run_calculix(const CalculixTask& task, Progress& progress) {
  constexpr std::string_view kResidual = "largest residual force=";
  std::error_code error;
  fs::create_directories(task.folder, error);
  const mesh::VolumeMesh mesh = task.block.mesh();
  LEFORT_TRY_VOID(io::write_text(task.folder / "block.inp", mesh_text(mesh) + step_text(task)));
  LEFORT_TRY(const ProcessRun run, run_ccx(task, progress));
  LEFORT_TRY(const double residual_n, last_number(run.output, kResidual));
  LEFORT_TRY(VectorX u, displacements_in(task.folder / "block.dat", mesh.node_count()));
  return CalculixRun{.wall_seconds = run.seconds,
                     .peak_bytes = run.peak_bytes,
                     .iterations = count_of(run.output, kResidual),
                     .max_residual_n = residual_n,
                     .displacements_mm = std::move(u)};
}

}  // namespace lefort::bench
