#include <lefort/core/check.h>
#include <lefort/field/storage/brick_samples.h>

#include <array>
#include <limits>
#include <utility>

namespace lefort::field {

namespace {

constexpr std::array<std::byte, 4> bytes_of(std::int32_t code) {
  return {std::byte(code & 0xFF), std::byte(code >> 8 & 0xFF), std::byte(code >> 16 & 0xFF),
          std::byte(0)};
}

// Codes of all points of a leaf that is not stored.
constexpr std::array<std::byte, 4> kOutsideCode = bytes_of(BrickSamples::kBeyond);
constexpr std::array<std::byte, 4> kInsideCode = bytes_of(-BrickSamples::kBeyond);
constexpr std::array<std::byte, 4> kUnknownCode = bytes_of(BrickSamples::kUnknown);

}  // namespace

BrickSamples::BrickSamples(int resolution, double band_mm, std::span<const Brick> bricks,
                           std::span<const std::byte> codes, std::shared_ptr<const void> owner)
    : resolution_(resolution),
      side_(SparseLattice::bricks_per_side(resolution)),
      quantum_mm_(float(band_mm / kLargest)),
      bricks_(bricks),
      codes_(codes),
      owner_(std::move(owner)) {
  const auto n = std::size_t(side_);
  LEFORT_CHECK(bricks_.size() == n * n * n && codes_.size() % kLeafBytes == 1);
}

BrickSamples::BrickSamples(int resolution, double band_mm, std::vector<Brick> bricks,
                           std::vector<std::byte> codes) {
  struct Owner {
    std::vector<Brick> bricks;
    std::vector<std::byte> codes;
  };
  auto owner = std::make_shared<const Owner>(Owner{std::move(bricks), std::move(codes)});
  const std::span<const Brick> all_bricks = owner->bricks;
  const std::span<const std::byte> all_codes = owner->codes;
  *this = BrickSamples(resolution, band_mm, all_bricks, all_codes, std::move(owner));
}

const std::byte* BrickSamples::zone_code_of(const Brick& brick, unsigned leaf) {
  if ((brick.unknown >> leaf & 1U) != 0) return kUnknownCode.data();
  return (brick.inside >> leaf & 1U) != 0 ? kInsideCode.data() : kOutsideCode.data();
}

float BrickSamples::distance_of(std::int32_t code) const {
  if (is_distance(code)) return float(code) * quantum_mm_;
  if (code == kUnknown) return std::numeric_limits<float>::quiet_NaN();
  return code > 0 ? std::numeric_limits<float>::infinity()
                  : -std::numeric_limits<float>::infinity();
}

CellSamples BrickSamples::cell(const LatticePoint& low) const {
  CellSamples samples{low, 1, {}};
  for (int corner = 0; corner < 8; ++corner)
    samples.corners[std::size_t(corner)] = distance_of(read_code(
        code_address({low[0] + (corner & 1), low[1] + (corner >> 1 & 1), low[2] + (corner >> 2)})));
  return samples;
}

}  // namespace lefort::field
