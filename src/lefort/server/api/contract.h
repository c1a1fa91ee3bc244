/// \file
/// contract/openapi.json, embedded in the program. Requests are validated against it.
#pragma once

#include <lefort/core/error.h>

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace lefort::server {

/// The document.
[[nodiscard]] const nlohmann::json& contract();

/// Parses a text and validates it against one of the contract's schemas.
///
/// \param schema  existing name in components/schemas.
/// \returns the parsed value; or kPlanInvalid with the key and the error.
[[nodiscard]] Result<nlohmann::json> parse_by_contract(std::string_view text,
                                                       const std::string& schema);

}  // namespace lefort::server
