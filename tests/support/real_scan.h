/// \file
/// The one real scan everybody has: the head CT of Debian's invesalius-examples.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::test {

/// Debian's minimal images leave out what packages put under /usr/share/doc; then the package
/// itself is fetched and unpacked, as script/demo does.
///
/// \returns where it is; nothing is there if it is neither installed nor to be had from apt.
inline const std::filesystem::path& real_scan() {
  static const std::filesystem::path installed =
      "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
  static const TemporaryFolder folder;
  static const std::filesystem::path scan = [] {
    if (std::filesystem::exists(installed)) return installed;
    const std::string command = "cd '" + (folder / ".").string() +
                                "' && apt-get download -qq invesalius-examples >/dev/null 2>&1 && "
                                "dpkg -x invesalius-examples_*.deb .";
    return std::system(command.c_str()) == 0 ? folder / installed.relative_path().string()
                                             : installed;
  }();
  return scan;
}

}  // namespace lefort::test
