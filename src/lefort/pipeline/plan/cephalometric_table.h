/// \file
/// The cephalometric table as text.
#pragma once

#include <lefort/plan/cephalometrics.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>

namespace lefort::pipeline {

/// \param before  measurements [degrees or mm] before surgery.
/// \param after   empty, or the same measurements after surgery, in the same order.
[[nodiscard]] nlohmann::json cephalometric_json(std::span<const plan::Measurement> before,
                                                std::span<const plan::Measurement> after);

/// One line for each known measurement; each begins with a line feed.
[[nodiscard]] std::string cephalometric_text(std::span<const plan::Measurement> before,
                                             std::span<const plan::Measurement> after);

}  // namespace lefort::pipeline
