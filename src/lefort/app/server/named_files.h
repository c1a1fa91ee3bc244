/// \file
/// The files and surfaces of a case that pages may ask for by name: nothing that a client sends
/// becomes a path.
#pragma once

#include <lefort/app/server/case_folder.h>

#include <filesystem>
#include <span>
#include <string_view>

namespace lefort::app::server {

/// A file that pages may have.
struct NamedFile {
  std::string_view name;
  const char* stage;  ///< One of kStages: what it is a result of.
  std::filesystem::path (*path)(const CaseFolder&);
};

/// What pages may download as it is.
[[nodiscard]] std::span<const NamedFile> named_files();

/// What pages may show.
[[nodiscard]] std::span<const NamedFile> named_surfaces();

/// The one of that name, or null.
[[nodiscard]] const NamedFile* find_named(std::span<const NamedFile> files, std::string_view name);

}  // namespace lefort::app::server
