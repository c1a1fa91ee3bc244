#include <lefort/core/parallel.h>
#include <lefort/core/trace.h>
#include <lefort/field/build/build_bricks.h>
#include <lefort/field/sign/brick_signs.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/field/sign/resolve_sign_conflicts.h>
#include <lefort/field/sign/violates_lipschitz.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace lefort::field {

namespace {

constexpr int kLeafSide = BrickSamples::kLeafSide;
constexpr float kUnknownDistance = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Bricks that are sampled before their leaves are stored: few enough to stay in the cache.
constexpr Index kBricksPerWave = 256;
constexpr Index kBricksPerTask = 8;
/// Bricks whose leaves a task copies.
constexpr Index kCopyBlock = 32;
/// Bricks without samples that a task marks.
constexpr Index kEmptyBlock = 4096;

using Distances = std::array<float, SparseLattice::kBrickPoints>;

/// Signs at the six faces of a brick, for comparison with neighboring bricks.
struct FaceSigns {
  std::array<std::array<std::uint64_t, 2>, 3> known{};  ///< By axis: lowest and highest points.
  std::array<std::array<std::uint64_t, 2>, 3> inside{};
  std::array<std::array<std::uint64_t, 2>, 3> clear_of_surface{};
};

/// A brick in the format of BrickSamples.
struct EncodedBrick {
  Brick brick;
  bool empty = true;
  FaceSigns faces;
  std::array<std::byte, 8 * BrickSamples::kLeafBytes + 1> codes;

  [[nodiscard]] std::size_t bytes() const {
    return std::size_t(std::popcount(brick.stored)) * BrickSamples::kLeafBytes;
  }
};

using Codes = std::array<std::int32_t, SparseLattice::kBrickPoints>;

/// Rounds to the nearest code; +-infinity becomes +-kBeyond, NaN kUnknown. Written so that the
/// compiler vectorizes it.
void quantize(const Distances& distances, float codes_per_mm, Codes& codes) {
  constexpr auto kMaximum = float(BrickSamples::kBeyond);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const float scaled = distances[i] * codes_per_mm;
    const float rounded = scaled < 0.0F ? scaled - 0.5F : scaled + 0.5F;
    const float upper = rounded < kMaximum ? rounded : kMaximum;  // Also kMaximum if NaN.
    const float within = upper > -kMaximum ? upper : -kMaximum;
    codes[i] = scaled == scaled ? std::int32_t(within) : BrickSamples::kUnknown;
  }
}

/// Writes the codes of a leaf, or its zone if it has no distances.
void encode_leaf(const Codes& codes, std::uint64_t known, int leaf, EncodedBrick& encoded) {
  const int x_low = (leaf & 1) * kLeafSide, y_low = (leaf >> 1 & 1) * kLeafSide,
            z_low = (leaf >> 2) * kLeafSide;
  const std::int32_t* const first =
      codes.data() + (z_low * kBrickSide + y_low) * kBrickSide + x_low;
  const auto bit = std::uint8_t(1U << leaf);
  if (known == 0) {
    // All its points have the same zone.
    if (*first == BrickSamples::kUnknown) encoded.brick.unknown |= bit;
    if (*first == -BrickSamples::kBeyond) encoded.brick.inside |= bit;
    return;
  }
  std::byte* target = encoded.codes.data() + encoded.bytes();
  encoded.brick.stored |= bit;
  for (int z = 0; z < kLeafSide; ++z)
    for (int y = 0; y < kLeafSide; ++y)
      for (int x = 0; x < kLeafSide; ++x) {
        // Writes four bytes; the next code overwrites the last one.
        std::memcpy(target, first + (z * kBrickSide + y) * kBrickSide + x, sizeof(std::int32_t));
        target += BrickSamples::kCodeBytes;
      }
}

void encode(Distances& distances, BrickSigns& signs, const FieldFrame& frame,
            const WindingScanlines* winding, std::int32_t number, EncodedBrick& encoded) {
  encoded.brick = {};
  encoded.empty = !signs.any_known();
  if (encoded.empty) return;
  const BrickBits inside =
      winding == nullptr ? signs.inside : inside_with_unsampled(signs, *winding, number, frame);
  const std::vector<std::size_t> in_conflict =
      resolve_sign_conflicts(distances, signs, inside, winding, number, frame);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool highest : {false, true}) {
      const auto a = std::size_t(axis);
      encoded.faces.known[a][std::size_t(highest)] = face_bits(signs.known, axis, highest);
      encoded.faces.inside[a][std::size_t(highest)] = face_bits(signs.inside, axis, highest);
      encoded.faces.clear_of_surface[a][std::size_t(highest)] =
          face_bits(signs.clear_of_surface, axis, highest);
    }
  if (winding != nullptr) {
    for (std::size_t z = 0; z < std::size_t(kBrickSide); ++z)
      for (std::uint64_t far = ~signs.known[z]; far != 0; far &= far - 1) {
        const int bit = std::countr_zero(far);
        distances[z * 64 + std::size_t(bit)] = (inside[z] >> bit & 1) != 0 ? -kInfinity : kInfinity;
      }
  }
  for (const std::size_t i : in_conflict) distances[i] = kUnknownDistance;
  Codes codes;
  quantize(distances, float(BrickSamples::kLargest / frame.band_mm), codes);
  for (int leaf = 0; leaf < 8; ++leaf) {
    std::uint64_t known = 0;
    for (int z = 0; z < kLeafSide; ++z)
      known |= signs.known[std::size_t((leaf >> 2) * kLeafSide + z)] & octant_columns(leaf);
    encode_leaf(codes, known, leaf, encoded);
  }
}

