/// \file
/// Keeps ITK and MetaIO from printing, so that bad input gives our one sentence only.
#pragma once

#include <streambuf>

namespace lefort::io {

/// While it lives, these libraries print nothing. Not for two threads at once: it borrows std::cerr
/// and std::cout, to which some of them write directly.
class LibrarySilence {
 public:
  LibrarySilence();
  ~LibrarySilence();
  LibrarySilence(const LibrarySilence&) = delete;
  LibrarySilence& operator=(const LibrarySilence&) = delete;

 private:
  std::streambuf* cerr_;
  std::streambuf* cout_;
};

}  // namespace lefort::io
