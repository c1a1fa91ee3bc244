#include <lefort/io/dicomweb.h>
#include <lefort/io/internal/dicom_header.h>
#include <lefort/io/internal/http_get.h>
#include <lefort/io/internal/multipart.h>
#include <lefort/io/internal/private_folder.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

constexpr std::string_view kPlain = "dicomweb://";
constexpr std::string_view kEncrypted = "dicomwebs://";

/// The parts of an address.
struct StudyAddress {
  HttpServer server;
  std::string root;  ///< Empty, or begins with a slash.
  std::string study_uid;
  std::string series_uid;  ///< May be empty.
};

/// A series as the server describes it.
struct RemoteSeries {
  std::string uid;
  std::string modality;
  Index images = 0;  ///< Number that the server should send.
};

bool is_uid(std::string_view text) {
  return !text.empty() && text.size() <= 64 && text.find_first_not_of("0123456789.") == text.npos;
}

tl::unexpected<Error> bad_address(std::string_view why) {
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("the address {}, expected "
                          "dicomweb://[user:password@]host[:port]/service/studies/UID[/series/UID]",
                          why));
}

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t n = 0; n < text.size(); ++n) {
    if (text[n] != '%') {
      decoded.push_back(text[n]);
      continue;
    }
    unsigned char byte = 0;
    const std::string_view digits = text.substr(n + 1, 2);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (error != std::errc() || digits.size() != 2 || end != digits.data() + 2) return std::nullopt;
    decoded.push_back(static_cast<char>(byte));
    n += 2;
  }
  return decoded;
}

/// Parses host, host:port or [IPv6]:port.
Result<void> read_host(std::string_view text, HttpServer& server) {
  const std::size_t bracket = text.find(']');
  const std::size_t colon = text.find(':', bracket == text.npos ? 0 : bracket);
  server.host = text.substr(0, colon);
  const bool is_name = !server.host.empty() && server.host.find_first_not_of(
                                                   "abcdefghijklmnopqrstuvwxyz"
                                                   "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                   "0123456789.-_:[]") == text.npos;
  if (!is_name) return bad_address("has no host");
  if (colon == text.npos) return {};
  const std::string_view digits = text.substr(colon + 1);
  const auto [rest, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), server.port);
  if (error != std::errc() || rest != digits.data() + digits.size() || server.port < 1 ||
      server.port > 65535)
    return bad_address("has a port that is not a number from 1 to 65535");
  return {};
}

Result<StudyAddress> parse_address(std::string_view address, const Credentials& credentials) {
  StudyAddress study;
  study.server.is_encrypted = address.starts_with(kEncrypted);
  study.server.port = study.server.is_encrypted ? 443 : 80;
  study.server.user = credentials.user;
  study.server.password = credentials.password;
  std::string_view rest = address.substr((study.server.is_encrypted ? kEncrypted : kPlain).size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  std::string_view host = rest.substr(0, slash);
  std::string_view path = rest.substr(slash);
  if (const std::size_t at = host.rfind('@'); at != host.npos) {
    const std::string_view who = host.substr(0, at);
    const std::size_t colon = std::min(who.find(':'), who.size());
    const auto user = percent_decoded(who.substr(0, colon));
    const auto password = percent_decoded(who.substr(std::min(colon + 1, who.size())));
    if (!user || !password)
      return bad_address("has a user name or password with an invalid percent encoding");
    study.server.user = *user;
    study.server.password = *password;
    host.remove_prefix(at + 1);
  }
  LEFORT_TRY_VOID(read_host(host, study.server));

  while (path.ends_with('/')) path.remove_suffix(1);
  const std::size_t studies = path.find("/studies/");
  if (studies == path.npos) return bad_address("names no study");
  study.root = path.substr(0, studies);
  if (study.root.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                   "0123456789.-_~/%") != std::string::npos)
    return bad_address("has invalid characters before /studies");
  std::string_view uids = path.substr(studies + std::string_view("/studies/").size());
  const std::size_t series = uids.find("/series/");
  study.study_uid = uids.substr(0, series);
  if (series != uids.npos)
    study.series_uid = uids.substr(series + std::string_view("/series/").size());
  if (!is_uid(study.study_uid) || (series != uids.npos && !is_uid(study.series_uid)))
    return bad_address("has identifiers with other characters than digits and dots");
  return study;
}

