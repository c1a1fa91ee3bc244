#include <lefort/app/commands/path_kind.h>

#include <algorithm>
#include <array>
#include <string>

namespace lefort::app {
namespace {

constexpr std::string_view kSurfaces = ".vtp,.stl,.ply,.obj";

constexpr std::array kTraits{
    PathTraits{PathKind::kScan, "path:scan", "SCAN", ".nrrd,.nhdr,.nii.gz,.nii,.mha,.mhd,.inv3",
               PathForm::kVolume, false},
    PathTraits{PathKind::kScanSource, "path:scan-source", "SOURCE",
               ".inv3,.nrrd,.nhdr,.nii.gz,.nii,.mha,.mhd", PathForm::kFile, false},
    PathTraits{PathKind::kSurface, "path:surface", "SURFACE", kSurfaces, PathForm::kFile, false},
    PathTraits{PathKind::kFace, "path:face", "FACE", kSurfaces, PathForm::kFile, false},
    PathTraits{PathKind::kLandmarks, "path:landmarks", "LANDMARKS", ".mrk.json,.csv",
               PathForm::kFile, false},
    PathTraits{PathKind::kLabels, "path:labels", "LABELS", ".seg.nrrd", PathForm::kFile, false},
    PathTraits{PathKind::kPlan, "path:plan", "PLAN", ".json", PathForm::kFile, false},
    PathTraits{PathKind::kDeck, "path:deck", "DECK", ".json", PathForm::kFile, false},
    PathTraits{PathKind::kTarget, "path:target", "TARGET", ".json", PathForm::kFile, false},
    PathTraits{PathKind::kInputs, "path:inputs", "INPUTS", ".json", PathForm::kFile, false},
    PathTraits{PathKind::kParameters, "path:parameters", "PARAMETERS", ".json,.csv",
               PathForm::kFile, false},
    PathTraits{PathKind::kField, "path:field", "FIELD", ".field", PathForm::kFile, false},
    PathTraits{PathKind::kPoints, "path:points", "POINTS", ".csv,.txt", PathForm::kFile, false},
    PathTraits{PathKind::kFolder, "path:folder", "FOLDER", "", PathForm::kFolder, false},
    PathTraits{PathKind::kNewVolume, "path:new-volume", "VOLUME", ".nrrd,.nii.gz,.mha",
               PathForm::kVolume, true},
    PathTraits{PathKind::kNewField, "path:new-field", "FIELD", ".field", PathForm::kFile, true},
    PathTraits{PathKind::kNewTable, "path:new-table", "TABLE", ".csv", PathForm::kFile, true},
    PathTraits{PathKind::kNewPicture, "path:new-picture", "PICTURE", ".png", PathForm::kFile, true},
    PathTraits{PathKind::kNewExport, "path:new-export", "FILE", ".vdb,.nrrd", PathForm::kFile,
               true},
    PathTraits{PathKind::kNewLandmarks, "path:new-landmarks", "LANDMARKS", ".mrk.json,.csv",
               PathForm::kFile, true},
    PathTraits{PathKind::kNewFolder, "path:new-folder", "FOLDER", "", PathForm::kFolder, true},
};

}  // namespace

CLI::Option* mark_path(CLI::Option* option, PathKind kind) {
  const auto traits = std::ranges::find(kTraits, kind, &PathTraits::kind);
  // CLI11 keeps nothing of ours with an option but validators: one that accepts everything.
  const auto accept = [](std::string&) { return std::string(); };
  return option->type_name(std::string(traits->name))
      ->check(CLI::Validator(accept, "", std::string(traits->id)));
}

const PathTraits* path_traits(CLI::Option& option) {
  for (const PathTraits& traits : kTraits) {
    try {
      if (option.get_validator(std::string(traits.id)) != nullptr) return &traits;
    } catch (const CLI::OptionNotFound&) {
      continue;  // How CLI11 reports that a validator is absent.
    }
  }
  return nullptr;
}

}  // namespace lefort::app
