/// \file
/// contract/openapi.json inside the program: what comes in is held against it.
#pragma once

#include <lefort/core/error.h>

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace lefort::server {

/// The document.
[[nodiscard]] const nlohmann::json& contract();

/// Parses a text and checks it against one of the contract's schemas.
///
/// \param schema  its name in components/schemas, which is there.
/// \returns kPlanInvalid with the key and what is wrong with it.
[[nodiscard]] Result<nlohmann::json> parse_by_contract(std::string_view text,
                                                       const std::string& schema);

}  // namespace lefort::server
