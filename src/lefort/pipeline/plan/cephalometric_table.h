/// \file
/// The cephalometric table as text.
#pragma once

#include <lefort/plan/cephalometrics.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>

namespace lefort::pipeline {

/// \param after  empty, or the lines of `before` again.
[[nodiscard]] nlohmann::json cephalometric_json(std::span<const plan::Measurement> before,
                                                std::span<const plan::Measurement> after);

/// One line for each known measurement, each after a line feed.
[[nodiscard]] std::string cephalometric_text(std::span<const plan::Measurement> before,
                                             std::span<const plan::Measurement> after);

}  // namespace lefort::pipeline
