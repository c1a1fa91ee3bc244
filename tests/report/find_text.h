/// \file
/// Search in generated text. (std::regex causes warnings with the sanitizers of g++ 12.)
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::report::test {

inline std::size_t count(std::string_view text, std::string_view what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// \returns the texts between each `before` and the next `after`.
inline std::vector<std::string> between(std::string_view text, std::string_view before,
                                        std::string_view after) {
  std::vector<std::string> found;
  for (std::size_t at = text.find(before); at != text.npos; at = text.find(before, at)) {
    at += before.size();
    const std::size_t end = text.find(after, at);
    if (end == text.npos) break;
    found.emplace_back(text.substr(at, end - at));
  }
  return found;
}

}  // namespace lefort::report::test
