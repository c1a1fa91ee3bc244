/// \file
/// Suppresses the output of ITK and MetaIO, so that invalid input causes one error message only.
#pragma once

#include <streambuf>

namespace lefort::io {

/// Suppresses the output of these libraries while it lives. Not thread-safe: it redirects std::cerr
/// and std::cout, to which some of them write directly.
class SilenceLibraries {
 public:
  SilenceLibraries();
  ~SilenceLibraries();
  SilenceLibraries(const SilenceLibraries&) = delete;
  SilenceLibraries& operator=(const SilenceLibraries&) = delete;

 private:
  std::streambuf* cerr_;
  std::streambuf* cout_;
};

}  // namespace lefort::io