/// Finds neighbors in different bricks whose distances are in conflict.
std::vector<LatticePoint> conflicting_across_faces(const BrickSamples& samples,
                                                   std::span<const std::int32_t> bricks,
                                                   std::span<const FaceSigns> faces,
                                                   float cell_mm) {
  const int n = SparseLattice::bricks_per_side(samples.resolution());
  const std::array<int, 3> stride = {1, n, n * n};
  std::vector<std::int32_t> slots(samples.bricks().size(), SparseLattice::kNoBrick);
  for (std::size_t slot = 0; slot < bricks.size(); ++slot)
    slots[std::size_t(bricks[slot])] = std::int32_t(slot);
  const auto find_conflicts = [&](Index slot, std::vector<LatticePoint>& in_conflict) {
    const std::int32_t number = bricks[std::size_t(slot)];
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = std::size_t(axis);
      const std::int32_t next = slots[std::size_t(number + stride[a])];
      if (next == SparseLattice::kNoBrick) continue;
      const FaceSigns &here = faces[std::size_t(slot)], &there = faces[std::size_t(next)];
      std::uint64_t changes = (here.inside[a][1] ^ there.inside[a][0]) & here.known[a][1] &
                              there.known[a][0] &
                              (here.clear_of_surface[a][1] | there.clear_of_surface[a][0]);
      for (; changes != 0; changes &= changes - 1) {
        const int bit = std::countr_zero(changes);
        const LatticePoint p = point_at(SparseLattice::first_point_of(number, samples.resolution()),
                                        face_offset(bit, axis, true));
        LatticePoint q = p;
        ++q[a];
        const float d = samples.distance_of(BrickSamples::read_code(samples.code_address(p)));
        const float e = samples.distance_of(BrickSamples::read_code(samples.code_address(q)));
        if (violates_lipschitz(d, e, cell_mm)) in_conflict.insert(in_conflict.end(), {p, q});
      }
    }
  };
  return parallel_collect<LatticePoint>(Index(bricks.size()), find_conflicts);
}

/// The sampled bricks in the format of BrickSamples.
struct BrickStore {
  std::vector<Brick> table;          ///< By brick number.
  std::vector<std::int32_t> bricks;  ///< Numbers of bricks with samples, ascending.
  std::vector<FaceSigns> faces;      ///< Of `bricks`.
  std::unique_ptr<std::byte[]> codes;
  std::size_t leaves = 0;

  BrickStore(int resolution, std::size_t candidates) {
    const auto side = std::size_t(SparseLattice::bricks_per_side(resolution));
    table.resize(side * side * side);
    bricks.reserve(candidates);
    faces.reserve(candidates);
    // Memory is committed when it is written, so reserving room for all leaves costs nothing.
    codes =
        std::make_unique_for_overwrite<std::byte[]>(candidates * 8 * BrickSamples::kLeafBytes + 1);
  }

  [[nodiscard]] std::size_t bytes() const { return leaves * BrickSamples::kLeafBytes + 1; }
};

/// Assigns positions to the leaves of a wave and copies their codes.
Result<void> append_wave(std::span<EncodedBrick> wave, std::span<const std::int32_t> numbers,
                         BrickStore& store) {
  for (std::size_t i = 0; i < wave.size(); ++i) {
    EncodedBrick& encoded = wave[i];
    if (encoded.empty) continue;
    if (store.leaves > std::numeric_limits<std::uint32_t>::max() - 8)
      return fail(ErrorCode::kInvalidArgument,
                  "the band holds more than 2^32 leaves; lower the resolution or the band");
    encoded.brick.first_leaf = std::uint32_t(store.leaves);
    store.leaves += std::size_t(std::popcount(encoded.brick.stored));
    store.table[std::size_t(numbers[i])] = encoded.brick;
    store.bricks.push_back(numbers[i]);
    store.faces.push_back(encoded.faces);
  }
  parallel_for(
      std::ssize(wave),
      [&](Index i) {
        const EncodedBrick& encoded = wave[std::size_t(i)];
        std::copy_n(encoded.codes.begin(), encoded.bytes(),
                    store.codes.get() + encoded.brick.first_leaf * BrickSamples::kLeafBytes);
      },
      kCopyBlock);
  return {};
}

