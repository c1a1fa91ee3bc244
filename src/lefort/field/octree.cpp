#include <lefort/core/check.h>
#include <lefort/field/octree.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace lefort::field {

namespace {

/// Positions of nodes are 32 bits.
constexpr std::size_t kMaxNodes = std::size_t(1) << 30;

/// A branch is the position of its first child, which is positive; leaves are not.
std::int32_t leaf_node(Zone zone) { return -std::int32_t(zone); }
Zone zone_of_leaf(std::int32_t node) { return Zone(-node); }

LatticePoint corner_of(const LatticePoint& low, int corner, int cells) {
  return {low[0] + (corner & 1) * cells, low[1] + (corner >> 1 & 1) * cells,
          low[2] + (corner >> 2) * cells};
}

struct Decoder {
  std::string_view codes;
  std::vector<std::int32_t> nodes = {0};
  SampleIndex index;
  std::size_t next = 0;

  /// Reads the subtree for the cube at `low` into nodes[slot]; false if the letters are no tree.
  bool read(std::size_t slot, const LatticePoint& low, int cells) {
    if (next == codes.size()) return false;
    switch (NodeCode(codes[next++])) {
      case NodeCode::kOutside:
        nodes[slot] = leaf_node(Zone::kOutside);
        return true;
      case NodeCode::kInside:
        nodes[slot] = leaf_node(Zone::kInside);
        return true;
      case NodeCode::kUnknown:
        nodes[slot] = leaf_node(Zone::kUnknown);
        return true;
      case NodeCode::kBand:
        nodes[slot] = leaf_node(Zone::kBand);
        for (int corner = 0; corner < 8; ++corner) index.mark(corner_of(low, corner, cells));
        return true;
      case NodeCode::kBranch:
        return read_children(slot, low, cells / 2);
    }
    return false;
  }

  bool read_children(std::size_t slot, const LatticePoint& low, int cells) {
    if (cells == 0) return false;
    const std::size_t first = nodes.size();
    nodes[slot] = std::int32_t(first);
    nodes.resize(first + 8);
    for (int child = 0; child < 8; ++child)
      if (!read(first + std::size_t(child), corner_of(low, child, cells), cells)) return false;
    return true;
  }
};

}  // namespace

Result<Octree> Octree::decode(int resolution, std::string codes) {
  LEFORT_CHECK(resolution > 0 && std::has_single_bit(unsigned(resolution)));
  Decoder decoder{codes, {0}, SampleIndex(resolution)};
  if (codes.size() > kMaxNodes || !decoder.read(0, {0, 0, 0}, resolution) ||
      decoder.next != codes.size())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the octree is no tree at node {} of {}, it must have one leaf for "
                            "every part of its cube",
                            decoder.next, codes.size()));
  decoder.index.finish();
  Octree octree;
  octree.resolution_ = resolution;
  octree.nodes_ = std::move(decoder.nodes);
  octree.index_ = std::move(decoder.index);
  octree.samples_.assign(std::size_t(octree.index_.count()), 0.0F);
  octree.codes_ = std::move(codes);
  return octree;
}

Octree::Place Octree::find(const LatticePoint& cell) const {
  Place place{Zone::kUnknown, {{0, 0, 0}, resolution_}, {}};
  std::int32_t node = nodes_[0];
  LatticePoint& low = place.leaf.low;
  while (node > 0) {
    const int half = place.leaf.cells /= 2;
    std::int32_t child = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (cell[k] < low[k] + half) continue;
      low[k] += half;
      child |= 1 << k;
    }
    node = nodes_[std::size_t(node + child)];
  }
  place.zone = zone_of_leaf(node);
  if (place.zone != Zone::kBand) return place;
  for (int corner = 0; corner < 8; ++corner)
    place.corners[std::size_t(corner)] =
        samples_[index_.number_of(corner_of(low, corner, place.leaf.cells))];
  return place;
}

Index Octree::count(NodeCode code) const {
  return Index(std::count(codes_.begin(), codes_.end(), char(code)));
}

std::size_t Octree::bytes() const {
  return nodes_.size() * sizeof(nodes_[0]) + index_.bytes() + samples_.size() * sizeof(float);
}

}  // namespace lefort::field
