#include <lefort/anatomy/extract_surface.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/prepare/close_jaws.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/load_head.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::pipeline {

namespace fs = std::filesystem;

Result<plan::LandmarkSearch> find_head_landmarks(const image::CtVolume& ct,
                                                 const anatomy::LabelMap& labels,
                                                 const anatomy::LevelOptions& levels,
                                                 Progress& progress) {
  progress.begin_stage("extract surfaces");
  const auto bone_of = [&](anatomy::Bones bones) {
    return anatomy::extract_isosurface(
        anatomy::bone_level(ct, labels, anatomy::Cavities::kKeep, levels, bones), {}, progress);
  };
  LEFORT_TRY(const geometry::TriangleMesh skull_L, bone_of(anatomy::Bones::kSkull));
  std::optional<geometry::TriangleMesh> mandible_L;
  if (has_mandible(labels)) {
    LEFORT_TRY(mandible_L, bone_of(anatomy::Bones::kMandible));
  }
  LEFORT_TRY(const geometry::TriangleMesh skin_L,
             anatomy::extract_isosurface(anatomy::skin_level(ct, labels, levels), {}, progress));
  progress.begin_stage("find landmarks");
  return plan::find_landmarks({.skull_L = &skull_L,
                               .mandible_L = mandible_L ? &*mandible_L : nullptr,
                               .skin_L = &skin_L,
                               .voxel_mm = ct.grid.spacing_mm.maxCoeff()});
}

std::vector<std::string> remarks_of(const plan::LandmarkSearch& search) {
  std::vector<std::string> remarks;
  for (const plan::FoundLandmark& one : search.found)
    remarks.push_back(
        fmt::format("found automatically, standard uncertainty {:.1f} mm", one.uncertainty_mm));
  return remarks;
}

std::string describe(const plan::LandmarkSearch& search) {
  std::string text = fmt::format(
      "{} landmarks found automatically, with standard uncertainties in "
      "mm:",
      search.found.size());
  for (const plan::FoundLandmark& one : search.found)
    text += fmt::format(" {} {:.1f}", one.landmark.name, one.uncertainty_mm);
  if (search.missing.empty()) return text;
  text += "; not found:";
  for (const plan::MissingLandmark& one : search.missing)
    text += fmt::format(" {} ({})", one.name, one.reason);
  return text;
}

Result<io::PlanText> read_plan_of_scan(const fs::path& file, const std::optional<fs::path>& given,
                                       const StageCache& cache, Progress& progress) {
  LEFORT_TRY(std::optional<io::OpenPlan> open, io::read_open_plan(file));
  if (!open) return io::read_plan_text(file);
  LEFORT_TRY(const fs::path ct_path, io::scan_of(file, open->plan, given));
  LEFORT_TRY(const ScannedLabels head, scan_labels(open->plan, ct_path, &cache, progress));
  std::string text = std::move(open->json);
  if (open->needs_landmarks) {
    LEFORT_TRY(const plan::LandmarkSearch search,
               find_head_landmarks(head.scan.ct, head.labels, head.levels, progress));
    progress.note(describe(search));
    text = io::with_landmarks(text, search.landmarks());
  }
  LEFORT_TRY(text, close_jaws(file, std::move(text), head, progress));
  return io::parse_completed_plan(file, std::move(text));
}

}  // namespace lefort::pipeline
