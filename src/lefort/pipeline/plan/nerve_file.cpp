#include <lefort/pipeline/plan/nerve_file.h>

#include <nlohmann/json.hpp>

#include <string>

namespace lefort::pipeline {

Result<io::Nerves> read_given_nerves(const std::optional<std::filesystem::path>& file,
                                     Progress& progress) {
  if (!file) return io::Nerves();
  LEFORT_TRY(io::Nerves nerves, io::read_nerves(*file));
  for (const std::string& note : nerves.notes) progress.note(note);
  return nerves;
}

Result<void> check_same_scan(const io::Nerves& nerves, const std::string& ct_sha256) {
  if (nerves.ct_sha256.empty() || ct_sha256.empty() || nerves.ct_sha256 == ct_sha256) return {};
  return fail(ErrorCode::kInvalidArgument,
              "the canals were found in another scan: run `lefort nerve` with the scan of "
              "the plan");
}

Result<void> check_canals_of_plan(const std::string& plan_json, const std::filesystem::path& folder,
                                  const std::string& ct_sha256, Progress& progress) {
  const auto plan = nlohmann::json::parse(plan_json);
  for (const auto& segment : plan.at("segments")) {
    const auto cut = segment.find("osteotomy");
    if (cut == segment.end() || !cut->contains("template") || !(*cut)["template"].is_object() ||
        !(*cut)["template"].contains("nerve"))
      continue;
    const std::filesystem::path file = folder / (*cut)["template"]["nerve"].get<std::string>();
    LEFORT_TRY(const io::Nerves nerves, read_given_nerves(file, progress));
    LEFORT_TRY_VOID(check_same_scan(nerves, ct_sha256));
  }
  return {};
}

}  // namespace lefort::pipeline
