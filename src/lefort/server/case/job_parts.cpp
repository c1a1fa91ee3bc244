#include <lefort/server/case/job_parts.h>

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
