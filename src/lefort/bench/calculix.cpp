#include <lefort/bench/calculix.h>
#include <lefort/bench/calculix_program.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <limits>
#include <sstream>
#include <string>
#include <string_view>

namespace lefort::bench {
namespace {

namespace fs = std::filesystem;

/// Nodes, elements and the sets of the two sides.
std::string model_text(const mesh::VolumeMesh& mesh) {
  return calculix_mesh(mesh) + "*NSET,NSET=BELOW\n" +
         calculix_list(mesh.node_sets.at(BlockProblem::kBelow)) + "*NSET,NSET=ABOVE\n" +
         calculix_list(mesh.node_sets.at(BlockProblem::kAbove));
}

/// Material, step and boundary conditions. CalculiX's W = C10 (I1bar - 3) + (J - 1)^2 / D1 is ours
/// with C10 = mu / 2 and D1 = 2 / kappa.
std::string step_text(const CalculixTask& task) {
  const Vec3 moved_mm = BlockProblem::moved_mm(1.0);
  std::string text = fmt::format(
      "*MATERIAL,NAME=TISSUE\n*HYPERELASTIC,NEO HOOKE\n{:.17g},{:.17g}\n"
      "*SOLID SECTION,ELSET=BLOCK,MATERIAL=TISSUE\n*STEP,NLGEOM,INC=1000\n",
      0.5 * BlockProblem::kMu_mpa, 2.0 / BlockProblem::kKappa_mpa);
  text += calculix_tolerance(task.tolerance);
  text += fmt::format("*STATIC,DIRECT,SOLVER={}\n{:.17g},1.\n*BOUNDARY\nBELOW,1,3\n",
                      name_of(task.solver), 1.0 / task.increments);
  for (int c = 0; c < 3; ++c) text += fmt::format("ABOVE,{0},{0},{1:.17g}\n", c + 1, moved_mm[c]);
  return text + fmt::format("*NODE PRINT,NSET=ALL,FREQUENCY={}\nU\n*END STEP\n", task.increments);
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

}  // namespace

const char* name_of(CalculixSolver solver) {
  return solver == CalculixSolver::kSpooles ? "SPOOLES" : "ITERATIVE CHOLESKY";
}

Result<CalculixRun> run_calculix(const CalculixTask& task, Progress& progress) {
  constexpr std::string_view kResidual = "largest residual force=";
  std::error_code error;
  fs::create_directories(task.folder, error);
  const mesh::VolumeMesh mesh = task.block.mesh();
  LEFORT_TRY_VOID(io::write_text(task.folder / "block.inp", model_text(mesh) + step_text(task)));
  LEFORT_TRY(const ProcessRun run, run_ccx(task.folder, "block", task.threads, progress));
  LEFORT_TRY(const double residual_n, last_number(run.output, kResidual));
  LEFORT_TRY(VectorX u, displacements_in(task.folder / "block.dat", mesh.node_count()));
  return CalculixRun{.wall_seconds = run.seconds,
                     .peak_bytes = run.peak_bytes,
                     .iterations = count_of(run.output, kResidual),
                     .max_residual_n = residual_n,
                     .displacements_mm = std::move(u)};
}

}  // namespace lefort::bench
