/// \file
/// What every stage returns.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace lefort::pipeline {

/// What a stage says when it is done.
struct Summary {
  std::string text;     ///< For people: a few lines.
  nlohmann::json json;  ///< For programs.
};

}  // namespace lefort::pipeline
