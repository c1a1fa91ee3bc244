#include <lefort/io/dicom.h>
#include <lefort/io/dicomweb.h>
#include <lefort/io/import_volume.h>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "io/dicom_writer.h"
#include "io/orthanc_server.h"
#include "io/sample_scan.h"
#include "support/stop_at_once.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace lefort::io::test_dicomweb {
namespace {

using test::contains;
using test::OrthancServer;
using test::TemporaryFolder;

constexpr const char* kStudy = "1.2.826.0.1.3680043.2.1125.9";  // As in dicom_writer.
const Credentials kCredentials{OrthancServer::kUser, OrthancServer::kPassword};

/// Returns the number of lefort's folders in the folder of temporary files.
long temporary_folders() {
  long count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::temp_directory_path()))
    if (entry.path().filename().string().starts_with("lefort-") &&
        !entry.path().filename().string().starts_with("lefort-test-") &&
        std::filesystem::is_directory(entry.path()))
      ++count;
  return count;
}

/// One Orthanc for all tests of this program, with two CT series and a plan.
struct Pacs {
  OrthancServer server;
  TemporaryFolder folder;
  image::CtVolume ct = test::sample_scan(test::oblique());

  Pacs() {
    auto slices = test::dicom_slices(ct);
    test::write_dicom_series(folder / "a", slices);
    for (auto& slice : slices) {
      slice.series_uid += ".2";
      slice.instance_uid += ".2";
      for (std::int16_t& value : slice.stored) value = static_cast<std::int16_t>(value / 2);
    }
    test::write_dicom_series(folder / "b", slices);
    server.store(folder / "a");
    server.store(folder / "b");
  }
  [[nodiscard]] std::string address(const std::string& rest) const {
    return fmt::format("dicomweb://127.0.0.1:{}/dicom-web{}", server.port(), rest);
  }
};

Pacs& pacs() {
  static Pacs instance;
  return instance;
}

class OrthancTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!OrthancServer::is_installed()) GTEST_SKIP() << "Debian's orthanc is not installed";
    before_ = temporary_folders();
  }
  void TearDown() override { EXPECT_EQ(temporary_folders(), before_); }
  long before_ = 0;
};

TEST_F(OrthancTest, ImportsTheSameBitsAsFromAFolder) {
  const std::string study = pacs().address(std::string("/studies/") + kStudy);
  const auto list = list_dicomweb(study, kCredentials);
  ASSERT_TRUE(list) << list.error().message;
  ASSERT_EQ(list->size(), 2U);
  for (const DicomSeriesInfo& series : *list) {
    EXPECT_EQ(series.modality, "CT");
    EXPECT_EQ(series.images, 6);
    EXPECT_TRUE(series.is_usable);
  }
  for (const int series : {1, 2}) {
    const auto wanted = read_dicom_series(pacs().folder.path(), series);
    ASSERT_TRUE(wanted) << wanted.error().message;
    const auto found = read_dicomweb(study, kCredentials, series);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->ct.values, wanted->ct.values);
    EXPECT_EQ(found->ct.grid, wanted->ct.grid);
    EXPECT_EQ(found->source_kind, "DICOMweb");
    EXPECT_EQ(found->warnings, wanted->warnings);
  }
  EXPECT_NE(read_dicomweb(study, kCredentials, 1)->ct.values,
            read_dicomweb(study, kCredentials, 2)->ct.values);

  // Address with series, user name and password.
  const auto named = import_volume(
      fmt::format("dicomweb://lefort:s3cret%3A%2f%40@localhost:{}/dicom-web/studies/{}/series/"
                  "1.2.826.0.1.3680043.2.1125.1.2/",
                  pacs().server.port(), kStudy));
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_EQ(named->ct.values, read_dicomweb(study, kCredentials, 2)->ct.values);
}

