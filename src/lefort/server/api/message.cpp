#include <lefort/core/printable.h>
#include <lefort/server/api/message.h>

#include <algorithm>

namespace lefort::server {
namespace {

std::string dump(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string one_line(std::string_view text, std::size_t longest) {
  std::string line(text.substr(0, longest));
  std::replace(line.begin(), line.end(), '\n', ' ');
  return printable(line);
}

}  // namespace

const std::string& Request::header_or_empty(const std::string& lower_case_name) const {
  static const std::string nothing;
  const auto found = header.find(lower_case_name);
  return found == header.end() ? nothing : found->second;
}

SharedBytes shared_bytes(std::string text) {
  auto owner = std::make_shared<const std::string>(std::move(text));
  const std::string_view bytes = *owner;
  return {std::move(owner), bytes};
}

Response json_response(const nlohmann::json& json, int status) {
  Response reply;
  reply.status = status;
  reply.text = dump(json);
  return reply;
}

Response binary_response(SharedBytes bytes) {
  Response reply;
  reply.type = "application/octet-stream";
  reply.bytes = std::move(bytes);
  return reply;
}

Response error_response(int status, std::string_view code, std::string_view message,
                        std::string_view where) {
  constexpr std::size_t kLongestMessage = 4000, kLongestWhere = 400;  // As in the contract.
  return json_response({{"error",
                         {{"code", code},
                          {"message", one_line(message, kLongestMessage)},
                          {"where", one_line(where, kLongestWhere)}}}},
                       status);
}

Response error_response(const Error& error, std::string_view where) {
  switch (error.code) {
    case ErrorCode::kFileUnwritable:
    case ErrorCode::kOutOfMemory:
      return error_response(507, "unavailable", error.message, where);
    case ErrorCode::kFileNotFound:
      return error_response(404, "not_found", error.message, where);
    default:
      return error_response(422, "invalid", error.message, where);
  }
}

}  // namespace lefort::server
