#include <lefort/server/api/contract.h>
#include <lefort/server/api/request_parts.h>

#include <fmt/format.h>

#include <charconv>
#include <system_error>
#include <utility>

namespace lefort::server {

Response empty_reply() {
  Response reply;
  reply.status = 204;
  return reply;
}

Response with_etag(Response reply, const std::optional<std::string>& etag) {
  if (etag) reply.headers.emplace_back("ETag", *etag);
  return reply;
}

bool is_not_modified(const Request& request, const std::optional<std::string>& etag) {
  return etag && request.header_or_empty("if-none-match") == *etag;
}

Response not_modified(const std::optional<std::string>& etag) {
  Response reply;
  reply.status = 304;
  return with_etag(std::move(reply), etag);
}

Response not_found(std::string_view what) {
  return error_response(404, "not_found", fmt::format("{}", what));
}

std::optional<int> number_of(std::string_view text, int lowest, int highest) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < lowest ||
      number > highest)
    return std::nullopt;
  return number;
}

Result<int> query_number(const Request& request, const std::string& name, int otherwise, int lowest,
                         int highest) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return otherwise;
  if (const auto number = number_of(found->second, lowest, highest)) return *number;
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} must be an integer from {} to {}", name, lowest, highest));
}

Body read_body(const Request& request, std::uint64_t max_bytes, std::string_view type) {
  const std::string& sent = request.header_or_empty("content-type");
  if (sent.substr(0, sent.find(';')) != type)
    return {std::nullopt, error_response(415, "wrong_type",
                                         fmt::format("the body must be {}", type), "Content-Type")};
  if (request.content_length > max_bytes)
    return {std::nullopt,
            error_response(413, "too_large",
                           fmt::format("the body must have at most {} bytes", max_bytes))};
  std::string text;
  const bool is_whole = request.read_body && request.read_body([&](std::string_view piece) {
    if (text.size() + piece.size() > request.content_length) return false;
    text += piece;
    return true;
  });
  if (!is_whole || text.size() != request.content_length)
    return {std::nullopt, error_response(400, "bad_request", "the request body is incomplete")};
  return {std::move(text), {}};
}

JsonBody read_json(const Request& request, const std::string& schema) {
  Body body = read_body(request, kMaxBody, "application/json");
  if (!body.text) return {std::nullopt, {}, std::move(body.error)};
  auto value = parse_by_contract(*body.text, schema);
  if (!value) return {std::nullopt, {}, error_response(value.error(), "body")};
  return {*std::move(value), *std::move(body.text), {}};
}

std::optional<Response> check_precondition(const Request& request,
                                           const std::optional<std::string>& etag) {
  const std::string& sent = request.header_or_empty("if-match");
  if (sent.empty())
    return error_response(428, "no_precondition", "If-Match must name the version to replace",
                          "If-Match");
  if (sent == "*" || sent == etag) return std::nullopt;
  return with_etag(
      error_response(412, "stale", "this was changed by another page: reload it", "If-Match"),
      etag);
}

}  // namespace lefort::server
