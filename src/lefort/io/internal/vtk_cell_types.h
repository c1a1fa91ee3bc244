/// \file
/// VTK cell types of the element and face shapes.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace lefort::io::internal {

/// VTK cell types (vtkCellType.h) in the order of mesh::ElementShape. The node numbering is that of
/// VTK.
inline constexpr std::array<std::uint8_t, 7> kCellTypes{10, 14, 13, 12, 24, 26, 25};

/// Returns the shape of a VTK cell type; nothing if it is not supported.
[[nodiscard]] constexpr std::optional<mesh::ElementShape> shape_of_cell(double cell_type) {
  for (std::size_t shape = 0; shape < kCellTypes.size(); ++shape)
    if (cell_type == kCellTypes[shape]) return mesh::ElementShape(shape);
  return std::nullopt;
}

/// VTK cell types in the order of mesh::FaceShape.
inline constexpr std::array<std::uint8_t, 4> kFaceCellTypes{5, 9, 22, 23};

[[nodiscard]] constexpr std::optional<mesh::FaceShape> face_shape_of_cell(double cell_type) {
  for (std::size_t shape = 0; shape < kFaceCellTypes.size(); ++shape)
    if (cell_type == kFaceCellTypes[shape]) return mesh::FaceShape(shape);
  return std::nullopt;
}

/// Whether a cell is a point, a line, a quadratic line, or a group of points or lines. Exports of
/// mesh generators contain them; the solver ignores them.
[[nodiscard]] constexpr bool is_point_or_line_cell(double cell_type) {
  return (cell_type >= 1.0 && cell_type <= 4.0) || cell_type == 21.0;
}

}  // namespace lefort::io::internal
