/// \file
/// A material law and its constants from JSON.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/materials/material.h>
#include <lefort/io/internal/validated_json.h>

#include <string>
#include <vector>

namespace lefort::io::internal {

/// \param material  an object with "law" and its constants; "region" and "density_kg_m3" are
///   ignored.
/// \returns the law, or kPlanInvalid if the law does not exist, or a constant is missing, unknown,
///   of the wrong type or out of its range.
[[nodiscard]] Result<fem::Material> read_law(const Json& material);

/// The names of all laws in alphabetical order.
[[nodiscard]] std::vector<std::string> law_names();

}  // namespace lefort::io::internal
