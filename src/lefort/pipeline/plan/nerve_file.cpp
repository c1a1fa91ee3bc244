#include <lefort/pipeline/plan/nerve_file.h>

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
  return fail(
      ErrorCode::kInvalidArgument,
      "the canals of --nerve were found in another scan: run `lefort nerve` with the scan of "
      "the plan");
}

}  // namespace lefort::pipeline
