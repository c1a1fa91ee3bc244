/// \file
/// Searching in texts, for tests.
#pragma once

#include <string_view>

namespace lefort::test {

inline bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

}  // namespace lefort::test
