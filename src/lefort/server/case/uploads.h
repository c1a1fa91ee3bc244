/// \file
/// Files sent by a page, stored until a job reads them.
#pragma once

#include <lefort/server/api/message.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace lefort::server {

/// Limits of uploads.
struct UploadLimits {
  std::uint64_t file_bytes = std::uint64_t(2) << 30;
  std::uint64_t all_bytes = std::uint64_t(4) << 30;  ///< Of all uploads together.
  int files = 10000;                                 ///< Of one upload; no scan has more slices.
  int uploads = 4;                                   ///< At a time; another one removes the oldest.
};

/// Uploaded files, stored in a folder under generated names: of the original names, which may
/// contain the name of a patient, only the file ending is kept. Thread-safe.
class Uploads {
 public:
  explicit Uploads(std::filesystem::path folder, UploadLimits limits = {});

  /// Starts an upload. \returns 201 with its id.
  [[nodiscard]] Response begin();

  /// Stores the body of `request` as a file. \returns 201, or the error.
  [[nodiscard]] Response put(const std::string& id, int index, const std::string& name,
                             const Request& request);

  /// \returns 204, or 404.
  [[nodiscard]] Response remove(const std::string& id);

  /// The input of a job. While it exists its files are neither removed nor replaced: a folder
  /// without its last slices would be a shorter scan.
  class Source {
   public:
    Source(Uploads& uploads, std::string id, std::filesystem::path path)
        : uploads_(&uploads), id_(std::move(id)), path_(std::move(path)) {}
    Source(Source&& other) noexcept { *this = std::move(other); }
    Source& operator=(Source&& other) noexcept {
      std::swap(uploads_, other.uploads_);
      std::swap(id_, other.id_);
      std::swap(path_, other.path_);
      return *this;
    }
    ~Source() {
      if (uploads_ != nullptr) uploads_->release(id_);
    }
    /// The single file, or the folder of DICOM files.
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

   private:
    Uploads* uploads_ = nullptr;
    std::string id_;
    std::filesystem::path path_;
  };
  /// \returns nothing if there is no such upload or it is empty.
  [[nodiscard]] std::optional<Source> source(const std::string& id);

  [[nodiscard]] const UploadLimits& limits() const { return limits_; }

 private:
  struct Upload {
    std::uint64_t order = 0;
    std::map<int, std::pair<std::string, std::uint64_t>> files;  ///< Name and bytes.
    int readers = 0;                                             ///< Number of its Source objects.
    bool is_removed = false;                                     ///< As soon as it has no reader.
  };
  [[nodiscard]] std::optional<Response> check_file(int index, const Request& request) const;
  /// Reserves the length of the body, or returns the error.
  [[nodiscard]] std::optional<Response> reserve(const std::string& id, const Request& request);
  /// Moves a received file into the folder of its upload.
  [[nodiscard]] Response store(const std::string& id, int index, const std::string& name,
                               const std::filesystem::path& temporary, std::uint64_t bytes);
  /// Removes an upload, at the latest when its last reader ends.
  void drop(const std::string& id);
  void release(const std::string& id);
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
