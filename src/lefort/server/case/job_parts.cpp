#include <lefort/io/read_text.h>
#include <lefort/server/case/job_parts.h>

#include <fmt/format.h>

#include <string_view>

namespace lefort::server {

JobOutcome reported(const pipeline::Summary& summary) {
  JobOutcome outcome{summary.text, summary.json};
  outcome.result.erase("output");
  return outcome;
}

Result<void> check_scan(const CaseFolder& folder) {
  if (there_is(folder.ct())) return {};
  return fail(ErrorCode::kFileNotFound, "the case has no scan: import one first");
}

Result<void> check_plan(const CaseFolder& folder) {
  LEFORT_TRY_VOID(check_scan(folder));
  const auto text = io::read_text(folder.plan(), 64 << 20);
  if (!text) return fail(ErrorCode::kFileNotFound, "the case has no plan");
  return check_files_of_plan(*text);
}

void note_other_scans(const CaseFolder& folder, Progress& progress) {
  for (const char* input : {"landmarks", "plan", "boundary"})
    if (folder.stage(input)["state"] == "stale")
      progress.note(fmt::format("warning: the {} of this case were made on another scan",
                                std::string_view(input) == "boundary"
                                    ? "painted boundary conditions"
                                : std::string_view(input) == "plan" ? "movements of the plan"
                                                                    : "landmarks"));
  const auto text = io::read_text(folder.plan(), kMaxDocument);
  if (text && check_files_of_plan(*text) && names_canals(*text) &&
      folder.stage("nerve")["state"] != "fresh")
    progress.note(
        "warning: the plan keeps canals of the nerves free that are out of date: trace them again");
}

bool is_surface(const std::filesystem::path& upload) {
  for (const char* ending : {".vtp", ".stl", ".ply", ".obj"})
    if (upload.extension() == ending) return true;
  return false;
}

CaseFolder::Inputs inputs_read(CaseFolder::Inputs before,
                               const std::optional<CaseFolder::Inputs>& now) {
  for (auto& [name, sha256] : before) {
    const bool is_there = now && now->contains(name);
    if (!is_there || now->at(name) != sha256) sha256 = "changed";
  }
  return before;
}

}  // namespace lefort::server