/// Returns the error of reading from an address, after checks that apply to every error.
Error error_of(const std::string& address, const Credentials& who = kCredentials, int series = 1,
               const DicomWebLimits& limits = {}) {
  const auto result = read_dicomweb(address, who, series, Progress::none(), limits);
  if (result) {
    ADD_FAILURE() << "no error";
    return {ErrorCode::kNotConverged, ""};
  }
  const std::string& message = result.error().message;
  test::expect_one_sentence(message);
  for (const char* const secret : {"s3cret", "wrong-word", "1.2.826", "DOE"})
    EXPECT_FALSE(contains(message, secret)) << message;
  return result.error();
}

TEST_F(OrthancTest, ReportsWrongPasswordUnknownStudyAndWrongChoice) {
  const std::string study = pacs().address(std::string("/studies/") + kStudy);
  const Error wrong = error_of(study, {"lefort", "wrong-word"});
  EXPECT_EQ(wrong.code, ErrorCode::kAccessDenied);
  EXPECT_TRUE(contains(wrong.message, "rejects the user name or password (status 401)"))
      << wrong.message;
  EXPECT_TRUE(contains(error_of(study, {}).message, "rejects the user name or password"));

  const Error unknown = error_of(pacs().address("/studies/1.2.3.4"));
  EXPECT_EQ(unknown.code, ErrorCode::kFileNotFound);
  EXPECT_TRUE(contains(unknown.message, "no such study")) << unknown.message;
  EXPECT_TRUE(contains(error_of(study + "/series/1.2.3").message, "no such study or series"));
  const Error choice = error_of(study, kCredentials, 0);
  EXPECT_EQ(choice.code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(contains(choice.message, "1 = CT, 6 images; 2 = CT, 6 images")) << choice.message;
  EXPECT_TRUE(contains(error_of(study, kCredentials, 3).message, "there is no series 3"));
  EXPECT_EQ(error_of(pacs().address("x/studies/1.2")).code, ErrorCode::kFileNotFound);
}

TEST_F(OrthancTest, ReportsAStoppedServer) {
  OrthancServer server;
  server.store(pacs().folder / "a");
  const std::string study =
      fmt::format("dicomweb://127.0.0.1:{}/dicom-web/studies/{}", server.port(), kStudy);
  ASSERT_TRUE(read_dicomweb(study, kCredentials));
  server.stop();
  const Error gone = error_of(study);
  EXPECT_EQ(gone.code, ErrorCode::kConnectionFailed);
  EXPECT_TRUE(contains(gone.message, "no server answers at 127.0.0.1")) << gone.message;
}

/// A server with responses set by the test.
class FakeServer {
 public:
  FakeServer() : port_(http_.bind_to_any_port("127.0.0.1")) {
    http_.Get(".*/series", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(list, "application/dicom+json");
    });
    http_.Get(".*/instances", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(instances, "application/dicom+json");
    });
    http_.Get(".*/series/.*",
              [this](const httplib::Request&, httplib::Response& response) { images(response); });
    thread_ = std::thread([this] { http_.listen_after_bind(); });
    // A server that does not listen yet cannot be stopped.
    while (!http_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~FakeServer() {
    http_.stop();
    thread_.join();
  }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  [[nodiscard]] std::string study() const {
    return fmt::format("dicomweb://127.0.0.1:{}/studies/1.2.3", port_);
  }

  std::string list, instances = "[]";
  std::function<void(httplib::Response&)> images = [](httplib::Response& r) { r.status = 500; };

 private:
  httplib::Server http_;
  int port_;
  std::thread thread_;
};

std::string series_list(int images) {
  return fmt::format(
      R"([{{"0020000E": {{"vr": "UI", "Value": ["1.2.826.0.1.3680043.2.1125.1"]}},
           "00080060": {{"vr": "CS", "Value": ["CT"]}},
           "00201209": {{"vr": "IS", "Value": [{}]}}}}])",
      images);
}

