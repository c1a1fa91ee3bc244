/// \file
/// Checks the header of a request before the body is read: length of the path, host, origin, token,
/// then method, encoding and length of the body, before the body is read.
#pragma once

#include <lefort/server/api/message.h>
#include <lefort/server/http/connection.h>

#include <optional>
#include <set>
#include <string>

namespace lefort::server {

/// Hosts, origins and token of requests by the server's own page.
struct Credentials {
  std::set<std::string> hosts, origins;  ///< Of this server, in lower case, with the port.
  std::string token;
};

/// ASCII text in lower case, for names of hosts and headers.
[[nodiscard]] std::string lower_case(std::string text);

/// \returns the error response if one of these checks fails, or nothing.
[[nodiscard]] std::optional<Response> authorize_request(const httplib::Request& request,
                                                        const Credentials& ours);

}  // namespace lefort::server