/// Fetches a JSON array of at most `limits.list_bytes`.
Result<Json> fetch_json(const StudyAddress& study, const std::string& path, Progress& progress,
                        const DicomWebLimits& limits) {
  std::string text;
  HttpRequest request{.path = study.root + path, .accept = "application/dicom+json"};
  request.idle_timeout = limits.idle_timeout;
  request.total_timeout = limits.total_timeout;
  request.begin = [](const std::string&) -> Result<void> { return {}; };
  request.receive = [&](std::string_view bytes) -> Result<void> {
    if (text.size() + bytes.size() > limits.list_bytes)
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the server's list has more than {} bytes", limits.list_bytes));
    text += bytes;
    return {};
  };
  LEFORT_TRY_VOID(http_get(study.server, request, progress));
  if (text.empty()) return Json::array();
  // DICOM JSON nests five levels; far deeper nesting would exhaust the stack of recursive code.
  constexpr int kMaxJsonDepth = 64;
  bool is_deep = false;
  Json json = Json::parse(
      text,
      [&](int depth, Json::parse_event_t, const Json&) {
        is_deep |= depth > kMaxJsonDepth;
        return !is_deep;
      },
      false);
  if (is_deep || !json.is_array())
    return fail(ErrorCode::kFileUnsupported,
                "the server's answer is not a JSON array, expected DICOMweb");
  return json;
}

/// Returns the first value of a tag in a DICOM JSON object, or null if it has none.
Json first_value(const Json& object, const char* tag) {
  if (!object.is_object()) return {};
  const auto element = object.find(tag);
  if (element == object.end() || !element->is_object()) return {};
  const auto values = element->find("Value");
  if (values == element->end() || !values->is_array() || values->empty()) return {};
  return values->front();
}

std::string tag_text(const Json& object, const char* tag) {
  const Json value = first_value(object, tag);
  return value.is_string() ? value.get<std::string>() : "";
}

/// Returns an integer string (IS). Servers write it as a JSON number or as text.
std::optional<Index> integer_at(const Json& object, const char* tag) {
  const Json value = first_value(object, tag);
  double number = -1.0;
  if (value.is_number()) number = value.get<double>();
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return std::nullopt;
  }
  if (!(number >= 0.0 && number < 1e9)) return std::nullopt;
  return static_cast<Index>(number);
}

constexpr const char* kModalityTag = "00080060";
constexpr const char* kSeriesUidTag = "0020000E";
constexpr const char* kImageCountTag = "00201209";  // Number of Series Related Instances.

/// Counts the images of a series whose entry in the list of series has no count.
Result<Index> count_images(const StudyAddress& study, const std::string& series_uid,
                           Progress& progress, const DicomWebLimits& limits) {
  LEFORT_TRY(
      const Json list,
      fetch_json(study, fmt::format("/studies/{}/series/{}/instances", study.study_uid, series_uid),
                 progress, limits));
  return std::ssize(list);
}

/// Returns the series of the study, or the one in the address, sorted by identifier.
Result<std::vector<RemoteSeries>> find_series(const StudyAddress& study, Progress& progress,
                                              const DicomWebLimits& limits) {
  LEFORT_TRY(const Json list, fetch_json(study,
                                         fmt::format("/studies/{}/series?includefield={}",
                                                     study.study_uid, kImageCountTag),
                                         progress, limits));
  std::vector<RemoteSeries> all;
  for (const Json& entry : list) {
    RemoteSeries series{.uid = tag_text(entry, kSeriesUidTag),
                        .modality = tag_text(entry, kModalityTag)};
    if (!is_uid(series.uid) || (!study.series_uid.empty() && series.uid != study.series_uid))
      continue;
    // Anything else than a code could be a name.
    if (series.modality.size() > 10 ||
        series.modality.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != std::string::npos)
      series.modality = "unknown";
    if (const auto images = integer_at(entry, kImageCountTag)) {
      series.images = *images;
    } else {
      LEFORT_TRY(series.images, count_images(study, series.uid, progress, limits));
    }
    all.push_back(series);
  }
  if (all.empty()) return fail(ErrorCode::kFileNotFound, "the server has no such study or series");
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.uid < b.uid; });
  return all;
}

