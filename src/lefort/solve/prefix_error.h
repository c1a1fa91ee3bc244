/// \file
/// Adds the key of a deck to error messages.
#pragma once

#include <lefort/core/error.h>

#include <fmt/format.h>

#include <string>

namespace lefort::solve {

/// Prefixes an error's message with `key`.
template <class T>
[[nodiscard]] Result<T> prefix_error(Result<T> result, const std::string& key) {
  if (result) return result;
  return fail(result.error().code, fmt::format("{}: {}", key, result.error().message));
}

/// "displacements[3]"
[[nodiscard]] inline std::string indexed(const char* list, std::size_t index) {
  return fmt::format("{}[{}]", list, index);
}

}  // namespace lefort::solve
