/// \file
/// The samples of a field at the points of its lattice, whatever keeps them: what other file
/// formats and counts are made of.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <array>
#include <functional>
#include <optional>

namespace lefort::field {

/// 8 x 8 x 8 samples, the first at multiples of eight.
struct SampleBlock {
  LatticePoint first{};
  /// Of all samples, if none is a distance and all are on one side; `values` is then not set.
  std::optional<Zone> side;
  /// x fastest [mm]; +infinity beyond the band outside, -infinity inside, NaN where not known. The
  /// last blocks reach beyond the lattice, where nothing is said.
  std::array<float, SparseLattice::kBrickPoints> values{};

  [[nodiscard]] float at(const LatticePoint& point) const {
    return side ? side_value(*side) : values[std::size_t(SparseLattice::linear_offset(point))];
  }
};

/// Reads a block. The samples are those that a query would interpolate between:
///
/// - of bricks and dense samples as they are kept, but for those that contradict a neighbor
///   (violates_lipschitz.h), which are NaN;
/// - of octrees those at the corners of leaves, and in leaves larger than a cell what their corners
///   interpolate. A sample at the edge of the band that no leaf needs lies beyond the band.
///
/// \param first  multiples of SparseLattice::kSide from 0 to the resolution.
void read_block(const DistanceField& field, const LatticePoint& first, SampleBlock& block);

/// Every n-th sample of a box of the lattice.
struct LatticeWindow {
  LatticePoint first{};  ///< Multiples of `every`.
  LatticePoint count{};  ///< Along each axis, >= 1.
  int every = 1;

  [[nodiscard]] Index size() const { return Index(count[0]) * Index(count[1]) * Index(count[2]); }

  /// Which sample of the window a lattice point is, if any.
  [[nodiscard]] std::optional<LatticePoint> find(const LatticePoint& point) const;
};

/// The window of all samples, or of those in a box.
///
/// \returns kInvalidArgument if `every` is not from 1 to the resolution, or the box holds none.
[[nodiscard]] Result<LatticeWindow> window_of(const FieldFrame& frame,
                                              const std::optional<Box3>& region_B, int every);

/// Calls body(block) for every block that meets the window, z slowest, from this thread; blocks
/// are read by many.
///
/// \returns kCancelled.
[[nodiscard]] Result<void> for_each_block(const DistanceField& field, const LatticeWindow& window,
                                          Progress& progress,
                                          const std::function<void(const SampleBlock&)>& body);

/// How many samples of a field are what.
struct SampleCount {
  Index known = 0;    ///< Within the band.
  Index outside = 0;  ///< Beyond it ...
  Index inside = 0;
  Index unknown = 0;

  /// Counts one sample, as in SampleBlock.
  void add(float sample, Index times = 1);
  [[nodiscard]] Index total() const { return known + outside + inside + unknown; }
  bool operator==(const SampleCount&) const = default;
};

/// \returns kCancelled.
[[nodiscard]] Result<SampleCount> count_samples(const DistanceField& field,
                                                Progress& progress = Progress::none());

}  // namespace lefort::field