bool is_ct_series(const RemoteSeries& series) {
  return series.modality == "CT" && series.images >= 2;
}

/// \param number  counted from 1; 0 selects the only CT series.
Result<RemoteSeries> choose_series(const std::vector<RemoteSeries>& all, int number) {
  std::string list;
  for (std::size_t n = 0; n < all.size(); ++n)
    list += fmt::format("{}{} = {}, {} images", n > 0 ? "; " : "", n + 1, all[n].modality,
                        all[n].images);
  if (number != 0) {
    if (number < 0 || number > std::ssize(all))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("there is no series {}, expected one of: {}", number, list));
    return all[static_cast<std::size_t>(number - 1)];
  }
  const auto count = std::count_if(all.begin(), all.end(), is_ct_series);
  if (count == 0)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the study has no CT series, only: {}", list));
  if (count > 1)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the study has several CT series, choose one by its number: {}", list));
  return *std::find_if(all.begin(), all.end(), is_ct_series);
}

/// Writes each part of a response into its own file.
class ImageFiles {
 public:
  ImageFiles(fs::path folder, const DicomWebLimits& limits)
      : folder_(std::move(folder)), limits_(limits) {}

  [[nodiscard]] Result<void> begin() {
    if (count_ == limits_.images) return limit_exceeded(fmt::format("{} images", limits_.images));
    ++count_;
    image_bytes_ = 0;
    file_.open(folder_ / fmt::format("{:06}.dcm", count_), std::ios::binary);
    return file_ ? Result<void>() : disk_full();
  }
  [[nodiscard]] Result<void> add(std::string_view bytes) {
    image_bytes_ += bytes.size();
    series_bytes_ += bytes.size();
    if (image_bytes_ > limits_.image_bytes)
      return limit_exceeded(fmt::format("{} bytes in an image", limits_.image_bytes));
    if (series_bytes_ > limits_.series_bytes)
      return limit_exceeded(fmt::format("{} bytes", limits_.series_bytes));
    file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file_ ? Result<void>() : disk_full();
  }
  [[nodiscard]] Result<void> end() {
    file_.close();
    return file_ ? Result<void>() : disk_full();
  }
  [[nodiscard]] Index count() const { return count_; }

 private:
  [[nodiscard]] static Result<void> limit_exceeded(const std::string& what) {
    return fail(ErrorCode::kFileCorrupt, fmt::format("the server sends more than {}", what));
  }
  [[nodiscard]] static Result<void> disk_full() {
    return fail(ErrorCode::kFileUnwritable, "the images cannot be written to the temporary folder");
  }

  fs::path folder_;
  const DicomWebLimits& limits_;
  std::ofstream file_;
  Index count_ = 0;
  std::uint64_t image_bytes_ = 0, series_bytes_ = 0;
};

/// Returns functions that write the parts of a response to `files` and report progress.
MultipartReader::Sink sink_of(ImageFiles& files, Index expected_images, Progress& progress) {
  return {.begin_part = [&files] { return files.begin(); },
          .data = [&files](std::string_view bytes) { return files.add(bytes); },
          .end_part =
              [&files, expected_images, &progress] {
                progress.report(static_cast<double>(files.count()) /
                                static_cast<double>(std::max(expected_images, files.count())));
                return files.end();
              }};
}

/// Returns the error of a transfer, with the number of images that arrived if any did.
Result<void> check_transfer(const Result<void>& transfer, bool is_complete, Index images,
                            Index expected_images) {
  if (transfer && !is_complete)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the server's answer has no closing boundary after {} of {} images",
                            images, expected_images));
  if (transfer) return {};
  const auto& [code, message] = transfer.error();
  if (images == 0 || (code != ErrorCode::kFileCorrupt && code != ErrorCode::kConnectionFailed))
    return transfer;
  return fail(code, fmt::format("{} after {} of {} images", message, images, expected_images));
}

