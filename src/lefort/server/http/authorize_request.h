/// \file
/// Authorization of requests by their header, before the body is read.
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

/// \returns the error response of a rejected request, or nothing.
[[nodiscard]] std::optional<Response> authorize_request(const httplib::Request& request,
                                                        const Credentials& ours);

}  // namespace lefort::server
