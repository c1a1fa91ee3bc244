/// \file
/// The page's files, embedded in the program.
#pragma once

#include <span>
#include <string_view>

namespace lefort::server {

struct PageFile {
  std::string_view path;  ///< "/index.html".
  std::string_view type;  ///< "text/html; charset=utf-8".
  std::string_view bytes;
};

/// All files; or one that describes how to build the page, if it was not built.
[[nodiscard]] std::span<const PageFile> page_files();

/// The file at a path, or null. "/" is /index.html.
[[nodiscard]] const PageFile* find_page_file(std::string_view path);

}  // namespace lefort::server
