#include <lefort/core/check.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <utility>

namespace lefort::field {

SparseLattice::SparseLattice(int resolution, std::vector<std::int32_t> brick_numbers, float initial)
    : resolution_(resolution), brick_numbers_(std::move(brick_numbers)) {
  LEFORT_CHECK(resolution > 0 && resolution % kSide == 0);
  const Index n = bricks_per_side();
  slots_.assign(std::size_t(n * n * n), kNoBrick);
  std::int32_t slot = 0;
  for (const std::int32_t brick : brick_numbers_) {
    LEFORT_CHECK(brick >= 0 && brick < n * n * n);
    LEFORT_CHECK(slot == 0 || brick > brick_numbers_[std::size_t(slot - 1)]);
    slots_[std::size_t(brick)] = slot++;
  }
  values_.assign(brick_numbers_.size() * kBrickPoints, initial);
}

std::size_t SparseLattice::bytes() const {
  return values_.size() * sizeof(float) +
         (slots_.size() + brick_numbers_.size()) * sizeof(std::int32_t);
}

}  // namespace lefort::field
