#include <lefort/pipeline/prepare/interface_surface.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/measure_stages.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;

/// The interface map of the tissue mesh of the present plan; empty if there is none.
fs::path interface_surface(const CaseFolder& folder) {
  const auto stage = fresh_tissue_stage(folder);
  return stage ? folder.root() / *stage / pipeline::kInterfaceFile : fs::path();
}

#define LEFORT_IN(folder, file) [](const CaseFolder& c) -> fs::path { return c.folder() / (file); }
#define LEFORT_SPLINT(stage, file) \
  [](const CaseFolder& c) -> fs::path { return folder_of_measure(c, stage) / (file); }
const NamedFile kFiles[] = {
    {"ct.nrrd", "scan", [](const CaseFolder& c) { return c.ct(); }},
    {"labels.seg.nrrd", "anatomy", [](const CaseFolder& c) { return c.labels(); }},
    {"skull.vtp", "anatomy", LEFORT_IN(anatomy, "skull.vtp")},
    {"skin.vtp", "anatomy", LEFORT_IN(anatomy, "skin.vtp")},
    {"landmarks.mrk.json", "landmarks", [](const CaseFolder& c) { return c.landmarks(); }},
    {"plan.json", "plan", [](const CaseFolder& c) { return c.plan(); }},
    {kBoundaryFile, "boundary", [](const CaseFolder& c) { return c.boundary(); }},
    {"check.json", "check", LEFORT_IN(check, "check.json")},
    {"cephalometry.csv", "check", LEFORT_IN(check, "cephalometry.csv")},
    {"planned_movements.csv", "check", LEFORT_IN(check, "planned_movements.csv")},
    {"worksheet.pdf", "check", LEFORT_IN(check, "worksheet.pdf")},
    {"landmarks_after.mrk.json", "check", LEFORT_IN(check, "landmarks_after.mrk.json")},
    {"landmarks_after.csv", "check", LEFORT_IN(check, "landmarks_after.csv")},
    {"report.html", "prediction", LEFORT_IN(prediction, "report.html")},
    {"prediction.json", "prediction", LEFORT_IN(prediction, "prediction.json")},
    {"failure.json", "prediction", LEFORT_IN(prediction, "failure.json")},
    {"predicted_skin.vtp", "prediction", LEFORT_IN(prediction, "predicted_skin.vtp")},
    {"predicted_skin.stl", "prediction", LEFORT_IN(prediction, "predicted_skin.stl")},
    {"skin_before.vtp", "prediction", LEFORT_IN(prediction, "skin_before.vtp")},
    {"bone_remainder.vtp", "prediction", LEFORT_IN(prediction, "bone_remainder.vtp")},
    {"interface.vtp", "prediction", LEFORT_IN(prediction, pipeline::kInterfaceFile)},
    {"bone_segment_moved.vtp", "prediction", LEFORT_IN(prediction, "bone_segment_moved.vtp")},
    {"bone_overlap.vtp", "prediction", LEFORT_IN(prediction, "bone_overlap.vtp")},
    {"compare.json", "comparison", LEFORT_IN(comparison, "compare.json")},
    {"regions.csv", "comparison", LEFORT_IN(comparison, "regions.csv")},
    {"landmark_shifts.csv", "comparison", LEFORT_IN(comparison, "landmark_shifts.csv")},
    {"difference.vtp", "comparison", LEFORT_IN(comparison, "difference.vtp")},
    {"movements.csv", "comparison", LEFORT_IN(comparison, "movements.csv")},
    {"skin_after.vtp", "comparison", LEFORT_IN(comparison, "skin_after.vtp")},
    {"uncertainty_report.html", "uncertainty", LEFORT_IN(uncertainty, "report.html")},
    {"uncertainty.json", "uncertainty", LEFORT_IN(uncertainty, "uncertainty.json")},
    {"uncertainty.vtp", "uncertainty", LEFORT_IN(uncertainty, "uncertainty.vtp")},
    {"samples.csv", "uncertainty", LEFORT_IN(uncertainty, "samples.csv")},
    {"uncertain_inputs.json", "uncertainty", LEFORT_IN(uncertainty, "inputs.json")},
    {"teeth_numbered.seg.nrrd", "teeth", LEFORT_IN(teeth, "teeth_numbered.seg.nrrd")},
    {"teeth.csv", "teeth", LEFORT_IN(teeth, "teeth.csv")},
    {"teeth.json", "teeth", LEFORT_IN(teeth, "teeth.json")},
    {"teeth.mrk.json", "teeth", LEFORT_IN(teeth, "teeth.mrk.json")},
    {"arches.json", "arches", LEFORT_IN(arches, "arches.json")},
    {"upper.stl", "arches", LEFORT_IN(arches, "upper.stl")},
    {"upper.tfm", "arches", LEFORT_IN(arches, "upper.tfm")},
    {"upper_crowns.vtp", "arches", LEFORT_IN(arches, "upper_crowns.vtp")},
    {"lower.stl", "arches", LEFORT_IN(arches, "lower.stl")},
    {"lower.tfm", "arches", LEFORT_IN(arches, "lower.tfm")},
    {"lower_crowns.vtp", "arches", LEFORT_IN(arches, "lower_crowns.vtp")},
    {"occlusion.json", "occlusion", LEFORT_IN(occlusion, "occlusion.json")},
    {"lower_in_occlusion.stl", "occlusion", LEFORT_IN(occlusion, "lower.stl")},
    {"lower_to_occlusion.tfm", "occlusion", LEFORT_IN(occlusion, "lower_to_occlusion.tfm")},
    {"lower_contacts.vtp", "occlusion", LEFORT_IN(occlusion, "lower_contacts.vtp")},
    {"splint_final.stl", "splint_final", LEFORT_SPLINT("splint_final", "splint.stl")},
    {"splint_final.3mf", "splint_final", LEFORT_SPLINT("splint_final", "splint.3mf")},
    {"splint_final.json", "splint_final", LEFORT_SPLINT("splint_final", "splint.json")},
    {"splint_intermediate.stl", "splint_intermediate",
     LEFORT_SPLINT("splint_intermediate", "splint.stl")},
    {"splint_intermediate.3mf", "splint_intermediate",
     LEFORT_SPLINT("splint_intermediate", "splint.3mf")},
    {"splint_intermediate.json", "splint_intermediate",
     LEFORT_SPLINT("splint_intermediate", "splint.json")},
    {"nerve.json", "nerve", LEFORT_IN(nerve, "nerve.json")},
    {"nerve.mrk.json", "nerve", LEFORT_IN(nerve, "nerve.mrk.json")},
    {"nerve_right.vtp", "nerve", LEFORT_IN(nerve, "nerve_right.vtp")},
    {"nerve_left.vtp", "nerve", LEFORT_IN(nerve, "nerve_left.vtp")},
    {"airway.json", "airway", LEFORT_IN(airway, "airway.json")},
    {"airway.csv", "airway", LEFORT_IN(airway, "airway.csv")},
    {"airway.svg", "airway", LEFORT_IN(airway, "airway.svg")},
    {"airway.vtp", "airway", LEFORT_IN(airway, "airway.vtp")},
    {"airway_after.csv", "airway", LEFORT_IN(airway, "airway_after.csv")},
    {"airway_after.svg", "airway", LEFORT_IN(airway, "airway_after.svg")},
    {"guides.json", "guides", LEFORT_IN(guides, "guides.json")},
    {"holes_before.mrk.json", "guides", LEFORT_IN(guides, "holes_before.mrk.json")},
    {"holes_after.mrk.json", "guides", LEFORT_IN(guides, "holes_after.mrk.json")},
    {"cephalogram.json", "cephalogram", LEFORT_IN(cephalogram, "cephalogram.json")},
    {"cephalometry.pdf", "cephalogram", LEFORT_IN(cephalogram, "cephalometry.pdf")},
    {"lateral.png", "cephalogram", LEFORT_IN(cephalogram, "lateral.png")},
    {"frontal.png", "cephalogram", LEFORT_IN(cephalogram, "frontal.png")},
    {"tracing.png", "cephalogram", LEFORT_IN(cephalogram, "tracing.png")},
    {"measurements.csv", "cephalogram", LEFORT_IN(cephalogram, "measurements.csv")},
    {"norms.csv", "cephalogram", LEFORT_IN(cephalogram, "norms.csv")},
    {"variants.html", "variants", LEFORT_IN(side_by_side, "variants.html")},
    {"variants.pdf", "variants", LEFORT_IN(side_by_side, "variants.pdf")},
    {"variants.csv", "variants", LEFORT_IN(side_by_side, "variants.csv")},
    {"variants.json", "variants", LEFORT_IN(side_by_side, "variants.json")}};

