/// \file
/// Points, curves and planes of 3D Slicer: `.mrk.json`.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io {

/// A plane as Slicer draws it: a rectangle about its center.
struct MarkupPlane {
  Vec3 center_L;
  Vec3 normal_L;                           ///< Unit length.
  Vec3 across_L;                           ///< Along the width; unit length, across the normal.
  double width_mm = 0.0, height_mm = 0.0;  ///< 0 where the file does not tell.
};

/// One node of Slicer's Markups module.
struct Markup {
  std::string type;                    ///< "Fiducial", "ClosedCurve", "Plane", ...
  std::string name;                    ///< May be empty.
  plan::Landmarks points;              ///< Control points that are placed, with their labels, in L.
  std::optional<MarkupPlane> plane{};  ///< Of a "Plane" whose center and normal are told.
};

/// Reads all markups of a file.
///
/// Each says its own coordinate system; RAS becomes L here, and LPS is what is meant where none is
/// said, as in Slicer. Points that Slicer has not placed (`positionStatus`) are left out. Nodes
/// that a transform moves in Slicer are stored where they are without it, as Slicer stores them.
///
/// \returns the markups, or
///   - kFileNotFound     there is no such file;
///   - kFileUnsupported  lengths in anything but mm and um;
///   - kFileCorrupt      not JSON, or not of Slicer's Markups schema (the message names the key); a
///     plane's normal is zero.
[[nodiscard]] Result<std::vector<Markup>> read_markups(const std::filesystem::path& file);

/// The same from text; messages then name no file.
[[nodiscard]] Result<std::vector<Markup>> parse_markups(std::string_view json);

/// A point list in L that Slicer opens, whole or not at all. Equal points give equal bytes.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_point_list(const std::filesystem::path& file,
                                            const std::string& name,
                                            std::span<const plan::Landmark> points_L);

}  // namespace lefort::io
