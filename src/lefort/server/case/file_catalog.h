/// \file
/// The files and surfaces of a case that a page can request by name. Of the text from a client,
/// only a valid segment name (is_segment_name()) or guide name (is_guide_name()) becomes part of a
/// path.
#pragma once

#include <lefort/server/case/case_folder.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace lefort::server {

/// A file that a page can request.
struct NamedFile {
  std::string_view name;
  const char* stage;  ///< One of kStages: the stage that writes it; see also fresh_tissue_stage().
  std::filesystem::path (*path)(const CaseFolder&);
};

/// Files for download.
[[nodiscard]] std::span<const NamedFile> file_catalog();

/// Surface with condition and rule of the interface map at each vertex.
inline constexpr std::string_view kInterfaceSurface = "interface";

/// The median face of the uncertain inputs, with the band at each vertex.
inline constexpr std::string_view kBandSurface = "band";

/// The lower arch in occlusion, with the gap to the upper one at each vertex.
inline constexpr std::string_view kOcclusionSurface = "lower_in_occlusion";

/// The stage whose tissue mesh is that of the present plan: "preview" if that is fresh, else
/// "prediction" if that is fresh, else nothing.
[[nodiscard]] std::optional<std::string_view> fresh_tissue_stage(const CaseFolder& folder);

/// Surfaces for display.
[[nodiscard]] std::span<const NamedFile> surface_catalog();

/// Whether `name` is a valid segment name (contract/plan.schema.json).
[[nodiscard]] bool is_segment_name(std::string_view name);

/// Path of a file that a prediction of several segments has for each segment, whether it exists or
/// not; nothing if `name` is not the name of such a file.
[[nodiscard]] std::optional<std::filesystem::path> segment_result(const CaseFolder& folder,
                                                                  std::string_view name);

/// Whether `name` may be that of a cutting guide: that of a segment, `_right`, `_left` or
/// `_middle`, and from the second guide of a side on its number, as in `chin_left_2`.
[[nodiscard]] bool is_guide_name(std::string_view name);

/// Path of the surface of a cutting guide, `guide_NAME.stl`, whether it exists or not; nothing if
/// `name` is not the name of such a file.
[[nodiscard]] std::optional<std::filesystem::path> guide_result(const CaseFolder& folder,
                                                                std::string_view name);

/// The entry called `name`, or null.
[[nodiscard]] const NamedFile* find_named(std::span<const NamedFile> files, std::string_view name);

}  // namespace lefort::server