const NamedFile kSurfaces[] = {
    {"skin", "anatomy", LEFORT_IN(anatomy, "skin.vtp")},
    {"skull", "anatomy", LEFORT_IN(anatomy, "skull.vtp")},
    {"remainder", "cut", LEFORT_IN(cut, "remainder.vtp")},
    {kInterfaceSurface, "preview", interface_surface},
    {"skin_before", "prediction", LEFORT_IN(prediction, "skin_before.vtp")},
    {"predicted", "prediction", LEFORT_IN(prediction, "predicted_skin.vtp")},
    {"after_surgery", "comparison", LEFORT_IN(comparison, "skin_after.vtp")},
    {kBandSurface, "uncertainty", LEFORT_IN(uncertainty, "uncertainty.vtp")},
    {"upper_arch", "arches", LEFORT_IN(arches, "upper.stl")},
    {"lower_arch", "arches", LEFORT_IN(arches, "lower.stl")},
    {kOcclusionSurface, "occlusion", LEFORT_IN(occlusion, "lower_contacts.vtp")},
    {"splint_final", "splint_final", LEFORT_SPLINT("splint_final", "splint.stl")},
    {"splint_intermediate", "splint_intermediate",
     LEFORT_SPLINT("splint_intermediate", "splint.stl")},
    {"nerve_right", "nerve", LEFORT_IN(nerve, "nerve_right.vtp")},
    {"nerve_left", "nerve", LEFORT_IN(nerve, "nerve_left.vtp")},
    {"airway", "airway", LEFORT_IN(airway, "airway.vtp")}};