/// Returns the files of the sample scan as a multipart body, without closing boundary unless
/// `whole`.
std::string body_of(std::size_t files, bool whole = true) {
  const TemporaryFolder folder;
  const auto slices = test::dicom_slices(test::sample_scan());
  test::write_dicom_series(folder.path(), slices);
  std::string body;
  for (std::size_t n = 0; n < files; ++n)
    body += "--cut\r\nContent-Type: application/dicom\r\n\r\n" +
            test::bytes_of(folder / fmt::format("slice-{:03}.dcm", n % slices.size())) + "\r\n";
  return body + (whole ? "--cut--\r\n" : "");
}

constexpr const char* kParts = "multipart/related; type=\"application/dicom\"; boundary=cut";

TEST(DicomWeb, ReadsFromAnyStandardServer) {
  FakeServer server;
  server.list = series_list(6);
  server.images = [](httplib::Response& r) { r.set_content(body_of(6), kParts); };
  const auto found = read_dicomweb(server.study(), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, test::sample_scan().values);
  // If the server does not state the number of images of a series, their list is fetched.
  server.list = R"([{"0020000E": {"vr": "UI", "Value": ["1.2.826.0.1.3680043.2.1125.1"]},
                     "00080060": {"vr": "CS", "Value": ["CT"]}}])";
  server.instances = "[{}, {}, {}, {}, {}, {}]";
  EXPECT_TRUE(read_dicomweb(server.study(), {}));
  server.instances = "[{}, {}, {}, {}, {}, {}, {}]";
  EXPECT_TRUE(contains(error_of(server.study()).message, "6 images of a series that has 7"));
}

TEST(DicomWeb, RejectsAnIncompleteSeries) {
  const long before = temporary_folders();
  FakeServer server;
  server.list = series_list(6);
  // The server lists six images and sends three.
  server.images = [](httplib::Response& r) { r.set_content(body_of(3), kParts); };
  Error error = error_of(server.study());
  EXPECT_EQ(error.code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(contains(error.message, "3 images of a series that has 6")) << error.message;
  // All parts are there, the closing boundary is not.
  server.images = [](httplib::Response& r) { r.set_content(body_of(6, false), kParts); };
  error = error_of(server.study());
  EXPECT_EQ(error.code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(contains(error.message, "no closing boundary after 6 of 6 images")) << error.message;
  // The server closes the connection in the middle of a file.
  server.images = [](httplib::Response& r) {
    r.set_content_provider(
        body_of(6).size(), kParts,
        [body = body_of(6)](std::size_t offset, std::size_t, httplib::DataSink& sink) {
          if (offset > 0) return false;
          return sink.write(body.data(), body.size() / 2);
        });
  };
  error = error_of(server.study());
  EXPECT_EQ(error.code, ErrorCode::kConnectionFailed);
  EXPECT_TRUE(contains(error.message, "was lost after") && contains(error.message, "of 6 images"))
      << error.message;
  // One slice twice instead of another, and a slice of another series.
  server.list = series_list(7);
  server.images = [](httplib::Response& r) { r.set_content(body_of(7), kParts); };
  EXPECT_TRUE(contains(error_of(server.study()).message, "an image twice"));
  server.list = R"([{"0020000E": {"Value": ["1.2.9"]}, "00080060": {"Value": ["CT"]},
                     "00201209": {"Value": ["6"]}}])";
  server.images = [](httplib::Response& r) { r.set_content(body_of(6), kParts); };
  EXPECT_TRUE(contains(error_of(server.study()).message, "of another series"));
  EXPECT_EQ(temporary_folders(), before);
}