/// Removes the samples beyond the band.
void restrict_to_band(Distances& distances, BrickSigns& signs, float band_mm) {
  for (std::size_t z = 0; z < std::size_t(kBrickSide); ++z) {
    std::uint64_t within = 0;
    for (std::size_t i = 0; i < 64; ++i) {
      float& distance = distances[64 * z + i];
      const bool is_within = std::abs(distance) < band_mm;  // False if unsampled.
      within |= std::uint64_t(is_within) << i;
      if (!is_within) distance = kUnsampled;
    }
    signs.known[z] &= within;
    signs.inside[z] &= within;
    signs.clear_of_surface[z] &= within;
  }
}

/// Samples and encodes the bricks of the band in waves.
Result<BrickStore> encode_bricks(const BandSampler& sampler, const FieldFrame& frame,
                                 const WindingScanlines* winding, SparseLattice* wide,
                                 Progress& progress) {
  const TraceSpan span("sample bricks");
  const std::span<const std::int32_t> candidates = sampler.bricks();
  BrickStore store(frame.resolution, candidates.size());
  std::vector<EncodedBrick> wave(
      std::size_t(std::min<Index>(kBricksPerWave, Index(candidates.size()))));
  for (Index begin = 0; begin < Index(candidates.size()); begin += kBricksPerWave) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
    const Index count = std::min(kBricksPerWave, Index(candidates.size()) - begin);
    const std::span<const std::int32_t> numbers =
        candidates.subspan(std::size_t(begin), std::size_t(count));
    parallel_for(
        count,
        [&](Index i) {
          Distances distances;
          BrickSigns signs = sampler.sample(begin + i, distances);
          if (wide != nullptr) {
            std::ranges::copy(distances, wide->brick(begin + i).begin());
            resolve_by_winding(wide->brick(begin + i), signs, winding, numbers[std::size_t(i)],
                               frame);
            restrict_to_band(distances, signs, float(frame.band_mm));
          }
          encode(distances, signs, frame, winding, numbers[std::size_t(i)], wave[std::size_t(i)]);
        },
        kBricksPerTask);
    LEFORT_TRY_VOID(append_wave(std::span(wave).first(std::size_t(count)), numbers, store));
    progress.report(double(begin + count) / double(candidates.size()));
  }
  store.codes[store.bytes() - 1] = std::byte(0);  // Codes are read four bytes at a time.
  return store;
}

/// Sets the zone of bricks without samples.
void fill_empty_bricks(const WindingScanlines* winding, int resolution, BrickStore& store) {
  std::vector<bool> is_empty(store.table.size(), true);
  for (const std::int32_t b : store.bricks) is_empty[std::size_t(b)] = false;
  parallel_for(
      Index(store.table.size()),
      [&](Index b) {
        Brick& brick = store.table[std::size_t(b)];
        if (!is_empty[std::size_t(b)]) return;
        const Zone zone = winding == nullptr
                              ? Zone::kUnknown
                              : zone_of_empty_brick(*winding, std::int32_t(b), resolution);
        if (zone == Zone::kInside) brick.inside = 0xFF;
        if (zone == Zone::kUnknown) brick.unknown = 0xFF;
      },
      kEmptyBlock);
}

}  // namespace

Result<BrickSamples> build_bricks(const BandSampler& sampler, const FieldFrame& frame,
                                  const WindingScanlines* winding, SparseLattice* wide,
                                  Progress& progress) {
  LEFORT_TRY(BrickStore store, encode_bricks(sampler, frame, winding, wide, progress));
  fill_empty_bricks(winding, frame.resolution, store);

  struct Owner {
    std::vector<Brick> table;
    std::unique_ptr<std::byte[]> codes;
  };
  std::byte* const first_code = store.codes.get();
  auto owner = std::make_shared<const Owner>(Owner{std::move(store.table), std::move(store.codes)});
  const std::span<const Brick> all_bricks = owner->table;
  BrickSamples samples(frame.resolution, frame.band_mm, all_bricks,
                       std::span<const std::byte>(first_code, store.bytes()), std::move(owner));
  const std::vector<LatticePoint> in_conflict =
      conflicting_across_faces(samples, store.bricks, store.faces, float(frame.cell_mm));
  std::vector<std::ptrdiff_t> offsets;
  for (const LatticePoint& p : in_conflict) offsets.push_back(samples.code_address(p) - first_code);
  for (const std::ptrdiff_t offset : offsets)
    BrickSamples::write_code(first_code + offset, BrickSamples::kUnknown);
  return samples;
}

}  // namespace lefort::field
