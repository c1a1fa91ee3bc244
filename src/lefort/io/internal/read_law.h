/// \file
/// A material law and its constants from JSON.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/materials/material.h>
#include <lefort/io/internal/validated_json.h>

#include <string>
#include <vector>

namespace lefort::io::internal {

/// \param material  an object with "law" (text), its constants (numbers and lists) and, passed
///   over, "region" and "density_kg_m3".
/// \returns the law, or kPlanInvalid: there is no such law, a constant is missing, unknown, of the
///   wrong kind or out of its range.
[[nodiscard]] Result<fem::Material> read_law(const Json& material);

/// The names of all laws, ascending.
[[nodiscard]] std::vector<std::string> law_names();

}  // namespace lefort::io::internal