TEST(DicomWeb, EnforcesLimitsAndTimeouts) {
  FakeServer server;
  server.list = series_list(6);
  server.images = [](httplib::Response& r) { r.set_content(body_of(6), kParts); };
  EXPECT_TRUE(
      contains(error_of(server.study(), {}, 0, {.images = 5}).message, "more than 5 images"));
  EXPECT_TRUE(contains(error_of(server.study(), {}, 0, {.image_bytes = 100}).message,
                       "100 bytes in an image"));
  EXPECT_TRUE(contains(error_of(server.study(), {}, 0, {.series_bytes = 2000}).message,
                       "more than 2000 bytes"));
  EXPECT_TRUE(contains(error_of(server.study(), {}, 0, {.list_bytes = 10}).message,
                       "list has more than 10 bytes"));
  // An endless image.
  server.images = [](httplib::Response& r) {
    r.set_chunked_content_provider(kParts, [first = true](std::size_t,
                                                          httplib::DataSink& sink) mutable {
      const std::string bytes = first ? "--cut\r\n\r\n" : std::string(std::size_t{1} << 16, 'x');
      first = false;
      return sink.write(bytes.data(), bytes.size());
    });
  };
  EXPECT_TRUE(contains(error_of(server.study(), {}, 0, {.image_bytes = 1 << 22}).message,
                       "4194304 bytes in an image"));
  // A server that does not answer.
  server.images = [](httplib::Response&) { std::this_thread::sleep_for(std::chrono::seconds(3)); };
  const Error silent = error_of(server.study(), {}, 0, {.idle_timeout = std::chrono::seconds(1)});
  EXPECT_EQ(silent.code, ErrorCode::kConnectionFailed);
  EXPECT_TRUE(contains(silent.message, "was lost")) << silent.message;
  const Error slow = error_of(server.study(), {}, 0, {.total_timeout = std::chrono::seconds(1)});
  EXPECT_EQ(slow.code, ErrorCode::kConnectionFailed);
  EXPECT_TRUE(contains(slow.message, "takes longer than 1 s")) << slow.message;
}

/// Sends `first` and then `again` to every client until it disconnects.
class FloodingServer {
 public:
  FloodingServer(std::string first, std::string again)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(place);
    auto* const address = reinterpret_cast<sockaddr*>(&place);
    if (::bind(socket_, address, size) != 0 || ::listen(socket_, 8) != 0 ||
        ::getsockname(socket_, address, &size) != 0)
      throw std::runtime_error("no socket");
    port_ = ntohs(place.sin_port);
    thread_ = std::thread([this, first = std::move(first), again = std::move(again)] {
      for (int peer = 0; (peer = ::accept(socket_, nullptr, nullptr)) >= 0; ::close(peer)) {
        const std::string* text = &first;
        while (::send(peer, text->data(), text->size(), MSG_NOSIGNAL) > 0) text = &again;
      }
    });
  }
  ~FloodingServer() {
    ::shutdown(socket_, SHUT_RDWR);
    thread_.join();
    ::close(socket_);
  }
  FloodingServer(const FloodingServer&) = delete;
  FloodingServer& operator=(const FloodingServer&) = delete;

  [[nodiscard]] std::string study() const {
    return fmt::format("dicomweb://127.0.0.1:{}/studies/1.2.3", port_);
  }

 private:
  int socket_;
  int port_ = 0;
  std::thread thread_;
};

TEST(DicomWeb, RejectsEndlessHeaders) {
  const std::string ok = "HTTP/1.1 200 OK\r\n", line = "X-More: and more\r\n";
  EXPECT_TRUE(
      contains(error_of(FloodingServer(ok, line).study()).message, "headers have more than"));
  const std::string carry_on = "HTTP/1.1 100 Continue\r\n\r\n";
  EXPECT_TRUE(contains(error_of(FloodingServer(carry_on, carry_on).study()).message,
                       "headers have more than"));
  // An endless line, for which libcurl has a limit.
  EXPECT_EQ(error_of(FloodingServer(ok + "X-Long: ", std::string(1000, 'x')).study()).code,
            ErrorCode::kConnectionFailed);
}