/// Fetches all images of a series into a folder.
Result<void> fetch_images(const StudyAddress& study, const RemoteSeries& series,
                          const fs::path& folder, Progress& progress,
                          const DicomWebLimits& limits) {
  ImageFiles files(folder, limits);
  std::optional<MultipartReader> reader;
  HttpRequest request{
      .path = fmt::format("{}/studies/{}/series/{}", study.root, study.study_uid, series.uid),
      .accept = "multipart/related; type=\"application/dicom\"; transfer-syntax=*"};
  request.idle_timeout = limits.idle_timeout;
  request.total_timeout = limits.total_timeout;
  request.begin = [&](const std::string& content_type) -> Result<void> {
    const std::string boundary = multipart_boundary(content_type);
    if (boundary.empty())
      return fail(ErrorCode::kFileUnsupported,
                  "the server's answer is not multipart, expected DICOMweb");
    reader.emplace(boundary, sink_of(files, series.images, progress));
    return {};
  };
  request.receive = [&](std::string_view bytes) { return reader->feed(bytes); };
  const Result<void> transfer = http_get(study.server, request, progress);
  LEFORT_TRY_VOID(
      check_transfer(transfer, reader && reader->is_complete(), files.count(), series.images));
  if (files.count() != series.images)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the server sent {} images of a series that has {}, expected all",
                            files.count(), series.images));
  return {};
}

/// Checks that the images belong to the series and that none was sent twice.
Result<void> check_images(const fs::path& folder, const RemoteSeries& series) {
  std::set<std::string> instance_uids;
  std::error_code error;
  Index number = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    LEFORT_TRY(const auto header, read_dicom_header(entry.path(), ++number));
    if (!header || header->series_uid != series.uid)
      return fail(ErrorCode::kFileCorrupt, "the server sent an image of another series");
    if (!instance_uids.insert(header->instance_uid).second)
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the server sent an image twice, expected {} different images",
                              series.images));
  }
  return {};
}

}  // namespace

bool is_dicomweb(std::string_view source) {
  return source.starts_with(kPlain) || source.starts_with(kEncrypted);
}

Result<std::vector<DicomSeriesInfo>> list_dicomweb(const std::string& address,
                                                   const Credentials& credentials,
                                                   Progress& progress,
                                                   const DicomWebLimits& limits) {
  LEFORT_TRY(const StudyAddress study, parse_address(address, credentials));
  progress.begin_stage("list the series on the server");
  LEFORT_TRY(const std::vector<RemoteSeries> all, find_series(study, progress, limits));
  std::vector<DicomSeriesInfo> infos;
  for (const RemoteSeries& series : all)
    infos.push_back({.number = static_cast<int>(infos.size()) + 1,
                     .modality = series.modality,
                     .images = series.images,
                     .is_usable = is_ct_series(series),
                     .problem = is_ct_series(series) ? "" : "not a CT"});
  return infos;
}

Result<ImportedVolume> read_dicomweb(const std::string& address, const Credentials& credentials,
                                     int series, Progress& progress, const DicomWebLimits& limits) {
  LEFORT_TRY(const StudyAddress study, parse_address(address, credentials));
  if (!study.server.is_encrypted && !study.server.password.empty())
    progress.note("the password is sent without encryption: use dicomwebs://");
  progress.begin_stage("list the series on the server");
  LEFORT_TRY(const std::vector<RemoteSeries> all, find_series(study, progress, limits));
  LEFORT_TRY(const RemoteSeries chosen, choose_series(all, series));

  progress.begin_stage("fetch the images");
  std::error_code no_parent;
  const PrivateFolder folder(fs::temp_directory_path(no_parent));
  if (folder.path().empty())
    return fail(ErrorCode::kFileUnwritable,
                "the temporary folder for the images cannot be created");
  LEFORT_TRY_VOID(fetch_images(study, chosen, folder.path(), progress, limits));
  LEFORT_TRY_VOID(check_images(folder.path(), chosen));
  LEFORT_TRY(ImportedVolume imported, read_dicom_series(folder.path(), 1, progress));
  imported.source_kind = "DICOMweb";
  if (all.size() > 1)
    imported.warnings.push_back(fmt::format("{} other series were ignored", all.size() - 1));
  return imported;
}

}  // namespace lefort::io
