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

/// One letter per node of an octree: parents before children, children x fastest.
enum class NodeCode : char {
  /// Eight children follow; if these are finest cells, FineCells in two letters.
  kBranch = '+',
  kBand = '#',     ///< Leaf in the band: it has samples at its corners.
  kOutside = 'o',  ///< Leaf beyond the band, outside the surface.
  kInside = 'i',   ///< Leaf beyond the band, inside the surface.
  kUnknown = '?',  ///< Leaf of unknown zone.
};

/// The letter of a leaf.
[[nodiscard]] NodeCode code_of(Zone zone);

/// Eight finest cells. Most cells of an octree are finest cells, so these have no nodes of their
/// own.
struct FineCells {
  std::uint8_t band = 0;         ///< Leaves in the band, as bits.
  Zone others = Zone::kUnknown;  ///< Zone of the others; kUnknown if they differ.
};

/// Appends two letters for eight finest cells.
void append_fine_cells(std::string& codes, const FineCells& cells);

/// Octree over a cube of resolution^3 cells. Leaves with a common corner share its sample.
class Octree {
 public:
  Octree() = default;

  /// Decodes a tree and numbers its corner samples.
  ///
  /// \param resolution   cells along an edge, a power of two and a multiple of
  ///   SparseLattice::kSide.
  /// \param codes        NodeCode letters; nothing may follow the tree.
  /// \param max_samples  max number of samples; this limits the memory for a damaged file.
  /// \returns kFileCorrupt if the letters are not a tree of that size, or it has more samples.
  [[nodiscard]] static Result<Octree> decode(int resolution, std::string_view codes,
                                             Index max_samples = std::numeric_limits<Index>::max());

  /// Encodes the tree.
  [[nodiscard]] std::string codes() const;

  /// Corner samples [mm] in the order of sample_points(); to be set after decoding.
  [[nodiscard]] std::span<const float> samples() const { return samples_; }
  [[nodiscard]] std::span<float> samples() { return samples_; }

  /// Lattice points of the corner samples.
  [[nodiscard]] std::vector<LatticePoint> sample_points() const { return index_.points(); }

  /// The leaf that contains a cell; beyond the band all corners have the zone_value() of its zone.
  ///
  /// \param cell  0 <= coordinates < resolution.
  [[nodiscard]] CellSamples cell(const LatticePoint& cell) const;

  [[nodiscard]] int resolution() const { return resolution_; }
  /// Number of leaves in the band.
  [[nodiscard]] Index band_leaf_count() const;

  /// Memory used by cell().
  [[nodiscard]] std::size_t bytes() const;

 private:
  int resolution_ = 0;
  /// Position of the first of eight children, the zone of a leaf, or FineCells.
  std::vector<std::int32_t> nodes_;
  SampleIndex index_;
  std::vector<float> samples_;
};

}  // namespace lefort::field
