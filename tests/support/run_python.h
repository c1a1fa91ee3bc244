/// \file
/// Runs a script of Python's standard library, to read files independently of lefort.
#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace lefort::test {

/// \returns whether its exit code was 0, and its output. \pre `script` has no single quote.
inline std::pair<bool, std::string> run_python(const std::string& script,
                                               const std::string& argument) {
  const std::string command = "python3 -c '" + script + "' '" + argument + "' 2>&1";
  FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {false, "no pipe"};
  std::string out;
  std::array<char, 4096> buffer{};
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    out.append(buffer.data(), n);
  return {::pclose(pipe) == 0, out};
}

}  // namespace lefort::test
