#include <lefort/bench/ball_problem.h>
#include <lefort/bench/calculix_ball.h>
#include <lefort/bench/calculix_program.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace lefort::bench {
namespace {

namespace fs = std::filesystem;

/// The lower half of the ball as one layer of wedges, because CalculiX needs elements behind a
/// surface; all of their nodes are moved, so that they are rigid.
std::string ball_text(int halvings, Index first_node, Index first_element) {
  constexpr double kInner = 0.9;  // Radius over that of the ball.
  const geometry::TriangleMesh ball = BallProblem::ball(halvings);
  const Vec3 center = BallProblem::center_mm();
  const auto count = Index(ball.vertices.size());
  std::string text = "*NODE,NSET=BALL\n";
  for (const double scale : {1.0, kInner})
    for (const Vec3& v : ball.vertices) {
      const Vec3 x = center + scale * (v - center);
      text += fmt::format("{},{:.17g},{:.17g},{:.17g}\n", ++first_node, x[0], x[1], x[2]);
    }
  const Index outer = first_node - 2 * count + 1, inner = outer + count;
  text += "*ELEMENT,TYPE=C3D6,ELSET=SHELL\n";
  for (const auto& [a, b, c] : ball.triangles) {
    bool lower = true;
    for (const std::int32_t v : {a, b, c}) lower &= ball.vertices[std::size_t(v)].z() < center.z();
    if (lower)
      text += fmt::format("{},{},{},{},{},{},{}\n", ++first_element, inner + a, inner + b,
                          inner + c, outer + a, outer + b, outer + c);
  }
  return text + "*SURFACE,NAME=ROUND,TYPE=ELEMENT\nSHELL,S2\n";
}

/// Faces S2 of the uppermost layer of hexahedra.
std::string upper_faces_text(const mesh::VolumeMesh& mesh) {
  std::vector<bool> is_above(std::size_t(mesh.node_count()), false);
  for (const std::int32_t node : mesh.node_sets.at(BallProblem::kAbove))
    is_above[std::size_t(node)] = true;
  const mesh::ElementBlock& block = mesh.blocks.front();
  constexpr int kFirstUpper = 4;  // Of the nodes of a hexahedron.
  std::string text = "*SURFACE,NAME=UPPER,TYPE=ELEMENT\n";
  for (Index e = 0; e < block.element_count(); ++e)
    if (is_above[std::size_t(block.element(e)[kFirstUpper])]) text += fmt::format("{},S2\n", e + 1);
  return text;
}

/// CalculiX's W = C10 (I1bar - 3) + (J - 1)^2 / D1 is ours with D1 = 2 / kappa.
std::string law_text(const CalculixBallTask& task) {
  const bool mortar = task.contact == CalculixContact::kMortar;
  return fmt::format(
      "*MATERIAL,NAME=TISSUE\n*HYPERELASTIC,NEO HOOKE\n{:.17g},{:.17g}\n"
      "*MATERIAL,NAME=RIGID\n*ELASTIC\n1,0.3\n"
      "*SOLID SECTION,ELSET=BLOCK,MATERIAL=TISSUE\n*SOLID SECTION,ELSET=SHELL,MATERIAL=RIGID\n"
      "*SURFACE INTERACTION,NAME=CONTACT\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n{:.17g}\n"
      "*CONTACT PAIR,INTERACTION=CONTACT,TYPE={}\nUPPER,ROUND\n",
      BallProblem::kC10_mpa, 2.0 / BallProblem::kKappa_mpa, task.stiffness_mpa_per_mm,
      mortar ? "MORTAR" : "NODE TO SURFACE");
}

/// A step of equal increments, divided where they do not converge.
std::string step_text(const CalculixBallTask& task, int increments, const std::string& motion) {
  return fmt::format(
      "*STEP,NLGEOM,INC=10000\n{0}"
      "*STATIC,SOLVER=SPOOLES\n{1:.17g},1.,1e-6,{1:.17g}\n*BOUNDARY\nBELOW,1,3\n{2}"
      "*NODE PRINT,NSET=BELOW,TOTALS=ONLY\nRF\n*END STEP\n",
      calculix_tolerance(task.tolerance), 1.0 / increments, motion);
}

std::string input_text(const CalculixBallTask& task) {
  const mesh::VolumeMesh mesh = BallProblem::block();
  return calculix_mesh(mesh) + "*NSET,NSET=BELOW\n" +
         calculix_list(mesh.node_sets.at(BallProblem::kBelow)) + upper_faces_text(mesh) +
         ball_text(task.halvings, mesh.node_count(), mesh.element_count()) + law_text(task) +
         step_text(task, BallProblem::kPressIncrements,
                   fmt::format("BALL,1,2\nBALL,3,3,{:.17g}\n", -BallProblem::kPressed_mm)) +
         step_text(task, BallProblem::kSlideIncrements,
                   fmt::format("BALL,1,1,{:.17g}\n", BallProblem::kSlid_mm));
}

/// The third component of the last total force on the lower side.
Result<double> support_force_z_n(const std::string& text) {
  const std::size_t begin = text.rfind("total force");
  const std::size_t end_of_line = begin == std::string::npos ? begin : text.find('\n', begin);
  if (end_of_line != std::string::npos) {
    const char* at = text.c_str() + end_of_line;
    double force_n = NAN;
    for (int component = 0; component < 3; ++component) {
      char* end = nullptr;
      force_n = std::strtod(at, &end);
      if (end == at) return fail(ErrorCode::kFileCorrupt, "ball.dat has no force at the end");
      at = end;
    }
    if (std::isfinite(force_n)) return force_n;
  }
  return fail(ErrorCode::kFileCorrupt, "ball.dat has no force at the end");
}

}  // namespace

const char* name_of(CalculixContact contact) {
  return contact == CalculixContact::kMortar ? "mortar" : "node to surface";
}

Result<CalculixBallRun> run_calculix_ball(const CalculixBallTask& task, Progress& progress) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t(1) << 28;
  std::error_code error;
  fs::create_directories(task.folder, error);
  LEFORT_TRY_VOID(io::write_text(task.folder / "ball.inp", input_text(task)));
  LEFORT_TRY(const ProcessRun run, run_ccx(task.folder, "ball", task.threads, progress));
  LEFORT_TRY(const std::string totals, io::read_text(task.folder / "ball.dat", kMaxBytes));
  LEFORT_TRY(const double support_n, support_force_z_n(totals));
  return CalculixBallRun{.wall_seconds = run.seconds,
                         .iterations = count_of(run.output, "largest residual force="),
                         .increments = count_of(totals, "total force"),
                         .force_z_n = -support_n};
}

}  // namespace lefort::bench
