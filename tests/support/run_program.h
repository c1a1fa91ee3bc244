/// \file
/// Runs the lefort program as a user would.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace lefort::test {

struct ProgramRun {
  int exit_code = -1;
  std::string out;    ///< Standard output.
  std::string error;  ///< Standard error.

  /// Returns the lines on stderr that are messages and not progress: those with the name of the
  /// program.
  [[nodiscard]] int message_lines() const {
    int lines = 0;
    for (std::size_t at = 0; at < error.size();) {
      const std::size_t end = std::min(error.find('\n', at), error.size());
      if (error.compare(at, 6, "lefort") == 0) ++lines;
      at = end + 1;
    }
    return lines;
  }
};

/// \param arguments  as in a shell, quoted if necessary.
/// \param setup      shell commands before, for example "ulimit -f 10;".
inline ProgramRun run_lefort(const std::string& arguments, const std::string& setup = "") {
  std::string error_file =
      (std::filesystem::temp_directory_path() / "lefort-stderr-XXXXXX").string();
  if (const int descriptor = ::mkstemp(error_file.data()); descriptor >= 0) ::close(descriptor);
  const std::string command =
      setup + " ( '" LEFORT_PROGRAM "' " + arguments + " ) 2> '" + error_file + "'";
  FILE* const pipe = ::popen(("bash -c \"" + command + "\"").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  ProgramRun run;
  std::array<char, 4096> buffer{};
  const auto read_all = [&buffer](FILE* file, std::string& text) {
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file))
      text.append(buffer.data(), count);
  };
  read_all(pipe, run.out);
  const int status = ::pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (FILE* const file = std::fopen(error_file.c_str(), "r"); file != nullptr) {
    read_all(file, run.error);
    std::fclose(file);
  }
  std::remove(error_file.c_str());
  return run;
}

}  // namespace lefort::test