TEST(DicomWeb, ReportsServersWithoutDicomWeb) {
  FakeServer server;
  for (const char* const list : {"<html>", "{}", "7", "[[[[", "\"\xff\"", "{\"a\": [1, 2"})
    EXPECT_TRUE(
        contains((server.list = list, error_of(server.study()).message), "not a JSON array"))
        << list;
  server.list = std::string(100'000, '[');
  EXPECT_TRUE(contains(error_of(server.study()).message, "not a JSON array"));
  for (const char* const list : {"[]", "[1, null, {}, \"a\"]", "[{\"0020000E\": 7}]",
                                 R"([{"0020000E": {"Value": ["../etc"]}}])"}) {
    server.list = list;
    EXPECT_EQ(error_of(server.study()).code, ErrorCode::kFileNotFound) << list;
  }
  server.list = series_list(6);
  EXPECT_TRUE(contains(error_of(server.study()).message, "status 500"));
  server.images = [](httplib::Response& r) { r.set_content("x", "text/html"); };
  EXPECT_TRUE(contains(error_of(server.study()).message, "not multipart"));
  server.images = [](httplib::Response& r) { r.set_redirect("/elsewhere"); };
  EXPECT_TRUE(contains(error_of(server.study()).message, "status 302"));
  // A server without certificate.
  std::string encrypted = server.study();
  encrypted.replace(0, 8, "dicomwebs");
  const Error untrusted = error_of(encrypted);
  EXPECT_EQ(untrusted.code, ErrorCode::kConnectionFailed);
  EXPECT_TRUE(contains(untrusted.message, "no trusted certificate")) << untrusted.message;
  // Rejected credentials, from a server without Orthanc.
  for (const int status : {401, 403}) {
    server.images = [status](httplib::Response& r) { r.status = status; };
    EXPECT_EQ(error_of(server.study()).code, ErrorCode::kAccessDenied);
  }
}

TEST(DicomWeb, RejectsInvalidAddresses) {
  for (const char* const address :
       {"dicomweb://", "dicomweb:///studies/1.2", "dicomweb://h", "dicomweb://h/dicom-web",
        "dicomweb://h/studies/", "dicomweb://h/studies/1.2/series/", "dicomweb://h/studies/1.2x",
        "dicomweb://h:0/studies/1.2", "dicomweb://h:99999/studies/1.2",
        "dicomweb://h:8o/studies/1.2", "dicomweb://h/a b/studies/1.2",
        "dicomweb://h/a\r\nHost: x/studies/1.2", "dicomweb://u:p%4@h/studies/1.2",
        "dicomweb://h/studies/1.2/series/1.2/instances/3"}) {
    const Error error = error_of(address);
    EXPECT_EQ(error.code, ErrorCode::kInvalidArgument) << address << ": " << error.message;
  }
  EXPECT_TRUE(is_dicomweb("dicomweb://h") && is_dicomweb("dicomwebs://h"));
  EXPECT_FALSE(is_dicomweb("dicomweb") || is_dicomweb("/data/dicomweb://"));
}

TEST(DicomWeb, StopsOnRequest) {
  FakeServer server;
  server.list = series_list(6);
  test::StopAtOnce progress;
  EXPECT_EQ(read_dicomweb(server.study(), {}, 0, progress).error().code, ErrorCode::kCancelled);
}

/// Requests a stop after 300 ms.
class StopsLater : public Progress {
 public:
  [[nodiscard]] bool stop_requested() const override {
    return std::chrono::steady_clock::now() > begin_ + std::chrono::milliseconds(300);
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

TEST(DicomWeb, StopsOnRequestWhileTheServerIsSilent) {
  std::atomic<bool> is_over{false};
  FakeServer server;
  server.list = series_list(6);
  server.images = [&](httplib::Response&) {
    while (!is_over) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };
  StopsLater progress;  // Long before the idle timeout of 30 s.
  EXPECT_EQ(read_dicomweb(server.study(), {}, 0, progress).error().code, ErrorCode::kCancelled);
  is_over = true;
}

}  // namespace
}  // namespace lefort::io::test_dicomweb
