#include <lefort/core/check.h>
#include <lefort/server/case/uploads.h>

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <system_error>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;

/// The file ending under which an upload is stored, for the formats that are read. Not .nhdr and
/// .mhd, which name other files.
std::optional<std::string> stored_ending(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  for (const char* ending : {".nii.gz", ".nii", ".seg.nrrd", ".nrrd", ".mha", ".inv3", ".dcm",
                             ".vtp", ".stl", ".ply", ".obj"})
    if (name.ends_with(ending)) return ending == std::string(".seg.nrrd") ? ".nrrd" : ending;
  for (const char* ending : {".nhdr", ".mhd", ".zip", ".tar", ".gz", ".json", ".txt", ".exe"})
    if (name.ends_with(ending)) return std::nullopt;
  return "";  // DICOM files have any ending, or none.
}

constexpr const char* kNotStored = "the file could not be stored; the disk may be full";

Response no_upload() { return error_response(404, "not_found", "no such upload"); }

struct Received {
  std::uint64_t bytes = 0;
  bool is_complete = false;  ///< As long as the request announced.
  bool is_written = false;
};

/// Writes the body of `request` to `path`.
Received receive(const fs::path& path, const Request& request) {
  std::ofstream file(path, std::ios::binary);
  Received received;
  const bool is_read = request.read_body && request.read_body([&](std::string_view piece) {
    received.bytes += piece.size();
    if (received.bytes > request.content_length) return false;
    file.write(piece.data(), std::streamsize(piece.size()));
    return bool(file);
  });
  file.close();
  received.is_complete = is_read && received.bytes == request.content_length;
  received.is_written = bool(file);
  return received;
}

}  // namespace

std::string random_hex(std::size_t digits) {
  std::vector<unsigned char> bytes((digits + 1) / 2);
  for (std::size_t filled = 0; filled < bytes.size();) {
    const ssize_t count = ::getrandom(bytes.data() + filled, bytes.size() - filled, 0);
    LEFORT_CHECK(count > 0);
    filled += std::size_t(count);
  }
  std::string hex;
  for (const unsigned char byte : bytes) hex += fmt::format("{:02x}", byte);
  hex.resize(digits);
  return hex;
}

Uploads::Uploads(fs::path folder, UploadLimits limits)
    : folder_(std::move(folder)), limits_(limits) {}

Response Uploads::begin() {
  const std::scoped_lock lock(mutex_);
  const auto is_kept = [](const auto& upload) { return !upload.second.is_removed; };
  while (std::count_if(uploads_.begin(), uploads_.end(), is_kept) >= limits_.uploads)
    drop(std::min_element(uploads_.begin(), uploads_.end(), [&](const auto& a, const auto& b) {
           return std::pair(!is_kept(a), a.second.order) < std::pair(!is_kept(b), b.second.order);
         })->first);
  const std::string id = random_hex(16);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!error) fs::permissions(folder_, fs::perms::owner_all, error);  // Patient data.
  if (!error) fs::create_directory(folder_ / id, error);
  if (error)
    return error_response(507, "unavailable",
                          "cannot write to the case folder: " + error.message());
  uploads_[id].order = ++begun_;
  return json_response({{"id", id}}, 201);
}

std::optional<Response> Uploads::check_file(int index, const Request& request) const {
  if (index < 0 || index >= limits_.files)
    return error_response(413, "too_large",
                          fmt::format("an upload has at most {} files", limits_.files), "index");
  if (request.content_length > limits_.file_bytes)
    return error_response(413, "too_large",
                          fmt::format("a file has at most {} bytes", limits_.file_bytes));
  return std::nullopt;
}

std::optional<Response> Uploads::reserve(const std::string& id, const Request& request) {
  const std::scoped_lock lock(mutex_);
  const auto upload = uploads_.find(id);
  if (upload == uploads_.end() || upload->second.is_removed) return no_upload();
  if (bytes() + reserved_ + request.content_length > limits_.all_bytes)
    return error_response(
        413, "too_large",
        fmt::format("all uploads together have at most {} bytes", limits_.all_bytes));
  reserved_ += request.content_length;
  return std::nullopt;
}

Response Uploads::put(const std::string& id, int index, const std::string& name,
                      const Request& request) {
  const auto ending = stored_ending(name);
  if (!ending)
    return error_response(
        422, "invalid",
        "files of this kind are not read; send DICOM files, .nii, .nii.gz, .nrrd, .mha "
        "or .inv3",
        "name");
  if (auto error = check_file(index, request)) return *std::move(error);
  if (auto error = reserve(id, request)) return *std::move(error);
  // Outside the upload's folder: a job that reads that folder finds complete files only.
  const fs::path temporary = folder_ / ("part-" + random_hex(16));
  struct Reservation {  // Released on every return.
    ~Reservation() {
      std::error_code error;
      fs::remove(file, error);
      const std::scoped_lock lock(mutex);
      reserved -= bytes;
    }
    const fs::path& file;
    std::mutex& mutex;
    std::uint64_t& reserved;
    std::uint64_t bytes;
  };
  const Reservation reservation{temporary, mutex_, reserved_, request.content_length};
  const Received received = receive(temporary, request);
  if (!received.is_written) return error_response(507, "unavailable", kNotStored);
  if (!received.is_complete)
    return error_response(400, "bad_request", "the request body is incomplete");
  return store(id, index, fmt::format("f{:05d}{}", index, *ending), temporary, received.bytes);
}

Response Uploads::store(const std::string& id, int index, const std::string& name,
                        const fs::path& temporary, std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  std::error_code error;
  const auto upload = uploads_.find(id);
  if (upload == uploads_.end() || upload->second.is_removed)
    return error_response(400, "bad_request", "the upload was removed meanwhile");
  if (upload->second.readers > 0)
    return error_response(422, "invalid", "a job is reading this upload: start another one");
  if (const auto older = upload->second.files.find(index); older != upload->second.files.end())
    fs::remove(folder_ / id / older->second.first, error);
  fs::rename(temporary, folder_ / id / name, error);
  if (error) return error_response(507, "unavailable", kNotStored);
  upload->second.files[index] = {name, bytes};
  return json_response({{"index", index}, {"bytes", bytes}}, 201);
}

Response Uploads::remove(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  const auto upload = uploads_.find(id);
  if (upload == uploads_.end() || upload->second.is_removed) return no_upload();
  drop(id);
  Response reply;
  reply.status = 204;
  return reply;
}

std::optional<Uploads::Source> Uploads::source(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  const auto upload = uploads_.find(id);
  if (upload == uploads_.end() || upload->second.is_removed || upload->second.files.empty())
    return std::nullopt;
  ++upload->second.readers;
  const auto& files = upload->second.files;
  const std::string& first = files.begin()->second.first;
  const bool is_dicom = first.find('.') == std::string::npos || first.ends_with(".dcm");
  return std::optional<Source>(
      std::in_place, *this, id,
      files.size() == 1 && !is_dicom ? folder_ / id / first : folder_ / id);
}

void Uploads::release(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  Upload& upload = uploads_.at(id);
  if (--upload.readers == 0 && upload.is_removed) drop(id);
}

void Uploads::drop(const std::string& id) {
  Upload& upload = uploads_.at(id);
  upload.is_removed = true;
  if (upload.readers > 0) return;
  std::error_code error;
  fs::remove_all(folder_ / id, error);
  uploads_.erase(id);
}

std::uint64_t Uploads::bytes() const {
  std::uint64_t sum = 0;
  for (const auto& [id, upload] : uploads_)
    for (const auto& [index, file] : upload.files) sum += file.second;
  return sum;
}

}  // namespace lefort::server
