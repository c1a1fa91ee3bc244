/// \file
/// Corrected FDI numbers of teeth.
#pragma once

#include <lefort/core/error.h>

#include <nlohmann/json.hpp>

namespace lefort::server {

/// Whether `fdi` is an FDI number of a permanent tooth (ISO 3950).
[[nodiscard]] bool is_tooth_number(int fdi);

/// Adds `found` to each tooth whose number was corrected.
///
/// \param teeth    teeth.json, or any JSON.
/// \param applied  the corrections with which it was computed, or an empty object.
[[nodiscard]] nlohmann::json with_found_numbers(nlohmann::json teeth,
                                                const nlohmann::json& applied);

/// Checks corrected numbers.
///
/// \param corrections  which match contract/openapi.json, ToothCorrections.
/// \param teeth        of with_found_numbers(), or an empty object.
/// \returns nothing, or kInvalidArgument if a number is none, is of the other jaw, or is given
///   twice, also if another tooth has it.
[[nodiscard]] Result<void> check_tooth_corrections(const nlohmann::json& corrections,
                                                   const nlohmann::json& teeth);

}  // namespace lefort::server
