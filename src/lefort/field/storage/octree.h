/// \file
/// The adaptive distance field of the paper (section 2.1, step 4): an octree whose leaves
/// interpolate between samples at their corners.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/query/cell_samples.h>
#include <lefort/field/storage/sample_index.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::field {

/// One letter per node of an octree, parents before children, children with x fastest.
enum class NodeCode : char {
  kBranch = '+',   ///< Eight children follow; if they are finest cells, a FineCells in two letters.
  kBand = '#',     ///< Leaf within the band: samples at its corners.
  kOutside = 'o',  ///< Leaf beyond the band ...
  kInside = 'i',
  kUnknown = '?',
};

/// The letter of a leaf.
[[nodiscard]] NodeCode code_of(Zone zone);

/// Eight finest cells. Nearly all of an octree are, so they have no nodes of their own.
struct FineCells {
  std::uint8_t band = 0;         ///< Which are leaves within the band, as bits.
  Zone others = Zone::kUnknown;  ///< Where the others are.
};

/// Appends to the letters of an octree.
void append_fine_cells(std::string& codes, const FineCells& cells);

/// Octree over a cube of resolution^3 cells. Samples are shared by the leaves that meet there.
class Octree {
 public:
  Octree() = default;

  /// Decodes a tree and numbers its corner samples.
  ///
  /// \param resolution  cells along a side, a power of two and a multiple of SparseLattice::kSide.
  /// \param codes        NodeCode letters; nothing may follow the last.
  /// \param max_samples  that there can be; memory follows it, not what the letters promise.
  /// \returns kFileCorrupt if the letters are no tree of that size, or of more samples.
  [[nodiscard]] static Result<Octree> decode(int resolution, std::string_view codes,
                                             Index max_samples = std::numeric_limits<Index>::max());

  /// The letters again.
  [[nodiscard]] std::string codes() const;

  /// Corner samples in the order of sample_points(); set by whoever decoded the tree.
  [[nodiscard]] std::span<const float> samples() const { return samples_; }
  [[nodiscard]] std::span<float> samples() { return samples_; }

  /// Lattice points of the corner samples.
  [[nodiscard]] std::vector<LatticePoint> sample_points() const { return index_.points(); }

  /// The leaf around a cell; if it is beyond the band, its side at all corners.
  ///
  /// \param cell  0 <= coordinates < resolution.
  [[nodiscard]] CellSamples cell(const LatticePoint& cell) const;

  [[nodiscard]] int resolution() const { return resolution_; }
  /// Leaves that interpolate.
  [[nodiscard]] Index band_leaf_count() const;

  /// What cell() reads.
  [[nodiscard]] std::size_t bytes() const;

 private:
  int resolution_ = 0;
  std::vector<std::int32_t> nodes_;  ///< First of eight children, or what kind of leaf.
  SampleIndex index_;
  std::vector<float> samples_;
};

}  // namespace lefort::field
