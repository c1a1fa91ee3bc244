/// \file
/// The files and surfaces of a case that pages may ask for by name: nothing that a client sends
/// becomes a path.
#pragma once

#include <lefort/server/case/case_folder.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace lefort::server {

/// A file that pages may have.
struct NamedFile {
  std::string_view name;
  const char* stage;  ///< One of kStages: what it is a result of.
  std::filesystem::path (*path)(const CaseFolder&);
};

/// What pages may download as it is.
[[nodiscard]] std::span<const NamedFile> file_catalog();

/// What pages may show.
[[nodiscard]] std::span<const NamedFile> surface_catalog();

/// Whether a page may name a segment so: as in contract/plan.schema.json.
[[nodiscard]] bool is_segment_name(std::string_view name);

/// Where the prediction of several segments keeps a file that each of them has one of, whether it
/// is there or not; nothing if `name` is called like none.
[[nodiscard]] std::optional<std::filesystem::path> segment_result(const CaseFolder& folder,
                                                                  std::string_view name);

/// The one of that name, or null.
[[nodiscard]] const NamedFile* find_named(std::span<const NamedFile> files, std::string_view name);

}  // namespace lefort::server
