/// \file
/// Files that a page sends, until a job takes them.
#pragma once

#include <lefort/server/api/message.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace lefort::server {

/// What an upload may hold.
struct UploadLimits {
  std::uint64_t file_bytes = std::uint64_t(2) << 30;
  std::uint64_t all_bytes = std::uint64_t(4) << 30;  ///< Of all uploads together.
  int files = 10000;                                 ///< Of one upload; more slices no scan has.
  int uploads = 4;                                   ///< At a time; a further one ends the oldest.
};

/// Kept in a folder under names of our own: what files are called, perhaps after a patient, is
/// forgotten but for the ending. Safe from many threads.
class Uploads {
 public:
  explicit Uploads(std::filesystem::path folder, UploadLimits limits = {});

  /// 201 with its id.
  [[nodiscard]] Response begin();

  /// Takes the body of `request` as a file: 201, or why not.
  [[nodiscard]] Response put(const std::string& id, int index, const std::string& name,
                             const Request& request);

  /// 204, or 404.
  [[nodiscard]] Response remove(const std::string& id);

  /// What a job reads: the one file, or the folder of DICOM files. Nothing if there is no such
  /// upload, or nothing in it.
  [[nodiscard]] std::optional<std::filesystem::path> source(const std::string& id) const;

  [[nodiscard]] const UploadLimits& limits() const { return limits_; }

 private:
  struct Upload {
    std::uint64_t order = 0;
    std::map<int, std::pair<std::string, std::uint64_t>> files;  ///< Name and bytes.
  };
  [[nodiscard]] std::optional<Response> check_file(int index, const Request& request) const;
  /// Counts the body of `request` against the limit, or says why not.
  [[nodiscard]] std::optional<Response> reserve(const std::string& id, const Request& request);
  /// Moves a received file into the folder of its upload.
  [[nodiscard]] Response store(const std::string& id, int index, const std::string& name,
                               const std::filesystem::path& temporary, std::uint64_t bytes);
  void drop(const std::string& id);
  [[nodiscard]] std::uint64_t bytes() const;

  const std::filesystem::path folder_;
  const UploadLimits limits_;
  mutable std::mutex mutex_;
  std::map<std::string, Upload> uploads_;
  std::uint64_t begun_ = 0, reserved_ = 0;
};

/// Random bits from the system, as hexadecimal digits.
[[nodiscard]] std::string random_hex(std::size_t digits);

}  // namespace lefort::server
