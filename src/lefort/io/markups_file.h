/// \file
/// Markups of 3D Slicer (`.mrk.json`): points, curves and planes.
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

/// A plane of Slicer: a rectangle with a center.
struct MarkupPlane {
  Vec3 center_L;
  Vec3 normal_L;  ///< Unit length.
  Vec3 across_L;  ///< Along the width; unit length, orthogonal to the normal.
  double width_mm = 0.0, height_mm = 0.0;  ///< 0 if missing in the file.
};

/// One node of Slicer's Markups module.
struct Markup {
  std::string type;                    ///< "Fiducial", "ClosedCurve", "Plane", ...
  std::string name;                    ///< May be empty.
  plan::Landmarks points;              ///< Placed control points with their labels, in frame L.
  std::optional<MarkupPlane> plane{};  ///< Of a "Plane" with center and normal.
};

/// Reads all markups of a file.
///
/// Each markup states its coordinate system; RAS is converted to L, and the default is LPS, as in
/// Slicer. Points that are not placed (`positionStatus`) are omitted. Coordinates of nodes under a
/// transform are those without the transform, as Slicer stores them.
///
/// \param file  a markups file.
/// \returns the markups, or
///   - kFileNotFound     the file does not exist;
///   - kFileUnsupported  the unit of length is neither mm nor um;
///   - kFileCorrupt      not JSON, not of Slicer's Markups schema (the message names the key), or a
///                       plane has a zero normal.
[[nodiscard]] Result<std::vector<Markup>> read_markups(const std::filesystem::path& file);

/// As above from text; messages contain no file name.
[[nodiscard]] Result<std::vector<Markup>> parse_markups(std::string_view json);

/// Writes a point list for Slicer atomically. Equal points give equal bytes.
///
/// \param file      ends in `.mrk.json`.
/// \param name      of the list.
/// \param points_L  named points in frame L.
/// \param remarks   one for each point, added to its description; or none.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_point_list(const std::filesystem::path& file,
                                            const std::string& name,
                                            std::span<const plan::Landmark> points_L,
                                            std::span<const std::string> remarks = {});

}  // namespace lefort::io
