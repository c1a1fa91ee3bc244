#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/coalesce.h>
#include <lefort/field/tear.h>
#include <lefort/field/trilinear.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lefort::field {

namespace {

constexpr int kSide = SparseLattice::kSide;

LatticePoint child_corner(const LatticePoint& low, int child, int cells) {
  return {low[0] + (child & 1) * cells, low[1] + (child >> 1 & 1) * cells,
          low[2] + (child >> 2) * cells};
}

NodeCode code_of(Zone side) {
  if (side == Zone::kUnknown) return NodeCode::kUnknown;
  return side == Zone::kInside ? NodeCode::kInside : NodeCode::kOutside;
}

/// Kind of a finest cell from the distances at its corners, x fastest.
NodeCode classify(const std::array<double, 8>& corners, const FieldFrame& frame) {
  const auto negative = [](double d) { return d < 0.0; };
  const double nearest =
      std::abs(*std::min_element(corners.begin(), corners.end(), [](double a, double b) {
        return std::abs(a) < std::abs(b) || (!std::isnan(a) && std::isnan(b));
      }));
  if (nearest <= frame.band_mm + kCellRadius * frame.cell_mm) {
    for (std::size_t corner = 0; corner < 8; ++corner)
      for (std::size_t axis = 1; axis < 8; axis *= 2)
        if (is_torn(corners[corner], corners[corner ^ axis], frame.cell_mm))
          return NodeCode::kUnknown;
    return NodeCode::kBand;
  }
  if (!frame.closed) return NodeCode::kUnknown;
  const auto inside = std::count_if(corners.begin(), corners.end(), negative);
  if (inside == 0) return NodeCode::kOutside;
  return inside == 8 ? NodeCode::kInside : NodeCode::kUnknown;
}

/// True if the corners of a cube reproduce all the samples in it.
template <class ValueAt>
bool corners_reproduce(const ValueAt& value_at, const LatticePoint& low, int cells,
                       double tolerance) {
  std::array<double, 8> corners{};
  for (int corner = 0; corner < 8; ++corner)
    corners[std::size_t(corner)] = value_at(child_corner(low, corner, cells));
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const double sample = value_at(LatticePoint{low[0] + i, low[1] + j, low[2] + k});
        const double error = trilinear(corners, Vec3(i, j, k) / cells) - sample;
        if (!(std::abs(error) <= tolerance)) return false;
      }
  return true;
}

/// Appends the subtree of a cube and unites it to one leaf if that is possible. `append_child`
/// appends the subtree of a child; `reproduces` says whether a cube of band leaves may be united.
template <class AppendChild, class Reproduces>
void append_united(std::string& codes, const LatticePoint& low, int cells,
                   const AppendChild& append_child, const Reproduces& reproduces) {
  const std::size_t begin = codes.size();
  codes += char(NodeCode::kBranch);
  for (int child = 0; child < 8; ++child) append_child(child_corner(low, child, cells / 2));

  const std::string_view children = std::string_view(codes).substr(begin + 1);
  const char first = children.front();
  if (children.size() != 8 || children.find_first_not_of(first) != std::string_view::npos) return;
  if (first == char(NodeCode::kBand) && !reproduces(low, cells)) return;
  codes.resize(begin);
  codes += first;
}

/// A cube of kSide^3 cells with its own copy of the samples: nearly all the work happens here.
class Block {
 public:
  Block(const SidedDistances& distances, const LatticePoint& low, const FieldFrame& frame)
      : frame_(frame) {
    for (int k = 0; k <= kSide; ++k)
      for (int j = 0; j <= kSide; ++j)
        for (int i = 0; i <= kSide; ++i)
          values_[place({i, j, k})] = distances.at({low[0] + i, low[1] + j, low[2] + k});
  }

  void append(std::string& codes, const LatticePoint& low, int cells) const {
    if (cells == 1) {
      std::array<double, 8> corners{};
      for (int corner = 0; corner < 8; ++corner)
        corners[std::size_t(corner)] = values_[place(child_corner(low, corner, 1))];
      codes += char(classify(corners, frame_));
      return;
    }
    append_united(
        codes, low, cells, [&](const LatticePoint& child) { append(codes, child, cells / 2); },
        [&](const LatticePoint& cube, int size) {
          const auto value_at = [&](const LatticePoint& p) { return double(values_[place(p)]); };
          return corners_reproduce(value_at, cube, size, frame_.tolerance_mm);
        });
  }

 private:
  static std::size_t place(const LatticePoint& p) {
    return std::size_t((p[2] * (kSide + 1) + p[1]) * (kSide + 1) + p[0]);
  }

  const FieldFrame& frame_;
  std::array<float, (kSide + 1) * (kSide + 1) * (kSide + 1)> values_;
};

/// Subtree of the cube of kSide^3 cells whose lowest corner begins a brick.
std::string block_codes(const SidedDistances& distances, const LatticePoint& low,
                        const FieldFrame& frame) {
  const SparseLattice& near = distances.near;
  bool empty = true;  // Of this brick and those that hold the far sides of its last cells.
  for (int corner = 0; corner < 8; ++corner)
    empty = empty && near.slot_of(near.brick_of(child_corner(low, corner, kSide))) ==
                         SparseLattice::kNoBrick;
  std::string codes;
  if (empty) {
    codes += char(code_of(distances.brick_sides[std::size_t(near.brick_of(low))]));
  } else {
    Block(distances, low, frame).append(codes, {0, 0, 0}, kSide);
  }
  return codes;
}

/// Joins blocks to larger cubes, up to the root.
void append_upper(std::string& codes, const std::vector<std::string>& blocks,
                  const SidedDistances& distances, const LatticePoint& low, int cells,
                  double tolerance) {
  if (cells == kSide) {
    const int n = distances.near.resolution() / kSide;
    codes += blocks[std::size_t((low[2] / kSide * n + low[1] / kSide) * n + low[0] / kSide)];
    return;
  }
  append_united(
      codes, low, cells,
      [&](const LatticePoint& child) {
        append_upper(codes, blocks, distances, child, cells / 2, tolerance);
      },
      [&](const LatticePoint& cube, int size) {
        const auto value_at = [&](const LatticePoint& p) { return double(distances.at(p)); };
        return corners_reproduce(value_at, cube, size, tolerance);
      });
}

}  // namespace

Result<Octree> coalesce(const SidedDistances& distances, const FieldFrame& frame,
                        Progress& progress) {
  const int n = frame.resolution / kSide;
  std::vector<std::string> blocks(std::size_t(n) * std::size_t(n) * std::size_t(n));
  parallel_for(
      Index(blocks.size()),
      [&](Index b) {
        if (progress.stop_requested()) return;
        const LatticePoint low = {int(b % n) * kSide, int(b / n % n) * kSide,
                                  int(b / (Index(n) * n)) * kSide};
        blocks[std::size_t(b)] = block_codes(distances, low, frame);
      },
      16);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");

  std::string codes;
  append_upper(codes, blocks, distances, {0, 0, 0}, frame.resolution, frame.tolerance_mm);
  LEFORT_TRY(Octree octree, Octree::decode(frame.resolution, std::move(codes)));
  const std::vector<LatticePoint> points = octree.sample_points();
  for (std::size_t s = 0; s < points.size(); ++s) {
    octree.samples()[s] = distances.at(points[s]);
    LEFORT_CHECK(std::isfinite(octree.samples()[s]));
  }
  return octree;
}

}  // namespace lefort::field
