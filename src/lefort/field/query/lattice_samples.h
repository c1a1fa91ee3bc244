/// \file
/// The samples of a field at its lattice points, independent of the storage format: for export and
/// for counts.
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

/// 8 x 8 x 8 samples; the coordinates of the first are multiples of eight.
struct SampleBlock {
  LatticePoint first{};
  /// The common zone of all samples if none is a distance; `values` is then not set.
  std::optional<Zone> zone;
  /// x fastest [mm]; beyond the band +infinity outside the surface and -infinity inside it; NaN if
  /// unknown. Blocks at the upper sides extend beyond the lattice; values there are undefined.
  std::array<float, SparseLattice::kBrickPoints> values{};

  [[nodiscard]] float at(const LatticePoint& point) const {
    return zone ? zone_value(*zone) : values[std::size_t(SparseLattice::linear_offset(point))];
  }
};

/// Reads a block. The samples are those that a query interpolates between:
///
/// - bricks and dense samples: the stored values;
/// - octrees: values at the corners of leaves, and values interpolated from the corners in leaves
///   larger than a cell. A sample in the band that no leaf in the band uses has the zone of the
///   leaves around it.
///
/// Samples in conflict with a neighbor (violates_lipschitz.h) are NaN.
///
/// \param field  to be read.
/// \param first  multiples of SparseLattice::kSide from 0 to the resolution.
/// \param block  receives the samples.
void read_block(const DistanceField& field, const LatticePoint& first, SampleBlock& block);

/// Every n-th sample in a box of the lattice.
struct LatticeWindow {
  LatticePoint first{};  ///< Multiples of `every`.
  LatticePoint count{};  ///< Along each axis, >= 1.
  int every = 1;

  [[nodiscard]] Index size() const { return Index(count[0]) * Index(count[1]) * Index(count[2]); }

  /// Position in the window of a lattice point, if it is in the window.
  [[nodiscard]] std::optional<LatticePoint> find(const LatticePoint& point) const;
};

/// The window of all samples, or of those in a box.
///
/// \param frame     lattice of the field.
/// \param region_B  the box; all samples without one.
/// \param every     stride along each axis.
/// \returns the window; or kInvalidArgument if `every` is not from 1 to the resolution, or the box
///   has a limit that is NaN or contains no sample.
[[nodiscard]] Result<LatticeWindow> window_of(const FieldFrame& frame,
                                              const std::optional<Box3>& region_B, int every);

/// Calls body(block) for each block that overlaps the window, z slowest, in the calling thread;
/// blocks are read in parallel.
///
/// \param field     to be read.
/// \param window    of its lattice.
/// \param progress  receives the fraction done; may cancel.
/// \param body      called for one block at a time.
/// \returns nothing, or kCancelled.
[[nodiscard]] Result<void> for_each_block(const DistanceField& field, const LatticeWindow& window,
                                          Progress& progress,
                                          const std::function<void(const SampleBlock&)>& body);

/// Number of samples by zone.
struct SampleCount {
  Index known = 0;    ///< In the band.
  Index outside = 0;  ///< Beyond the band, outside the surface.
  Index inside = 0;   ///< Beyond the band, inside the surface.
  Index unknown = 0;

  /// Counts a sample, given as in SampleBlock.
  void add(float sample, Index times = 1);
  [[nodiscard]] Index total() const { return known + outside + inside + unknown; }
  bool operator==(const SampleCount&) const = default;
};

/// Counts all samples of a field.
///
/// \param field     to be counted.
/// \param progress  receives the fraction done; may cancel.
/// \returns the counts, or kCancelled.
[[nodiscard]] Result<SampleCount> count_samples(const DistanceField& field,
                                                Progress& progress = Progress::none());

}  // namespace lefort::field
