/// \file
/// A public scan: the head CT of Debian's invesalius-examples.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::test {

/// Debian's minimal images omit the files of packages in /usr/share/doc; then the package is
/// downloaded and unpacked, as in script/demo.
///
/// \returns its path; the file does not exist if the package is neither installed nor available
///   from apt.
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
