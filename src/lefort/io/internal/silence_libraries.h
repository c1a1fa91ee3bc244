/// \file
/// Keeps ITK and MetaIO from printing, so that bad input gives our one sentence only.
#pragma once

#include <streambuf>

namespace lefort::io {

/// While it lives, these libraries print nothing. Not for two threads at once: it borrows std::cerr
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
