/// \file
/// Tests of lattice samples that both constructions of an octree use, bottom-up and top-down.
#pragma once

#include <lefort/field/query/cell_samples.h>
#include <lefort/field/query/trilinear.h>
#include <lefort/field/sign/violates_lipschitz.h>
#include <lefort/field/storage/octree.h>

#include <array>
#include <cmath>

namespace lefort::field {

/// Corner 0 to 7, x fastest, of the cube at `low` with `cells` cells along an edge.
[[nodiscard]] inline LatticePoint corner_point(const LatticePoint& low, int corner, int cells) {
  return {low[0] + (corner & 1) * cells, low[1] + (corner >> 1 & 1) * cells,
          low[2] + (corner >> 2) * cells};
}

/// Zone of a finest cell from its corners; also kUnknown if they are in conflict.
[[nodiscard]] inline Zone zone_of_fine_cell(const std::array<float, 8>& corners, float cell_mm) {
  const Zone zone = zone_of(corners);
  if (zone != Zone::kBand) return zone;
  for (std::size_t corner = 0; corner < 8; ++corner)
    for (std::size_t axis = 1; axis < 8; axis *= 2)
      if (violates_lipschitz(corners[corner], corners[corner ^ axis], cell_mm))
        return Zone::kUnknown;
  return Zone::kBand;
}

/// Classifies the eight finest cells of a cube with two cells per edge.
///
/// \param value_at  float(LatticePoint), +-infinity or NaN beyond the band.
/// \param low       lowest corner of the cube.
/// \param cell_mm   spacing of the lattice.
template <class ValueAt>
[[nodiscard]] FineCells classify_fine_cells(const ValueAt& value_at, const LatticePoint& low,
                                            float cell_mm) {
  FineCells cells;
  bool first = true;
  for (int child = 0; child < 8; ++child) {
    std::array<float, 8> corners{};
    for (int corner = 0; corner < 8; ++corner)
      corners[std::size_t(corner)] = value_at(corner_point(corner_point(low, child, 1), corner, 1));
    const Zone zone = zone_of_fine_cell(corners, cell_mm);
    if (zone == Zone::kBand) {
      cells.band = std::uint8_t(cells.band | 1U << child);
    } else {
      cells.others = first || cells.others == zone ? zone : Zone::kUnknown;
      first = false;
    }
  }
  return cells;
}

/// True if interpolation from the corners of a cube reproduces all samples in it. Tests the center
/// first, where most cubes fail.
///
/// \param value_at      float(LatticePoint), +-infinity or NaN beyond the band.
/// \param low           lowest corner of the cube.
/// \param cells         cells along an edge of the cube.
/// \param tolerance_mm  largest error allowed.
template <class ValueAt>
[[nodiscard]] bool corners_reproduce(const ValueAt& value_at, const LatticePoint& low, int cells,
                                     double tolerance_mm) {
  std::array<double, 8> corners{};
  for (int corner = 0; corner < 8; ++corner) {
    corners[std::size_t(corner)] = double(value_at(corner_point(low, corner, cells)));
    if (!std::isfinite(corners[std::size_t(corner)])) return false;
  }
  const auto reproduces = [&](int i, int j, int k) {
    const double sample = double(value_at(LatticePoint{low[0] + i, low[1] + j, low[2] + k}));
    const std::array<double, 3> t = {double(i) / cells, double(j) / cells, double(k) / cells};
    return std::abs(trilinear(corners, t) - sample) <= tolerance_mm;  // False for NaN.
  };
  if (!reproduces(cells / 2, cells / 2, cells / 2)) return false;
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i)
        if (!reproduces(i, j, k)) return false;
  return true;
}

/// True if two neighbors in a cube of known samples are in conflict.
///
/// \param value_at  float(LatticePoint).
/// \param low       lowest corner of the cube.
/// \param cells     cells along an edge of the cube.
/// \param cell_mm   spacing of the lattice.
template <class ValueAt>
[[nodiscard]] bool has_conflict(const ValueAt& value_at, const LatticePoint& low, int cells,
                                float cell_mm) {
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const LatticePoint p = {low[0] + i, low[1] + j, low[2] + k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          LatticePoint next = p;
          if (++next[axis] > low[axis] + cells) continue;
          if (violates_lipschitz(value_at(p), value_at(next), cell_mm)) return true;
        }
      }
  return false;
}

}  // namespace lefort::field
