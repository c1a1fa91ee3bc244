/// \file
/// Replaces deprecated keys and values in JSON.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/deprecated_keys.h>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace lefort::io::internal {

/// Renames the deprecated keys and values of a plan or deck before it is validated.
///
/// \returns a warning for each deprecated name that occurs, for example `boundary.scan_edge is
///   deprecated, use scan_boundary`; or kPlanInvalid if an object has a key under both names.
[[nodiscard]] Result<std::vector<std::string>> rename_deprecated(nlohmann::json& json,
                                                                 const DeprecatedNames& names);

}  // namespace lefort::io::internal
