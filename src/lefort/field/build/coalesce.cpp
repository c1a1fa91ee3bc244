#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/build/coalesce.h>
#include <lefort/field/storage/octree_cells.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::field {

namespace {

/// Merges the subtree that begins at `begin` if its eight children are leaves of the same kind,
/// and, if they are in the band, can be reconstructed.
template <class Reproduces>
void merge_children(std::string& codes, std::size_t begin, const Reproduces& reproduces) {
  const std::string_view children = std::string_view(codes).substr(begin + 1);
  const char first = children.front();
  if (children.size() != 8 || children.find_first_not_of(first) != std::string_view::npos) return;
  if (first == char(NodeCode::kBand) && !reproduces()) return;
  codes.resize(begin);
  codes += first;
}

/// A cube of kBrickSide^3 cells with its own copy of the samples; it does most of the work.
class Block {
 public:
  Block(const SignedDistances& distances, const LatticePoint& low, const FieldFrame& frame)
      : frame_(frame) {
    for (int k = 0; k <= kBrickSide; ++k)
      for (int j = 0; j <= kBrickSide; ++j)
        for (int i = 0; i <= kBrickSide; ++i)
          values_[offset({i, j, k})] = distances.at({low[0] + i, low[1] + j, low[2] + k});
  }

  void append(std::string& codes, const LatticePoint& low, int cells) const {
    const auto value_at = [&](const LatticePoint& p) { return values_[offset(p)]; };
    if (cells == 2) {
      append_pair(codes, low);
      return;
    }
    const std::size_t begin = codes.size();
    codes += char(NodeCode::kBranch);
    for (int child = 0; child < 8; ++child)
      append(codes, corner_point(low, child, cells / 2), cells / 2);
    merge_children(codes, begin,
                   [&] { return corners_reproduce(value_at, low, cells, frame_.tolerance_mm); });
  }

 private:
  static std::size_t offset(const LatticePoint& p) {
    return std::size_t((p[2] * (kBrickSide + 1) + p[1]) * (kBrickSide + 1) + p[0]);
  }

  /// Appends a cube of two cells per edge.
  void append_pair(std::string& codes, const LatticePoint& low) const {
    const auto value_at = [&](const LatticePoint& p) { return values_[offset(p)]; };
    const FineCells cells = classify_fine_cells(value_at, low, float(frame_.cell_mm));
    if (cells.band == 0xFF && corners_reproduce(value_at, low, 2, frame_.tolerance_mm)) {
      codes += char(NodeCode::kBand);
    } else if (cells.band == 0) {
      codes += char(code_of(cells.others));
    } else {
      codes += char(NodeCode::kBranch);
      append_fine_cells(codes, cells);
    }
  }

  const FieldFrame& frame_;
  std::array<float, (kBrickSide + 1) * (kBrickSide + 1) * (kBrickSide + 1)> values_;
};

/// Subtree of the cube of kBrickSide^3 cells whose lowest corner is the first point of a brick.
std::string block_codes(const SignedDistances& distances, const LatticePoint& low,
                        const FieldFrame& frame) {
  const SparseLattice& near = distances.near;
  bool empty = true;  // This brick and those with the upper corners of its last cells.
  for (int corner = 0; corner < 8; ++corner)
    empty = empty && near.slot_of(near.brick_of(corner_point(low, corner, kBrickSide))) ==
                         SparseLattice::kNoBrick;
  std::string codes;
  if (empty) {
    codes += char(code_of(distances.brick_zones[std::size_t(near.brick_of(low))]));
  } else {
    Block(distances, low, frame).append(codes, {0, 0, 0}, kBrickSide);
  }
  return codes;
}

/// Merges blocks to larger cubes, up to the root.
void append_upper(std::string& codes, const std::vector<std::string>& blocks,
                  const SignedDistances& distances, const LatticePoint& low, int cells,
                  double tolerance_mm) {
  if (cells == kBrickSide) {
    const int n = distances.near.resolution() / kBrickSide;
    codes += blocks[std::size_t((low[2] / kBrickSide * n + low[1] / kBrickSide) * n +
                                low[0] / kBrickSide)];
    return;
  }
  const std::size_t begin = codes.size();
  codes += char(NodeCode::kBranch);
  for (int child = 0; child < 8; ++child)
    append_upper(codes, blocks, distances, corner_point(low, child, cells / 2), cells / 2,
                 tolerance_mm);
  merge_children(codes, begin, [&] {
    return corners_reproduce([&](const LatticePoint& p) { return distances.at(p); }, low, cells,
                             tolerance_mm);
  });
}

}  // namespace

Result<Octree> coalesce(const SignedDistances& distances, const FieldFrame& frame,
                        Progress& progress) {
  const int n = frame.resolution / kBrickSide;
  std::vector<std::string> blocks(std::size_t(n) * std::size_t(n) * std::size_t(n));
  parallel_for(
      Index(blocks.size()),
      [&](Index b) {
        if (progress.stop_requested()) return;
        const LatticePoint low = {int(b % n) * kBrickSide, int(b / n % n) * kBrickSide,
                                  int(b / (Index(n) * n)) * kBrickSide};
        blocks[std::size_t(b)] = block_codes(distances, low, frame);
      },
      16);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");

  std::string codes;
  append_upper(codes, blocks, distances, {0, 0, 0}, frame.resolution, frame.tolerance_mm);
  blocks = {};
  LEFORT_TRY(Octree octree, Octree::decode(frame.resolution, codes));
  const std::vector<LatticePoint> points = octree.sample_points();
  for (std::size_t s = 0; s < points.size(); ++s) {
    octree.samples()[s] = distances.at(points[s]);
    LEFORT_CHECK(std::isfinite(octree.samples()[s]));
  }
  return octree;
}

}  // namespace lefort::field
