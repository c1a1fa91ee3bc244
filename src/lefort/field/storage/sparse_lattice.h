/// \file
/// Values at the points of a regular lattice, stored in bricks where they exist.
#pragma once

#include <lefort/core/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::field {

using LatticePoint = std::array<int, 3>;

/// A lattice of resolution + 1 points along each edge of a cube, and one more brick on every side
/// for points beyond it. 8 x 8 x 8 points form a brick; most bricks do not exist.
class SparseLattice {
 public:
  static constexpr int kSide = 8;
  static constexpr int kBrickPoints = kSide * kSide * kSide;
  static constexpr std::int32_t kNoBrick = -1;

  SparseLattice() = default;

  /// \param resolution     a multiple of kSide.
  /// \param brick_numbers  bricks to create: strictly ascending, < bricks_per_side^3.
  /// \param initial        value of all their points.
  SparseLattice(int resolution, std::vector<std::int32_t> brick_numbers, float initial);

  /// \param resolution  a multiple of kSide.
  [[nodiscard]] static int bricks_per_side(int resolution) { return resolution / kSide + 3; }

  [[nodiscard]] int resolution() const { return resolution_; }
  [[nodiscard]] int bricks_per_side() const { return bricks_per_side(resolution_); }
  [[nodiscard]] Index brick_count() const { return Index(brick_numbers_.size()); }

  /// Number (x fastest) of the brick in slot 0 <= slot < brick_count().
  [[nodiscard]] std::int32_t brick_number(Index slot) const {
    return brick_numbers_[std::size_t(slot)];
  }
  [[nodiscard]] std::span<const std::int32_t> brick_numbers() const { return brick_numbers_; }

  /// Slot of a brick, or kNoBrick.
  [[nodiscard]] std::int32_t slot_of(std::int32_t brick) const {
    return slots_[std::size_t(brick)];
  }

  /// First lattice point of a brick.
  [[nodiscard]] static LatticePoint first_point_of(std::int32_t brick, int resolution) {
    const int n = bricks_per_side(resolution);
    return {brick % n * kSide - kSide, brick / n % n * kSide - kSide,
            brick / (n * n) * kSide - kSide};
  }
  [[nodiscard]] LatticePoint first_point(std::int32_t brick) const {
    return first_point_of(brick, resolution_);
  }

  /// Brick that contains a lattice point; coordinates from -kSide to resolution + 2 kSide - 1.
  [[nodiscard]] std::int32_t brick_of(const LatticePoint& point) const {
    const int n = bricks_per_side();
    return ((point[2] + kSide) / kSide * n + (point[1] + kSide) / kSide) * n +
           (point[0] + kSide) / kSide;
  }

  /// Offset in its brick, x fastest.
  [[nodiscard]] static int linear_offset(const LatticePoint& point) {
    return (((point[2] + kSide) % kSide) * kSide + (point[1] + kSide) % kSide) * kSide +
           (point[0] + kSide) % kSide;
  }

  [[nodiscard]] std::span<float, kBrickPoints> brick(Index slot) {
    return std::span<float, kBrickPoints>(values_.data() + slot * kBrickPoints, kBrickPoints);
  }
  [[nodiscard]] std::span<const float, kBrickPoints> brick(Index slot) const {
    return std::span<const float, kBrickPoints>(values_.data() + slot * kBrickPoints, kBrickPoints);
  }

  /// Value at a lattice point; `absent` if its brick does not exist.
  [[nodiscard]] float at(const LatticePoint& point, float absent) const {
    const std::int32_t slot = slot_of(brick_of(point));
    return slot == kNoBrick
               ? absent
               : values_[std::size_t(slot) * kBrickPoints + std::size_t(linear_offset(point))];
  }

  [[nodiscard]] std::span<const float> values() const { return values_; }
  [[nodiscard]] std::span<float> values() { return values_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  int resolution_ = 0;
  std::vector<std::int32_t> brick_numbers_;
  std::vector<std::int32_t> slots_;
  std::vector<float> values_;
};

inline constexpr int kBrickSide = SparseLattice::kSide;

}  // namespace lefort::field
