/// \file
/// Result of a stage.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace lefort::pipeline {

/// Summary of a completed stage.
struct Summary {
  std::string text;     ///< For people: a few lines.
  nlohmann::json json;  ///< For programs.
};

}  // namespace lefort::pipeline
