#include <lefort/pipeline/cache/stage_cache.h>

namespace lefort::pipeline {

namespace fs = std::filesystem;

Result<void> StageCache::store(const fs::path& path,
                               const std::function<Result<void>(const fs::path&)>& write) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!scratch_) {
    fs::remove(digest_file(path), error);
    LEFORT_TRY_VOID(write(path));
    return write_digest(path);
  }
  fs::create_directories(*scratch_, error);
  const fs::path made = *scratch_ / path.filename();
  Result<void> stored = write(made);
  if (stored) stored = publish(made, path);
  fs::remove(made, error);
  return stored;
}

}  // namespace lefort::pipeline
