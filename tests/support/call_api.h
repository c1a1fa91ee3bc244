/// \file
/// Calls the planner's API without a socket, with its own case folder.
#pragma once

#include <lefort/io/read_text.h>
#include <lefort/io/volume_files.h>
#include <lefort/server/api/api.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <thread>

#include "support/temporary_folder.h"

namespace lefort::test {

/// A request as http_server.cpp makes them.
inline server::Request api_request(const std::string& method, const std::string& path,
                                   std::string body = "",
                                   std::map<std::string, std::string> headers = {}) {
  server::Request request;
  request.method = method;
  request.path = std::string(server::kApiPrefix) + path;
  request.header = std::move(headers);
  request.header.try_emplace("content-type", "application/json");
  request.content_length = body.size();
  request.read_body = [body = std::move(body)](const server::BodyTaker& take) {
    return take(body);
  };
  return request;
}

/// Returns the body as text.
inline std::string body_of(const server::Response& reply) {
  if (reply.bytes) return std::string(reply.bytes->bytes);
  if (reply.file) return io::read_text(*reply.file, std::uintmax_t(1) << 32).value();
  return reply.text;
}

/// An API with a folder that is removed with it.
class CaseApi {
 public:
  explicit CaseApi(server::UploadLimits limits = {}, std::optional<std::filesystem::path> at = {})
      : api(server::CaseFolder::open(at.value_or(folder / "case")).value(), std::nullopt, limits) {}

  server::Response call_api(const std::string& method, const std::string& path,
                            std::string body = "",
                            std::map<std::string, std::string> headers = {}) {
    return api.handle(api_request(method, path, std::move(body), std::move(headers)));
  }
  nlohmann::json get(const std::string& path) {
    return nlohmann::json::parse(call_api("GET", path).text);
  }
  /// Replaces existing content.
  server::Response put(const std::string& path, const nlohmann::json& body) {
    return call_api("PUT", path, body.dump(), {{"if-match", "*"}});
  }
  /// Uploads a volume and imports it.
  nlohmann::json import_volume(const image::CtVolume& ct) {
    EXPECT_TRUE(io::write_volume(folder / "scan.nrrd", ct));
    const std::string id =
        nlohmann::json::parse(call_api("POST", "/uploads").text)["id"].get<std::string>();
    server::Request file = api_request("PUT", "/uploads/" + id + "/files/0",
                                       io::read_text(folder / "scan.nrrd", 1 << 28).value());
    file.query["name"] = "DOE^JOHN.nrrd";
    EXPECT_EQ(api.handle(file).status, 201);
    return run({{"kind", "import"}, {"upload", id}});
  }
  /// Queues a job and waits for its end.
  nlohmann::json run(const nlohmann::json& request) {
    const auto queued = call_api("POST", "/jobs", request.dump());
    EXPECT_EQ(queued.status, 202) << queued.text;
    if (queued.status != 202) return {};
    return wait_for(nlohmann::json::parse(queued.text)["id"].get<int>());
  }
  nlohmann::json wait_for(int id) {
    while (true) {
      const nlohmann::json job = get("/jobs/" + std::to_string(id));
      if (job["state"] != "queued" && job["state"] != "running") return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  TemporaryFolder folder;
  server::Api api;
};

}  // namespace lefort::test
