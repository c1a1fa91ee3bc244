/// \file
/// Who is heard: decided by a request's header, before anything is read of its body.
#pragma once

#include <lefort/server/api/message.h>
#include <lefort/server/http/connection.h>

#include <optional>
#include <set>
#include <string>

namespace lefort::server {

/// What a request must show to be meant for this server, by its own page.
struct Credentials {
  std::set<std::string> hosts, origins;  ///< That are ours, in lower case, with the port.
  std::string token;
};

/// In lower case, if it is ASCII; names of hosts and headers are.
[[nodiscard]] std::string lower_case(std::string text);

/// Why a request is not heard, or nothing.
[[nodiscard]] std::optional<Response> authorize_request(const httplib::Request& request,
                                                        const Credentials& ours);

}  // namespace lefort::server
