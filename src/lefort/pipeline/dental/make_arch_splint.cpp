#include <lefort/core/version.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/dental/arch_axes.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Thinner splints of acrylic break.
constexpr double kMinThickness_mm = 1.0;

Result<geometry::TriangleMesh> planned_arch(const fs::path& file,
                                            const std::optional<fs::path>& transform,
                                            Progress& progress) {
  LEFORT_TRY(geometry::TriangleMesh arch_L, io::read_surface(file, progress));
  if (!transform) return arch_L;
  LEFORT_TRY(const RigidTransform X, io::read_transform(*transform));
  return geometry::transformed(arch_L, X);
}

nlohmann::json fit_json(const dental::SplintFit& fit) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  return {
      {"clearance_mm",
       {{"p5", number(fit.p5_mm)}, {"median", number(fit.median_mm)}, {"p95", number(fit.p95_mm)}}},
      {"max_penetration_mm", fit.max_penetration_mm}};
}

std::string text_of(const dental::Splint& splint, const fs::path& file) {
  std::string text = fmt::format("{}: {:.1f} ml, {:.2f} mm between the arches", file.string(),
                                 splint.volume_ml, splint.min_thickness_mm);
  for (const auto& [name, fit] :
       {std::pair{"upper", &splint.upper}, std::pair{"lower", &splint.lower}})
    text += fmt::format(
        "\n  {}: clearance {:.2f} mm (5 % to 95 %: {:.2f} to {:.2f}), penetration on "
        "the way in {:.2f} mm",
        name, fit->median_mm, fit->p5_mm, fit->p95_mm, fit->max_penetration_mm);
  if (splint.min_thickness_mm < kMinThickness_mm)
    text += fmt::format("\n  warning: {}: open the jaws until it is {:g} mm thick",
                        splint.min_thickness_mm > 0.0 ? "the splint is thin"
                                                      : "the splint has holes where teeth touch",
                        kMinThickness_mm);
  return text + fmt::format("\n{}", kNotForClinicalUse);
}

}  // namespace

Result<Summary> make_arch_splint(const SplintJob& job, Progress& progress) {
  LEFORT_TRY(const geometry::TriangleMesh upper_L,
             planned_arch(job.upper, job.upper_transform, progress));
  LEFORT_TRY(const geometry::TriangleMesh lower_L,
             planned_arch(job.lower, job.lower_transform, progress));
  LEFORT_TRY(const dental::ArchAxes axes, read_arch_axes(job.arches));
  LEFORT_TRY(const dental::Splint splint,
             dental::make_splint(upper_L, lower_L, axes, job.options, progress));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const fs::path file = job.output / "splint.stl";
  LEFORT_TRY_VOID(io::write_surface(file, splint.surface_L));
  Summary summary;
  summary.json = {{"lefort_splint", 1},
                  {"notice", kNotForClinicalUse},
                  {"volume_ml", splint.volume_ml},
                  {"min_thickness_mm", splint.min_thickness_mm},
                  {"upper", fit_json(splint.upper)},
                  {"lower", fit_json(splint.lower)}};
  summary.text = text_of(splint, file);
  LEFORT_TRY_VOID(io::write_text(job.output / "splint.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
