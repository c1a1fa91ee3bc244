/// \file
/// A PACS for one test: Orthanc with its DICOMweb plug-in on the loopback interface, with a
/// temporary storage.
#pragma once

#include <arpa/inet.h>
#include <httplib.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "support/temporary_folder.h"

namespace lefort::test {

/// Returns an unused port.
inline int free_port() {
  const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool is_bound = ::bind(probe, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                        ::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(probe);
  if (!is_bound) throw std::runtime_error("no free port");
  return ntohs(address.sin_port);
}

class OrthancServer {
 public:
  static constexpr const char* kUser = "lefort";
  static constexpr const char* kPassword = "s3cret:/@";

  [[nodiscard]] static bool is_installed() {
    return std::filesystem::exists("/usr/sbin/Orthanc") &&
           std::filesystem::exists("/usr/share/orthanc/plugins/libOrthancDicomWeb.so");
  }

  OrthancServer() : port_(free_port()) {
    std::ofstream(folder_ / "orthanc.json")
        << "{\"Name\": \"test\", \"HttpPort\": " << port_
        << ", \"DicomServerEnabled\": false, \"RemoteAccessAllowed\": false"
        << ", \"HttpThreadsCount\": 4, \"StorageDirectory\": \"" << (folder_ / "db").string()
        << "\", \"IndexDirectory\": \"" << (folder_ / "db").string()
        << "\", \"AuthenticationEnabled\": true, \"RegisteredUsers\": {\"" << kUser << "\": \""
        << kPassword << "\"}, \"Plugins\": [\"/usr/share/orthanc/plugins/libOrthancDicomWeb.so\"]"
        << ", \"DicomWeb\": {\"Enable\": true}}";
    process_ = ::fork();
    if (process_ == 0) {
      const std::string log = (folder_ / "log").string();
      if (::freopen(log.c_str(), "w", stdout) == nullptr ||
          ::freopen(log.c_str(), "a", stderr) == nullptr)
        ::_exit(1);
      ::execl("/usr/sbin/Orthanc", "Orthanc", (folder_ / "orthanc.json").c_str(), nullptr);
      ::_exit(1);
    }
    for (int tries = 0; tries < 600; ++tries) {  // One minute, for a loaded machine.
      if (auto answer = client().Get("/dicom-web/studies"); answer && answer->status == 200) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    stop();
    throw std::runtime_error("Orthanc does not start");
  }
  ~OrthancServer() { stop(); }
  OrthancServer(const OrthancServer&) = delete;
  OrthancServer& operator=(const OrthancServer&) = delete;

  void stop() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }

  /// Stores every file of a folder.
  void store(const std::filesystem::path& folder) const {
    auto upload = client();
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(file), {}};
      const auto answer = upload.Post("/instances", bytes, "application/dicom");
      if (!answer || answer->status != 200) throw std::runtime_error("Orthanc takes no file");
    }
  }

  [[nodiscard]] int port() const { return port_; }

 private:
  [[nodiscard]] httplib::Client client() const {
    httplib::Client http("127.0.0.1", port_);
    http.set_basic_auth(kUser, kPassword);
    http.set_connection_timeout(5);
    http.set_read_timeout(10);
    return http;
  }

  TemporaryFolder folder_;
  int port_;
  pid_t process_ = 0;
};

}  // namespace lefort::test
