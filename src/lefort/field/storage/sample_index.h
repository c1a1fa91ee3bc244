/// \file
/// Lattice points with a sample of the octree, and the numbers of the samples.
#pragma once

#include <lefort/field/storage/sparse_lattice.h>

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace lefort::field {

/// One bit per lattice point, in bricks; the number of a sample is the count of set bits before its
/// bit. So leaves need not store the numbers of their corners, which would take eight times the
/// memory of the samples.
class SampleIndex {
 public:
  SampleIndex() = default;

  /// \param resolution  a multiple of SparseLattice::kSide.
  explicit SampleIndex(int resolution);

  /// Marks a lattice point as sampled. \pre finish() was not called yet.
  ///
  /// \returns false if it was marked before.
  bool mark(const LatticePoint& point);

  /// Assigns numbers to the marked points: by brick, x fastest inside a brick.
  void finish();

  [[nodiscard]] Index count() const { return count_; }

  /// Number of a sample. \pre the point was marked.
  [[nodiscard]] std::uint32_t number_of(const LatticePoint& point) const {
    const Brick& brick = bricks_[std::size_t(slots_[position_of(point)])];
    const int offset = SparseLattice::linear_offset(point);
    const auto word = std::size_t(offset / 64);
    const std::uint64_t before = (std::uint64_t(1) << (offset % 64)) - 1;
    return brick.first[word] + std::uint32_t(std::popcount(brick.marked[word] & before));
  }

  /// All marked points, by number.
  [[nodiscard]] std::vector<LatticePoint> points() const;

  [[nodiscard]] std::size_t bytes() const {
    return slots_.size() * sizeof(slots_[0]) + bricks_.size() * sizeof(Brick);
  }

 private:
  static constexpr std::size_t kWords = SparseLattice::kBrickPoints / 64;
  struct Brick {
    std::array<std::uint64_t, kWords> marked;
    std::array<std::uint32_t, kWords> first;  ///< Number of the first sample of each word.
  };

  /// Points of the octree are 0 to resolution along each axis.
  [[nodiscard]] std::size_t position_of(const LatticePoint& p) const {
    constexpr int kSide = SparseLattice::kSide;
    return std::size_t((p[2] / kSide * side_ + p[1] / kSide) * side_ + p[0] / kSide);
  }

  int side_ = 0;  ///< Bricks along an edge.
  Index count_ = 0;
  std::vector<std::int32_t> slots_;
  std::vector<Brick> bricks_;
};

}  // namespace lefort::field
