/// \file
/// Samples near a surface in bricks, three bytes each: the smallest and fastest format, and the
/// default.
///
/// A leaf has 4 x 4 x 4 samples. Eight leaves form a brick, the unit in which fields are built. A
/// table of all bricks states which leaves are stored, and where. For a leaf without distances, two
/// bits state whether it is inside or outside the surface, or unknown. So memory is proportional to
/// the area of the surface, plus the table (1/64 byte per cell).
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/query/cell_samples.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace lefort::field {

/// Eight leaves, x fastest. Bit l of a mask belongs to leaf l. A leaf with no bit set lies beyond
/// the band, outside.
struct Brick {
  std::uint32_t first_leaf = 0;  ///< Position of its first stored leaf; others follow.
  std::uint8_t stored = 0;       ///< The leaf is stored.
  std::uint8_t inside = 0;       ///< It is not stored and lies beyond the band, inside.
  std::uint8_t unknown = 0;      ///< It is not stored and its sign is not known.
  std::uint8_t unused = 0;
};

/// Number of bits set in a byte. A table, because the baseline of x86-64 has no instruction for it.
inline constexpr std::array<std::uint8_t, 256> kBitCount = [] {
  std::array<std::uint8_t, 256> count{};
  for (unsigned byte = 0; byte < 256; ++byte) count[byte] = std::uint8_t(std::popcount(byte));
  return count;
}();

/// Distance samples in bricks.
class BrickSamples {
 public:
  static constexpr int kLeafSide = 4;
  static constexpr int kLeafPoints = kLeafSide * kLeafSide * kLeafSide;
  static constexpr std::size_t kCodeBytes = 3;
  static constexpr std::size_t kLeafBytes = std::size_t(kLeafPoints) * kCodeBytes;

  // Codes are 24-bit integers, little-endian: distances in units of quantum_mm().
  /// Beyond the band, outside; -kBeyond: beyond the band, inside.
  static constexpr std::int32_t kBeyond = (1 << 23) - 1;
  /// The sign is not known.
  static constexpr std::int32_t kUnknown = -(1 << 23);
  /// Code of the distance band_mm, with a margin below kBeyond for rounding.
  static constexpr std::int32_t kLargest = kBeyond - 8;

  BrickSamples() = default;

  /// \param resolution  cells along an edge of the cube.
  /// \param band_mm     width of the band.
  /// \param bricks      by SparseLattice brick number.
  /// \param codes       kLeafBytes per leaf, and one more byte.
  BrickSamples(int resolution, double band_mm, std::vector<Brick> bricks,
               std::vector<std::byte> codes);

  /// The same without a copy, for memory-mapped files.
  ///
  /// \param owner  keeps `bricks` and `codes` alive.
  /// \pre every leaf marked as stored lies within `codes`.
  BrickSamples(int resolution, double band_mm, std::span<const Brick> bricks,
               std::span<const std::byte> codes, std::shared_ptr<const void> owner);

  /// The samples at the corners of the cell with lowest corner `low`, 0 <= low < resolution.
  [[nodiscard]] CellSamples cell(const LatticePoint& low) const;

  // Coordinates of the points below are from 0 to resolution.

  /// Address of the code of a sample, or of a constant for its zone if its leaf is not stored. Four
  /// bytes can be read there.
  [[nodiscard]] const std::byte* code_address(const LatticePoint& point) const {
    const Brick& brick = bricks_[std::size_t(brick_of(point))];
    const unsigned leaf = leaf_of(point);
    if ((brick.stored >> leaf & 1U) == 0) return zone_code_of(brick, leaf);
    return codes_.data() + position_of(brick, leaf) * kLeafBytes + offset_of(point);
  }

  [[nodiscard]] static std::int32_t read_code(const std::byte* address) {
    std::int32_t word = 0;
    std::memcpy(&word, address, sizeof(word));
    return std::int32_t(std::uint32_t(word) << 8) >> 8;
  }
  static void write_code(std::byte* address, std::int32_t code) {
    std::memcpy(address, &code, kCodeBytes);
  }
  [[nodiscard]] static bool is_distance(std::int32_t code) {
    return code > -kBeyond && code < kBeyond;
  }

  /// Distance [mm]; +infinity beyond the band outside, -infinity inside, NaN if unknown.
  [[nodiscard]] float distance_of(std::int32_t code) const;

  [[nodiscard]] std::int32_t brick_of(const LatticePoint& p) const {
    constexpr int kSide = SparseLattice::kSide;
    return ((p[2] / kSide + 1) * side_ + p[1] / kSide + 1) * side_ + p[0] / kSide + 1;
  }
  [[nodiscard]] static unsigned leaf_of(const LatticePoint& p) {
    return (unsigned(p[2]) & 4U) | (unsigned(p[1]) & 4U) >> 1 | (unsigned(p[0]) & 4U) >> 2;
  }
  /// Byte offset of a point in its leaf.
  [[nodiscard]] static std::size_t offset_of(const LatticePoint& p) {
    return std::size_t(((p[2] & 3) * kLeafSide + (p[1] & 3)) * kLeafSide + (p[0] & 3)) * kCodeBytes;
  }
  [[nodiscard]] static std::size_t position_of(const Brick& brick, unsigned leaf) {
    return brick.first_leaf + kBitCount[brick.stored & ((1U << leaf) - 1U)];
  }

  [[nodiscard]] int resolution() const { return resolution_; }
  [[nodiscard]] float quantum_mm() const { return quantum_mm_; }
  [[nodiscard]] std::span<const Brick> bricks() const { return bricks_; }
  [[nodiscard]] std::span<const std::byte> codes() const { return codes_; }
  [[nodiscard]] Index leaf_count() const { return Index(codes_.size() / kLeafBytes); }
  [[nodiscard]] std::size_t bytes() const { return bricks_.size() * sizeof(Brick) + codes_.size(); }

 private:
  [[nodiscard]] static const std::byte* zone_code_of(const Brick& brick, unsigned leaf);

  int resolution_ = 0;
  int side_ = 0;  ///< Bricks along an edge of the table.
  float quantum_mm_ = 0.0F;
  std::span<const Brick> bricks_;
  std::span<const std::byte> codes_;
  std::shared_ptr<const void> owner_;
};

}  // namespace lefort::field
