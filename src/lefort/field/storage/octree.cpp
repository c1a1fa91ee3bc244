#include <lefort/core/check.h>
#include <lefort/field/storage/octree.h>
#include <lefort/field/storage/octree_cells.h>

#include <fmt/format.h>

#include <bit>
#include <utility>

namespace lefort::field {

namespace {

/// Positions of nodes are stored in 32 bits.
constexpr std::size_t kMaxNodes = std::size_t(1) << 30;

// A branch is the position of its first child, which is positive; a leaf is minus its zone; eight
// finest cells are kFine or less.
constexpr std::int32_t kFine = -256;

std::int32_t leaf_node(Zone zone) { return -std::int32_t(zone); }
Zone zone_of_leaf(std::int32_t node) { return Zone(-node); }
std::int32_t fine_node(const FineCells& cells) {
  return kFine - (std::int32_t(cells.others) << 8 | cells.band);
}
bool is_fine(std::int32_t node) { return node <= kFine; }
FineCells fine_cells(std::int32_t node) {
  const std::int32_t packed = kFine - node;
  return {std::uint8_t(packed & 0xFF), Zone(packed >> 8)};
}

struct Decoder {
  std::string_view codes;
  std::vector<std::int32_t> nodes = {0};
  SampleIndex index;
  Index samples_left;
  std::size_t next = 0;

  bool mark_corners(const LatticePoint& low, int cells) {
    for (int corner = 0; corner < 8; ++corner)
      if (index.mark(corner_point(low, corner, cells))) --samples_left;
    return samples_left >= 0;
  }

  /// Reads the subtree of the cube at `low` into nodes[slot]; false if the letters are not a valid
  /// tree.
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
        return mark_corners(low, cells);
      case NodeCode::kBranch:
        return cells == 2 ? read_fine(slot, low) : read_children(slot, low, cells / 2);
    }
    return false;
  }

  bool read_fine(std::size_t slot, const LatticePoint& low) {
    if (codes.size() - next < 2) return false;
    FineCells cells{std::uint8_t(codes[next]), Zone::kUnknown};
    switch (NodeCode(codes[next + 1])) {
      case NodeCode::kOutside:
        cells.others = Zone::kOutside;
        break;
      case NodeCode::kInside:
        cells.others = Zone::kInside;
        break;
      case NodeCode::kUnknown:
        break;
      default:
        return false;
    }
    next += 2;
    nodes[slot] = fine_node(cells);
    for (int child = 0; child < 8; ++child)
      if ((cells.band >> child & 1) != 0 && !mark_corners(corner_point(low, child, 1), 1))
        return false;
    return true;
  }

  bool read_children(std::size_t slot, const LatticePoint& low, int cells) {
    const std::size_t first = nodes.size();
    if (first + 8 > kMaxNodes) return false;
    nodes[slot] = std::int32_t(first);
    nodes.resize(first + 8);
    for (int child = 0; child < 8; ++child)
      if (!read(first + std::size_t(child), corner_point(low, child, cells), cells)) return false;
    return true;
  }
};

void append_codes(const std::vector<std::int32_t>& nodes, std::int32_t node, std::string& codes) {
  if (is_fine(node)) {
    codes += char(NodeCode::kBranch);
    append_fine_cells(codes, fine_cells(node));
  } else if (node <= 0) {
    codes += char(code_of(zone_of_leaf(node)));
  } else {
    codes += char(NodeCode::kBranch);
    for (int child = 0; child < 8; ++child)
      append_codes(nodes, nodes[std::size_t(node + child)], codes);
  }
}

}  // namespace

NodeCode code_of(Zone zone) {
  switch (zone) {
    case Zone::kBand:
      return NodeCode::kBand;
    case Zone::kOutside:
      return NodeCode::kOutside;
    case Zone::kInside:
      return NodeCode::kInside;
    case Zone::kUnknown:
      break;
  }
  return NodeCode::kUnknown;
}

void append_fine_cells(std::string& codes, const FineCells& cells) {
  codes += char(cells.band);
  codes += char(code_of(cells.others));
}

Result<Octree> Octree::decode(int resolution, std::string_view codes, Index max_samples) {
  LEFORT_CHECK(resolution > 0 && std::has_single_bit(unsigned(resolution)));
  Decoder decoder{codes, {0}, SampleIndex(resolution), max_samples};
  const bool is_tree = decoder.read(0, {0, 0, 0}, resolution) && decoder.next == codes.size();
  if (decoder.samples_left < 0)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the octree has more than {} samples, the number in the "
                            "file",
                            max_samples));
  if (!is_tree)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the octree is invalid at node {} of {}, it must have one leaf for "
                            "each part of its cube",
                            decoder.next, codes.size()));
  decoder.index.finish();
  Octree octree;
  octree.resolution_ = resolution;
  decoder.nodes.shrink_to_fit();
  octree.nodes_ = std::move(decoder.nodes);
  octree.index_ = std::move(decoder.index);
  octree.samples_.assign(std::size_t(octree.index_.count()), 0.0F);
  return octree;
}

std::string Octree::codes() const {
  std::string codes;
  append_codes(nodes_, nodes_[0], codes);
  return codes;
}

CellSamples Octree::cell(const LatticePoint& cell) const {
  CellSamples leaf{{0, 0, 0}, resolution_, {}};
  const auto descend = [&] {
    const int half = leaf.cells /= 2;
    int child = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (cell[k] < leaf.low[k] + half) continue;
      leaf.low[k] += half;
      child |= 1 << k;
    }
    return child;
  };
  std::int32_t node = nodes_[0];
  while (node > 0) {
    const int child = descend();
    node = nodes_[std::size_t(node + child)];
  }
  Zone zone = Zone::kBand;
  if (is_fine(node)) {
    const FineCells cells = fine_cells(node);
    const int child = descend();
    if ((cells.band >> child & 1) == 0) zone = cells.others;
  } else {
    zone = zone_of_leaf(node);
  }
  if (zone != Zone::kBand) {
    leaf.corners.fill(zone_value(zone));
    return leaf;
  }
  for (int corner = 0; corner < 8; ++corner)
    leaf.corners[std::size_t(corner)] =
        samples_[index_.number_of(corner_point(leaf.low, corner, leaf.cells))];
  return leaf;
}

Index Octree::band_leaf_count() const {
  Index count = 0;
  for (const std::int32_t node : nodes_) {
    if (is_fine(node)) count += std::popcount(fine_cells(node).band);
    if (node == leaf_node(Zone::kBand)) ++count;
  }
  return count;
}

std::size_t Octree::bytes() const {
  return nodes_.size() * sizeof(nodes_[0]) + index_.bytes() + samples_.size() * sizeof(float);
}

}  // namespace lefort::field
