/// \file
/// The adaptive distance field of the paper (section 2.1, step 4): an octree whose leaves
/// interpolate between samples at their corners.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/sample_index.h>
#include <lefort/field/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::field {

/// One letter per node of an octree, parents before children, children with x fastest.
enum class NodeCode : char {
  kBranch = '+',   ///< Eight children follow.
  kBand = '#',     ///< Leaf within the band: samples at its corners.
  kOutside = 'o',  ///< Leaf beyond the band ...
  kInside = 'i',
  kUnknown = '?',
};

/// Cube of cells with corner samples: a leaf within the band.
struct OctreeLeaf {
  LatticePoint low;  ///< Lattice point of its lowest corner.
  int cells;         ///< Edge in finest cells, a power of two.
};

/// Octree over a cube of resolution^3 cells. Samples are shared by the leaves that meet there.
class Octree {
 public:
  Octree() = default;

  /// Decodes a tree and numbers its corner samples.
  ///
  /// \param resolution  cells along a side, a power of two.
  /// \param codes       NodeCode letters; nothing may follow the last.
  /// \returns kFileCorrupt if the letters are no tree of that size.
  [[nodiscard]] static Result<Octree> decode(int resolution, std::string codes);

  /// Corner samples in the order of sample_points(); set by whoever decoded the tree.
  [[nodiscard]] std::span<const float> samples() const { return samples_; }
  [[nodiscard]] std::span<float> samples() { return samples_; }

  /// Lattice points of the corner samples.
  [[nodiscard]] std::vector<LatticePoint> sample_points() const { return index_.points(); }

  /// Where a point lies: the zone of its leaf, and if that is kBand the leaf and its samples.
  struct Place {
    Zone zone;
    OctreeLeaf leaf;
    std::array<double, 8> corners;  ///< [mm], x fastest; only in the band.
  };

  /// \param cell  0 <= coordinates < resolution.
  [[nodiscard]] Place find(const LatticePoint& cell) const;

  [[nodiscard]] int resolution() const { return resolution_; }
  [[nodiscard]] std::string_view codes() const { return codes_; }
  [[nodiscard]] Index node_count() const { return Index(nodes_.size()); }
  [[nodiscard]] Index count(NodeCode code) const;

  /// What find() reads.
  [[nodiscard]] std::size_t bytes() const;

 private:
  int resolution_ = 0;
  std::string codes_;
  std::vector<std::int32_t> nodes_;  ///< First of eight children, or what kind of leaf.
  SampleIndex index_;
  std::vector<float> samples_;
};

}  // namespace lefort::field
