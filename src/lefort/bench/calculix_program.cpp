#include <lefort/bench/calculix_program.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace lefort::bench {

std::string calculix_list(const std::vector<std::int32_t>& numbers) {
  constexpr int kPerLine = 12;  // CalculiX reads at most 16 in a line.
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    text += fmt::format("{},{}", numbers[k] + 1, (k + 1) % kPerLine == 0 ? "\n" : "");
  return text + (numbers.size() % kPerLine == 0 ? "" : "\n");
}

std::string calculix_mesh(const mesh::VolumeMesh& mesh) {
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
  return text;
}

std::string calculix_tolerance(double residual) {
  return fmt::format("*CONTROLS,PARAMETERS=FIELD\n{0:g},{0:g},,,{0:g},1e-12,1e-12,1e-12\n",
                     residual);
}

Result<ProcessRun> run_ccx(const std::filesystem::path& folder, const std::string& name,
                           int threads, Progress& progress) {
  constexpr int kNotFound = 127;  // Exit code of env if the program is missing.
  LEFORT_TRY(ProcessRun run,
             run_measured_process({"/usr/bin/env", "-C", folder.string(),
                                   fmt::format("OMP_NUM_THREADS={}", threads), "ccx", "-i", name},
                                  progress));
  if (run.exit_code == kNotFound)
    return fail(
        ErrorCode::kInvalidArgument,
        "CalculiX's ccx is not installed (Debian: calculix-ccx); bench solve --repeats 0 and bench "
        "contact --without-calculix leave it out");
  const std::filesystem::path log = folder / (name + ".log");
  LEFORT_TRY_VOID(io::write_text(log, run.output));
  if (run.exit_code != 0)
    return fail(ErrorCode::kNotConverged, fmt::format("CalculiX ended with {}; its output is in {}",
                                                      run.exit_code, log.string()));
  return run;
}

Result<double> last_number(std::string_view text, std::string_view label) {
  constexpr std::size_t kMaxLength = 40;
  if (const std::size_t at = text.rfind(label); at != std::string_view::npos) {
    const std::string number(text.substr(at + label.size(), kMaxLength));
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (end != number.c_str() && std::isfinite(value)) return value;
  }
  return fail(ErrorCode::kFileCorrupt,
              fmt::format("CalculiX's output has no number after the last '{}'", label));
}

int count_of(std::string_view text, std::string_view label) {
  int count = 0;
  for (std::size_t at = text.find(label); at != std::string_view::npos;
       at = text.find(label, at + label.size()))
    ++count;
  return count;
}

}  // namespace lefort::bench
