#include <lefort/core/check.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/server/case/measure_stages.h>

#include <algorithm>
#include <string>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;

/// Folder of a stage in that of the case, and its document.
struct Measure {
  std::string_view stage;
  const char* folder;
  const char* document;
};

constexpr Measure kMeasures[] = {
    {"teeth", "teeth", "teeth.json"},
    {"arches", "arches", "arches.json"},
    {"occlusion", "occlusion", "occlusion.json"},
    {"splint_final", "splint_final", "splint.json"},
    {"splint_intermediate", "splint_intermediate", "splint.json"},
    {"nerve", "nerve", "nerve.json"},
    {"guides", "guides", "guides.json"},
    {"airway", "airway", "airway.json"},
    {"cephalogram", "cephalogram", "cephalogram.json"},
};

const Measure* find_measure(std::string_view stage) {
  const auto* const found = std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                         [&](const Measure& one) { return one.stage == stage; });
  return found == std::end(kMeasures) ? nullptr : found;
}

std::string print_of(const CaseFolder& folder, const std::optional<fs::path>& file) {
  return file ? folder.fingerprint(*file).value_or("") : "";
}

/// Empty if the stage is not fresh.
std::string print_if_fresh(const CaseFolder& folder, const char* stage, const fs::path& file) {
  return folder.stage(stage)["state"] == "fresh" ? print_of(folder, file) : "";
}

/// Of the registered scans; nothing if not both are there.
std::optional<std::string> print_of_arches(const CaseFolder& folder) {
  io::Sha256 sum;
  for (const fs::path& file : {folder.arches() / "upper.stl", folder.arches() / "lower.stl"}) {
    const auto sha256 = folder.fingerprint(file);
    if (!sha256) return std::nullopt;
    sum.add(*sha256);
  }
  const std::string document = print_if_fresh(folder, "arches", folder.arches() / "arches.json");
  return document.empty() ? document : sum.add(document).hex();
}

/// The plan, and those of its files that decide how bones are cut; nothing without a valid plan.
std::optional<CaseFolder::Inputs> inputs_of_cuts(const CaseFolder& folder) {
  const auto text = io::read_text(folder.plan(), kMaxDocument);
  if (!text || !check_files_of_plan(*text)) return std::nullopt;
  CaseFolder::Inputs inputs{{"plan", io::Sha256().add(*text).hex()}};
  for (const std::string& name : io::files_of_plan(*text))
    if (name != kBoundaryFile && name != kNerveFile)  // Guides depend on the canals anyway.
      inputs[name == folder.landmarks().filename() ? "landmarks" : "tissues"] =
          print_of(folder, folder.root() / name);
  return inputs;
}

/// The file, if it is there and was made on the present scan.
std::optional<fs::path> if_of_scan(const CaseFolder& folder, const char* name,
                                   const fs::path& file) {
  if (!there_is(file) || !folder.is_of_scan(name)) return std::nullopt;
  return file;
}

}  // namespace

bool is_measure(std::string_view stage) { return find_measure(stage) != nullptr; }

fs::path folder_of_measure(const CaseFolder& folder, std::string_view stage) {
  const Measure* const measure = find_measure(stage);
  LEFORT_CHECK(measure != nullptr);
  return folder.root() / measure->folder;
}

fs::path document_of_measure(const CaseFolder& folder, std::string_view stage) {
  const Measure* const measure = find_measure(stage);
  LEFORT_CHECK(measure != nullptr);
  return folder.root() / measure->folder / measure->document;
}

std::optional<CaseFolder::Inputs> inputs_of_measure(const CaseFolder& folder,
                                                    std::string_view stage) {
  CaseFolder::Inputs inputs;
  if (stage == "occlusion" || stage.starts_with("splint_")) {
    const auto arches = print_of_arches(folder);
    if (!arches) return std::nullopt;
    inputs["arches"] = *arches;
    if (stage == "occlusion")
      inputs["teeth"] = print_if_fresh(folder, "teeth", folder.teeth() / "teeth.json");
    if (stage == "splint_final")
      inputs["occlusion"] = print_if_fresh(folder, "occlusion", folder.occlusion() / "lower.stl");
    if (stage == "splint_intermediate")
      inputs["check"] = print_if_fresh(folder, "check", folder.check() / "check.json");
    return inputs;
  }
  if (stage == "guides") {
    auto cuts = inputs_of_cuts(folder);
    if (!cuts) return std::nullopt;
    cuts->emplace("nerve", print_if_fresh(folder, "nerve", folder.nerve() / "nerve.json"));
    cuts->emplace("numbers", print_of(folder, tooth_corrections(folder)));
    return cuts;
  }
  inputs["tissues"] = print_of(folder, labels_of_scan(folder));
  if (stage == "arches") return inputs;
  inputs["landmarks"] = print_of(folder, folder.landmarks());
  if (stage == "teeth") inputs["numbers"] = print_of(folder, tooth_corrections(folder));
  if (stage == "nerve") inputs["points"] = print_of(folder, nerve_points(folder));
  if (stage == "airway")
    inputs["prediction"] =
        print_if_fresh(folder, "prediction", folder.prediction() / "prediction.json");
  if (stage == "cephalogram") {
    inputs["check"] = print_if_fresh(folder, "check", folder.check() / "check.json");
    inputs["prediction"] =
        print_if_fresh(folder, "prediction", folder.prediction() / "prediction.json");
  }
  return inputs;
}

std::optional<fs::path> labels_of_scan(const CaseFolder& folder) {
  return if_of_scan(folder, "anatomy", folder.labels());
}

std::optional<fs::path> tooth_corrections(const CaseFolder& folder) {
  return if_of_scan(folder, kToothCorrections, folder.tooth_corrections());
}

std::optional<fs::path> nerve_points(const CaseFolder& folder) {
  return if_of_scan(folder, kNervePoints, folder.nerve_points());
}

}  // namespace lefort::server