#undef LEFORT_SPLINT
#undef LEFORT_IN

}  // namespace

std::optional<std::string_view> fresh_tissue_stage(const CaseFolder& folder) {
  for (const char* stage : {"preview", "prediction"})
    if (folder.stage(stage)["state"] == "fresh") return stage;
  return std::nullopt;
}

std::span<const NamedFile> file_catalog() { return kFiles; }

std::span<const NamedFile> surface_catalog() { return kSurfaces; }

bool is_segment_name(std::string_view name) {
  return !name.empty() && name.size() <= 40 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                  c == '_' || c == '-';
         });
}

std::optional<fs::path> segment_result(const CaseFolder& folder, std::string_view name) {
  constexpr std::string_view kEnding = ".vtp";
  for (const std::string_view beginning : {"bone_segment_moved_", "bone_overlap_"})
    if (name.starts_with(beginning) && name.ends_with(kEnding) &&
        is_segment_name(
            name.substr(beginning.size(), name.size() - beginning.size() - kEnding.size())))
      return folder.prediction() / name;
  return std::nullopt;
}

bool is_guide_name(std::string_view name) {
  constexpr std::size_t kMaxDigits = 3;
  // The number of a second guide of a side, after the last underscore.
  if (const std::size_t at = name.find_last_not_of("0123456789"); at != std::string_view::npos) {
    const std::string_view digits = name.substr(at + 1);
    if (!digits.empty()) {
      if (name[at] != '_' || digits.front() == '0' || digits.size() > kMaxDigits) return false;
      name = name.substr(0, at);
    }
  }
  for (const std::string_view side : {"_right", "_left", "_middle"})
    if (name.ends_with(side)) return is_segment_name(name.substr(0, name.size() - side.size()));
  return false;
}

std::optional<fs::path> guide_result(const CaseFolder& folder, std::string_view name) {
  constexpr std::string_view kBeginning = "guide_", kEnding = ".stl";
  if (!name.starts_with(kBeginning) || !name.ends_with(kEnding) ||
      name.size() < kBeginning.size() + kEnding.size())
    return std::nullopt;
  name.remove_prefix(kBeginning.size());
  name.remove_suffix(kEnding.size());
  if (!is_guide_name(name)) return std::nullopt;
  return folder.guides() / fmt::format("guide_{}.stl", name);
}

const NamedFile* find_named(std::span<const NamedFile> files, std::string_view name) {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const auto& file) { return file.name == name; });
  return found == files.end() ? nullptr : &*found;
}

}  // namespace lefort::server
