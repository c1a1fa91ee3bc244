/// \file
/// Corrected FDI numbers of teeth.
#pragma once

#include <lefort/core/error.h>

#include <nlohmann/json.hpp>

namespace lefort::server {

/// Whether `fdi` is an FDI number of a permanent tooth (ISO 3950).
[[nodiscard]] bool is_tooth_number(int fdi);

/// Checks corrected numbers.
///
/// \param corrections  which match contract/openapi.json, ToothCorrections.
/// \param teeth        teeth.json, or an empty object.
/// \returns nothing, or kInvalidArgument if a number is none, or a number is given twice, also if
///   another tooth has it.
[[nodiscard]] Result<void> check_tooth_corrections(const nlohmann::json& corrections,
                                                   const nlohmann::json& teeth);

}  // namespace lefort::server
