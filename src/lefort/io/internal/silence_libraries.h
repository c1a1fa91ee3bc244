/// \file
/// Suppresses the output of ITK, and lets one thread at a time use its writers.
#pragma once

#include <mutex>
#include <streambuf>

namespace lefort::io {

/// Suppresses the output of ITK's writers during its lifetime. The writers share state between
/// threads (the output window, NrrdIO's list of errors) and print to std::cerr and std::cout, which
/// are redirected. Only one thread of the process has such an object; others wait.
class SilenceLibraries {
 public:
  SilenceLibraries();
  ~SilenceLibraries();
  SilenceLibraries(const SilenceLibraries&) = delete;
  SilenceLibraries& operator=(const SilenceLibraries&) = delete;

 private:
  std::unique_lock<std::mutex> turn_;
  std::streambuf* cerr_;
  std::streambuf* cout_;
};

}  // namespace lefort::io
