#include <lefort/core/version.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_3mf.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/dental/arch_directions.h>
#include <lefort/pipeline/dental/dental_json.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/report/draw_letters.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Thinner splints of acrylic break.
constexpr double kMinThickness_mm = 1.0;

Result<RigidTransform> motion_in(const std::optional<fs::path>& transform) {
  if (!transform) return RigidTransform::Identity();
  return io::read_transform(*transform);
}

/// Letters of 3 mm: the capitals of the font are 0.73 em high.
Result<dental::TextMask> text_mask(const std::string& text) {
  constexpr double kPixel_mm = 0.1, kLetters_mm = 3.0, kCapitals = 0.73;
  constexpr std::size_t kMaxLetters = 16;
  if (text.empty()) return dental::TextMask();
  if (nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::ignore) !=
          nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) ||
      text.find("\xEF\xBF\xBE") != std::string::npos ||
      text.find("\xEF\xBF\xBF") != std::string::npos)
    return fail(ErrorCode::kInvalidArgument, "the text is not UTF-8, or has a letter that is none");
  const auto letters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // Not a continuation in UTF-8.
  });
  const bool has_control = std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
  });
  if (std::size_t(letters) > kMaxLetters || has_control)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the text has {} letters{}, must be {} or fewer on one line", letters,
                            has_control ? " with control characters" : "", kMaxLetters));
  LEFORT_TRY(const report::Picture drawn,
             report::draw_letters(text, kLetters_mm / kCapitals / kPixel_mm));
  dental::TextMask mask{drawn.width, drawn.height, kPixel_mm, {}};
  mask.coverage.reserve(std::size_t(mask.width * mask.height));
  for (int row = 0; row < drawn.height; ++row)
    for (int column = 0; column < drawn.width; ++column)
      mask.coverage.push_back(1.0F - float(drawn.pixel(column, row)[0]) / 255.0F);
  return mask;
}

/// The directions, moved with the jaw they are of.
/// \param X_LU, X_LB  motions of the upper and of the lower jaw.
dental::ArchAxes moved(const ArchDirections& directions, const RigidTransform& X_LU,
                       const RigidTransform& X_LB) {
  dental::ArchAxes axes = directions.axes;
  if (!directions.jaw) return axes;
  const RigidTransform& X = *directions.jaw == anatomy::Tooth::kUpper ? X_LU : X_LB;
  axes.superior_L = X.linear() * axes.superior_L;
  axes.anterior_L = X.linear() * axes.anterior_L;
  return axes;
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
    text += fmt::format("\n  warning: {}: open the jaws (--open) until it is {:g} mm thick",
                        splint.min_thickness_mm > 0.0 ? "the splint is thin"
                                                      : "the splint has holes where teeth touch",
                        kMinThickness_mm);
  if (splint.parts > 1)
    text +=
        fmt::format("\n  warning: the splint has {} parts, which nothing connects: widen the wall",
                    splint.parts);
  return text + fmt::format("\n{}", kNotForClinicalUse);
}

}  // namespace

Result<Summary> make_arch_splint(const SplintJob& job, Progress& progress) {
  LEFORT_TRY(geometry::TriangleMesh upper_L, io::read_surface(job.upper, progress));
  LEFORT_TRY(geometry::TriangleMesh lower_L, io::read_surface(job.lower, progress));
  LEFORT_TRY(const RigidTransform X_upper, motion_in(job.upper_transform));
  LEFORT_TRY(RigidTransform X_lower, motion_in(job.lower_transform));
  LEFORT_TRY(const ArchDirections directions, read_arch_directions(job.arches));
  if (!(job.open_mm >= 0.0 && job.open_mm <= 20.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the arches are opened by {} mm, must be 0 to 20", job.open_mm));
  const dental::ArchAxes axes = moved(directions, X_upper, X_lower);
  X_lower.translation() -= job.open_mm * axes.superior_L;
  upper_L = geometry::transformed(upper_L, X_upper);
  lower_L = geometry::transformed(lower_L, X_lower);
  dental::SplintOptions options = job.options;
  LEFORT_TRY(options.text, text_mask(job.text));
  LEFORT_TRY(const dental::Splint splint,
             dental::make_splint(upper_L, lower_L, axes, options, progress));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(io::remove_earlier_files(std::vector<fs::path>{
      job.output / "splint.json", job.output / "splint.3mf", job.output / "splint.stl"}));
  const fs::path file = job.output / "splint.stl";
  LEFORT_TRY_VOID(io::write_surface(file, splint.surface_L));
  const std::string title = job.text.empty() ? "splint" : fmt::format("splint {}", job.text);
  LEFORT_TRY_VOID(io::write_3mf(job.output / "splint.3mf", splint.surface_L, title));
  Summary summary;
  summary.json = {{"lefort_splint", 1},
                  {"notice", kNotForClinicalUse},
                  {"volume_ml", splint.volume_ml},
                  {"parts", splint.parts},
                  {"min_thickness_mm", splint.min_thickness_mm},
                  {"open_mm", job.open_mm},
                  {"text", job.text},
                  {"upper_pose_4x4_row_major_mm_lps", as_json(X_upper)},
                  {"lower_pose_4x4_row_major_mm_lps", as_json(X_lower)},
                  {"upper", fit_json(splint.upper)},
                  {"lower", fit_json(splint.lower)}};
  summary.text = text_of(splint, file);
  LEFORT_TRY_VOID(io::write_text(job.output / "splint.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
