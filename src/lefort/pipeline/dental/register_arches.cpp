#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/version.h>
#include <lefort/dental/crowns.h>
#include <lefort/dental/register_arch.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/prepare/load_head.h>

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using anatomy::Tooth;

/// An intraoral scan in the frame of the CT.
struct RegisteredArch {
  dental::Crowns crowns;
  dental::ArchFit fit;
  geometry::TriangleMesh scan_L;
};

nlohmann::json distances_json(const dental::CrownDistances& distances) {
  return {{"points", distances.points},
          {"fraction", distances.fraction},
          {"rms_mm", distances.rms_mm},
          {"p95_mm", distances.p95_mm}};
}

nlohmann::json arch_json(const RegisteredArch& arch) {
  nlohmann::json sextants;
  for (const auto sextant :
       {dental::Sextant::kRight, dental::Sextant::kAnterior, dental::Sextant::kLeft})
    sextants[dental::name_of(sextant)] = distances_json(arch.fit.sextants[std::size_t(sextant)]);
  return {{"pose_4x4_row_major_mm_lps", as_json(arch.fit.X_L_scan)},
          {"occlusal", as_json(arch.crowns.occlusal_L)},
          {"anterior", as_json(arch.crowns.anterior_L)},
          {"border_hu", arch.crowns.border_hu},
          {"scale", arch.fit.scale},
          {"is_reversed", arch.fit.is_reversed},
          {"distances", distances_json(arch.fit.all)},
          {"sextants", sextants}};
}

std::string arch_text(const RegisteredArch& arch) {
  std::string text = fmt::format(
      "\n  {} jaw: RMS {:.2f} mm, P95 {:.2f} mm over {:.0f} % of the crowns, scale {:.4f}",
      dental::name_of(arch.crowns.jaw), arch.fit.all.rms_mm, arch.fit.all.p95_mm,
      100.0 * arch.fit.all.fraction, arch.fit.scale);
  for (const auto sextant :
       {dental::Sextant::kRight, dental::Sextant::kAnterior, dental::Sextant::kLeft}) {
    const dental::CrownDistances& one = arch.fit.sextants[std::size_t(sextant)];
    text += one.points > 0 ? fmt::format("\n    {:<8} RMS {:.2f} mm, P95 {:.2f} mm over {:.0f} %",
                                         dental::name_of(sextant), one.rms_mm, one.p95_mm,
                                         100.0 * one.fraction)
                           : fmt::format("\n    {:<8} no counterpart", dental::name_of(sextant));
  }
  if (arch.fit.is_reversed) text += "\n    its triangles were clockwise and were turned";
  return text;
}

Result<RegisteredArch> register_one(const fs::path& file, const dental::Crowns& crowns,
                                    const dental::Crowns* other, Progress& progress) {
  LEFORT_TRY(geometry::TriangleMesh scan, io::read_surface(file, progress));
  auto fit = dental::register_arch(scan, crowns, other, progress);
  if (!fit)
    return fail(fit.error().code, fmt::format("{}: {}", file.string(), fit.error().message));
  if (fit->is_reversed)
    for (geometry::Triangle& triangle : scan.triangles) std::swap(triangle[1], triangle[2]);
  geometry::TriangleMesh scan_L = geometry::transformed(std::move(scan), fit->X_L_scan);
  return RegisteredArch{crowns, *std::move(fit), std::move(scan_L)};
}

Result<void> write_arch(const fs::path& folder, const RegisteredArch& arch) {
  const std::string name = dental::name_of(arch.crowns.jaw);
  LEFORT_TRY_VOID(io::write_surface(folder / (name + ".stl"), arch.scan_L));
  LEFORT_TRY_VOID(io::write_transform(folder / (name + ".tfm"), arch.fit.X_L_scan));
  return io::write_surface(folder / (name + "_crowns.vtp"), arch.crowns.surface_L,
                           {{"distance_mm", arch.fit.distances_mm}});
}

/// Crowns of both jaws; a jaw without a scan may have none.
Result<std::array<std::optional<dental::Crowns>, 2>> crowns_of(const RegisterArchesJob& job,
                                                               Progress& progress) {
  io::PlanFile options;
  options.labels = job.labels;
  LEFORT_TRY(const ScannedLabels head, scan_labels(options, job.ct, nullptr, progress));
  const anatomy::ToothMap teeth =
      anatomy::find_teeth(head.scan.ct, head.labels, head.levels.bone_hu);
  std::array<std::optional<dental::Crowns>, 2> crowns;
  for (const auto& [tooth, scan] :
       {std::pair{Tooth::kUpper, &job.upper}, {Tooth::kLower, &job.lower}}) {
    auto found = dental::find_crowns(head.scan.ct, teeth, tooth, progress);
    if (!found && *scan) return tl::unexpected(std::move(found).error());
    if (found) crowns[tooth == Tooth::kUpper ? 0 : 1] = *std::move(found);
  }
  return crowns;
}

}  // namespace

Result<Summary> register_arches(const RegisterArchesJob& job, Progress& progress) {
  if (!job.upper && !job.lower)
    return fail(ErrorCode::kInvalidArgument, "no intraoral scan: give --upper, --lower or both");
  LEFORT_TRY(const auto crowns, crowns_of(job, progress));
  std::vector<RegisteredArch> arches;
  for (const auto& [scan, own] : {std::pair{&job.upper, 0}, {&job.lower, 1}}) {
    if (!*scan) continue;
    const auto& other = crowns[std::size_t(1 - own)];
    LEFORT_TRY(RegisteredArch arch, register_one(**scan, *crowns[std::size_t(own)],
                                                 other ? &*other : nullptr, progress));
    arches.push_back(std::move(arch));
  }
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  Summary summary{job.output.string() + ":",
                  {{"lefort_arches", 1}, {"notice", kNotForClinicalUse}}};
  for (const RegisteredArch& arch : arches) {
    LEFORT_TRY_VOID(write_arch(job.output, arch));
    summary.text += arch_text(arch);
    summary.json[dental::name_of(arch.crowns.jaw)] = arch_json(arch);
  }
  LEFORT_TRY_VOID(io::write_text(job.output / "arches.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
