#include <lefort/server/api/api.h>
#include <lefort/server/http/authorize_request.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>

namespace lefort::server {
namespace {

constexpr std::size_t kLongestPath = 1024;  // Characters.

/// Compares in constant time for texts of equal length.
bool is_equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    difference = difference | (static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(b[k]));
  return difference == 0;
}

}  // namespace

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

std::optional<Response> authorize_request(const httplib::Request& request,
                                          const Credentials& ours) {
  const auto count = [&](const char* name) { return request.get_header_value_count(name); };
  if (request.path.size() > kLongestPath || request.target.size() > 4 * kLongestPath)
    return error_response(414, "bad_request", "the path is too long", "path");
  if (count("Host") != 1 || !ours.hosts.contains(lower_case(request.get_header_value("Host"))))
    return error_response(421, "foreign", "unexpected Host header", "Host");
  if (count("Origin") > 1 || (count("Origin") == 1 && !ours.origins.contains(lower_case(
                                                          request.get_header_value("Origin")))))
    return error_response(403, "foreign", "only this server's own page may send requests",
                          "Origin");
  const std::string site = request.get_header_value("Sec-Fetch-Site");
  const bool is_api = request.path.starts_with(kApiPrefix);
  if (is_api && !site.empty() && site != "same-origin" && site != "none")
    return error_response(403, "foreign", "only this server's own page may send requests",
                          "Sec-Fetch-Site");
  if (is_api &&
      (count("X-Lefort-Token") != 1 ||
       !is_equal_in_constant_time(request.get_header_value("X-Lefort-Token"), ours.token)))
    return error_response(401, "no_token",
                          "the token is missing or wrong: open the address printed by lefort serve",
                          "X-Lefort-Token");
  if (count("Transfer-Encoding") > 0)
    return error_response(411, "length_required", "a body needs a Content-Length",
                          "Transfer-Encoding");
  if (count("Content-Encoding") > 0)
    return error_response(415, "wrong_type", "a body must not be encoded", "Content-Encoding");
  const std::string length = request.get_header_value("Content-Length");
  const bool is_number = !length.empty() && length.size() <= 15 &&
                         length.find_first_not_of("0123456789") == std::string::npos;
  if (count("Content-Length") > 1 || (count("Content-Length") == 1 && !is_number))
    return error_response(400, "bad_request", "Content-Length is not a number", "Content-Length");
  const bool has_body = request.method == "POST" || request.method == "PUT";
  if (!has_body && is_number && length != "0")
    return error_response(400, "bad_request", "a request of this kind has no body",
                          "Content-Length");
  if (has_body && !is_number && request.method == "PUT")
    return error_response(411, "length_required", "a body needs a Content-Length",
                          "Content-Length");
  if (has_body && !is_number && request.path != "/api/v1/uploads")
    return error_response(411, "length_required", "a body needs a Content-Length",
                          "Content-Length");
  if (request.method != "GET" && request.method != "HEAD" && request.method != "DELETE" &&
      !has_body)
    return error_response(405, "not_allowed", "the methods are GET, PUT, POST and DELETE",
                          "method");
  if (!is_api && has_body)
    return error_response(405, "not_allowed", "this path is read-only", "method");
  if (is_number && length.size() > 12)
    return error_response(413, "too_large", "the body is too large", "Content-Length");
  return std::nullopt;
}

}  // namespace lefort::server
