#include <lefort/core/check.h>
#include <lefort/field/storage/sample_index.h>

namespace lefort::field {

SampleIndex::SampleIndex(int resolution) : side_(resolution / kBrickSide + 1) {
  LEFORT_CHECK(resolution > 0 && resolution % kBrickSide == 0);
  const auto n = std::size_t(side_);
  slots_.assign(n * n * n, SparseLattice::kNoBrick);
}

bool SampleIndex::mark(const LatticePoint& point) {
  std::int32_t& slot = slots_[position_of(point)];
  if (slot == SparseLattice::kNoBrick) {
    slot = std::int32_t(bricks_.size());
    bricks_.emplace_back();
  }
  const int offset = SparseLattice::linear_offset(point);
  std::uint64_t& word = bricks_[std::size_t(slot)].marked[std::size_t(offset / 64)];
  const std::uint64_t before = word;
  word |= std::uint64_t(1) << (offset % 64);
  return word != before;
}

void SampleIndex::finish() {
  count_ = 0;
  for (const std::int32_t slot : slots_) {
    if (slot == SparseLattice::kNoBrick) continue;
    Brick& brick = bricks_[std::size_t(slot)];
    for (std::size_t word = 0; word < kWords; ++word) {
      brick.first[word] = std::uint32_t(count_);
      count_ += std::popcount(brick.marked[word]);
    }
  }
}

std::vector<LatticePoint> SampleIndex::points() const {
  std::vector<LatticePoint> all;
  all.reserve(std::size_t(count_));
  for (int b = 0; b < int(slots_.size()); ++b) {
    if (slots_[std::size_t(b)] == SparseLattice::kNoBrick) continue;
    const Brick& brick = bricks_[std::size_t(slots_[std::size_t(b)])];
    const LatticePoint low = {b % side_ * kBrickSide, b / side_ % side_ * kBrickSide,
                              b / (side_ * side_) * kBrickSide};
    for (int offset = 0; offset < SparseLattice::kBrickPoints; ++offset)
      if ((brick.marked[std::size_t(offset / 64)] >> (offset % 64) & 1) != 0)
        all.push_back({low[0] + offset % kBrickSide, low[1] + offset / kBrickSide % kBrickSide,
                       low[2] + offset / (kBrickSide * kBrickSide)});
  }
  return all;
}

}  // namespace lefort::field
