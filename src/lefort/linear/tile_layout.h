/// \file
/// The tiles of a lower block trapezoid, and their offsets in memory.
///
///     own rows   | T00                 |   Columns are the own rows; without rows below, this is a
///                | T10 T11             |   triangle. Tiles are stored by column without gaps; the
///     rows below | T20 T21             |   last tile of the own rows and of the rows below may be
///                | T30 T31             |   smaller.
#pragma once

#include <lefort/linear/dense_kernels.h>

#include <algorithm>
#include <cstdint>

namespace lefort::linear {

/// Rounds up to a multiple of kLane.
[[nodiscard]] constexpr std::int32_t padded(std::int32_t rows) {
  return (rows + kLane - 1) / kLane * kLane;
}

class TileLayout {
 public:
  /// \param own, below  multiples of kLane.
  constexpr TileLayout(std::int32_t own, std::int32_t below) : own_(own), below_(below) {}

  [[nodiscard]] constexpr std::int32_t rows() const { return own_ + below_; }
  [[nodiscard]] constexpr int own_tiles() const { return tiles(own_); }
  [[nodiscard]] constexpr int all_tiles() const { return tiles(own_) + tiles(below_); }

  /// First row of a tile, and its number of rows; the same numbers apply to columns.
  [[nodiscard]] constexpr std::int32_t start(int t) const {
    return t < own_tiles() ? t * kTile : own_ + (t - own_tiles()) * kTile;
  }
  [[nodiscard]] constexpr std::int32_t size(int t) const {
    return std::min<std::int32_t>(kTile, (t < own_tiles() ? own_ : rows()) - start(t));
  }

  /// The tile that contains a row.
  [[nodiscard]] constexpr int tile_of(std::int32_t row) const {
    return row < own_ ? row / kTile : own_tiles() + (row - own_) / kTile;
  }

  /// Offset of tile (i, j), i >= j, j < own_tiles().
  [[nodiscard]] constexpr std::int64_t offset(int i, int j) const {
    const std::int64_t before = std::int64_t(j) * kTile * rows() -
                                std::int64_t(kTile) * kTile * (std::int64_t(j) * (j - 1) / 2);
    return before + std::int64_t(size(j)) * (start(i) - start(j));
  }

  /// Number of entries of all tiles.
  [[nodiscard]] constexpr std::int64_t entry_count() const {
    if (own_ == 0) return 0;
    const int last = own_tiles() - 1;
    return offset(last, last) + std::int64_t(size(last)) * (rows() - start(last));
  }

 private:
  static constexpr int tiles(std::int32_t rows) { return (rows + kTile - 1) / kTile; }

  std::int32_t own_;
  std::int32_t below_;
};

}  // namespace lefort::linear
