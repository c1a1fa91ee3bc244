#include <lefort/core/check.h>
#include <lefort/io/field_file.h>
#include <lefort/io/internal/mapped_file.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace lefort::io {

namespace {

using field::Brick;
using field::BrickSamples;
using field::DenseSamples;
using field::FieldFrame;
using field::Octree;
using field::SparseLattice;

static_assert(std::endian::native == std::endian::little, "values are copied without conversion");

constexpr std::string_view kFieldMagic = "lefortDF";
constexpr std::uint32_t kVersion = 3;
constexpr int kMaxResolution = 2048;
constexpr double kMaxCoordinate_mm = 1e7;
constexpr double kMinCell_mm = 1e-7;       // A fifth of the smallest that can be built.
constexpr double kMaxSide_mm = 1e7;        // Twice the maximum that can be built.
constexpr float kSampleSlack = 1.000001F;  // Samples and band are rounded to float.
constexpr std::uint64_t kMaxTriangles = 100'000'000;
constexpr std::size_t kAlignment = 64;

/// Storage of the samples.
enum class Storage : std::uint32_t { kBricks = 1, kOctree = 2, kDense = 3 };

/// Blocks of the file in order; blocks that a field does not need are empty.
enum Block : std::size_t {
  kBrickTable,    ///< Table of bricks.
  kCodes,         ///< Leaves with three bytes per sample and one byte more.
  kTree,          ///< Octree, one letter per cell.
  kSamples,       ///< float [mm]: octree corners in the order of sample_points(), or dense.
  kSmoothBricks,  ///< int32, numbers of the bricks of the smooth lattice, ascending.
  kSmoothValues,  ///< float, values of each brick.
  kBlockCount
};

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t checksum;  // CRC-32 of the file with this field set to zero.
  std::uint32_t storage;
  std::int32_t resolution;
  double origin_mm[3];
  double cell_mm;
  double band_mm;
  double tolerance_mm;
  std::uint32_t closed;  // 0 or 1.
  std::uint32_t smooth;  // 0 or 1.
  std::uint64_t bytes[kBlockCount];
  std::uint32_t findings[8];  // MeshRepairReport, in its order.
  std::uint64_t triangles;    // 0: unknown.
  std::uint64_t parts;
  std::uint64_t reserved[2];
};
static_assert(sizeof(Header) == 192 && std::is_trivially_copyable_v<Header> &&
              sizeof(Header) % kAlignment == 0);
static_assert(sizeof(Brick) == 8 && std::is_trivially_copyable_v<Brick>);

tl::unexpected<Error> corrupt_field(const std::string& what) {
  return fail(ErrorCode::kFileCorrupt, "the distance field file is damaged: " + what);
}

std::size_t aligned(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

std::uint32_t checksum_of(Header header, std::span<const std::byte> rest) {
  header.checksum = 0;
  const uLong crc = ::crc32_z(0, reinterpret_cast<const unsigned char*>(&header), sizeof(header));
  return std::uint32_t(
      ::crc32_z(crc, reinterpret_cast<const unsigned char*>(rest.data()), rest.size()));
}

template <class T>
std::span<const std::byte> bytes_of(std::span<const T> values) {
  return std::as_bytes(values);
}

/// Returns the values of a block. \pre its size is a multiple of theirs.
template <class T>
std::span<const T> values_of(std::span<const std::byte> block) {
  return {reinterpret_cast<const T*>(block.data()), block.size() / sizeof(T)};
}

using Blocks = std::array<std::span<const std::byte>, kBlockCount>;

/// Compares sizes with the size of the file before they are used.
Result<Blocks> find_blocks(const Header& header, std::span<const std::byte> bytes) {
  Blocks blocks;
  std::size_t begin = sizeof(Header);
  for (std::size_t b = 0; b < kBlockCount; ++b) {
    if (header.bytes[b] > bytes.size() || begin + aligned(header.bytes[b]) > bytes.size())
      return corrupt_field(fmt::format("it has {} bytes, the header states more", bytes.size()));
    blocks[b] = bytes.subspan(begin, header.bytes[b]);
    begin += aligned(header.bytes[b]);
  }
  if (begin != bytes.size())
    return corrupt_field(fmt::format("it has {} bytes, the header states {}", bytes.size(), begin));
  return blocks;
}

Result<FieldFrame> frame_of(const Header& header) {
  FieldFrame frame;
  frame.origin_B = Vec3(header.origin_mm[0], header.origin_mm[1], header.origin_mm[2]);
  frame.cell_mm = header.cell_mm;
  frame.resolution = header.resolution;
  frame.band_mm = header.band_mm;
  frame.tolerance_mm = header.tolerance_mm;
  frame.closed = header.closed == 1;
  if (frame.resolution < SparseLattice::kSide || frame.resolution > kMaxResolution ||
      !std::has_single_bit(unsigned(frame.resolution)))
    return corrupt_field(fmt::format("its resolution is {}", frame.resolution));
  if (!(frame.origin_B.cwiseAbs().maxCoeff() <= kMaxCoordinate_mm && frame.origin_B.allFinite()))
    return corrupt_field("its origin is not finite");
  if (!(frame.cell_mm >= kMinCell_mm && frame.cell_mm * frame.resolution <= kMaxSide_mm))
    return corrupt_field(fmt::format("its cells are {} mm wide", frame.cell_mm));
  if (!(frame.band_mm >= frame.cell_mm && frame.band_mm <= frame.cell_mm * frame.resolution))
    return corrupt_field(fmt::format("its band is {} mm wide", frame.band_mm));
  if (!(frame.tolerance_mm >= 0.0 && frame.tolerance_mm <= kMaxCoordinate_mm))
    return corrupt_field(fmt::format("its tolerance is {} mm", frame.tolerance_mm));
  if (header.closed > 1 || header.smooth > 1) return corrupt_field("its flags are neither 0 nor 1");
  if (header.triangles > kMaxTriangles || header.parts > header.triangles)
    return corrupt_field(
        fmt::format("its surface has {} triangles in {} parts", header.triangles, header.parts));
  return frame;
}

/// The kind of the samples must be known. Blocks that such a field does not need must be empty,
/// since they would not be read.
Result<void> check_blocks_belong(const Header& header, const Blocks& blocks) {
  const auto storage = Storage(header.storage);
  if (storage != Storage::kBricks && storage != Storage::kOctree && storage != Storage::kDense)
    return corrupt_field(fmt::format("its samples are of kind {}", header.storage));
  const bool bricks = storage == Storage::kBricks, octree = storage == Storage::kOctree;
  const bool smooth = header.smooth == 1;
  const std::array<bool, kBlockCount> has = {bricks, bricks, octree, !bricks, smooth, smooth};
  for (std::size_t b = 0; b < kBlockCount; ++b)
    if (!has[b] && !blocks[b].empty())
      return corrupt_field(
          fmt::format("block {} has {} bytes, a field of its kind has none", b, blocks[b].size()));
  return {};
}

/// Pointers to the findings of a report in the order of the header.
auto findings_of(auto& report) {
  return std::array{&report.duplicate_vertices,  &report.degenerate_triangles,
                    &report.duplicate_triangles, &report.opposite_duplicates,
                    &report.flipped_triangles,   &report.boundary_edges,
                    &report.non_manifold_edges,  &report.inconsistent_edges};
}

void set_source(const field::FieldSource& source, Header& header) {
  header.triangles = std::uint64_t(source.triangles);
  header.parts = std::uint64_t(source.components);
  std::size_t n = 0;
  for (const Index* const finding : findings_of(source.report))
    header.findings[n++] =
        std::uint32_t(std::min(*finding, Index(std::numeric_limits<std::uint32_t>::max())));
}

std::optional<field::FieldSource> source_of(const Header& header) {
  if (header.triangles == 0) return std::nullopt;
  field::FieldSource source{Index(header.triangles), Index(header.parts), {}};
  std::size_t n = 0;
  for (Index* const finding : findings_of(source.report)) *finding = Index(header.findings[n++]);
  return source;
}

Result<BrickSamples> read_bricks(const FieldFrame& frame, const Blocks& blocks,
                                 std::shared_ptr<const void> owner) {
  const auto side = std::size_t(SparseLattice::bricks_per_side(frame.resolution));
  const std::span<const std::byte> codes = blocks[kCodes];
  if (blocks[kBrickTable].size() != side * side * side * sizeof(Brick))
    return corrupt_field(fmt::format("its table has {} bytes", blocks[kBrickTable].size()));
  if (codes.size() % BrickSamples::kLeafBytes != 1)
    return corrupt_field(fmt::format("its leaves have {} bytes", codes.size()));
  const std::size_t leaves = codes.size() / BrickSamples::kLeafBytes;
  const std::span<const Brick> table = values_of<Brick>(blocks[kBrickTable]);
  for (std::size_t b = 0; b < table.size(); ++b)
    if (table[b].stored != 0 &&
        table[b].first_leaf + std::size_t(std::popcount(table[b].stored)) > leaves)
      return corrupt_field(fmt::format("brick {} refers to leaves beyond the last", b));
  return BrickSamples(frame.resolution, frame.band_mm, table, codes, std::move(owner));
}

Result<Octree> read_octree(const FieldFrame& frame, const Blocks& blocks) {
  const std::span<const char> letters = values_of<char>(blocks[kTree]);
  auto octree = Octree::decode(frame.resolution, {letters.data(), letters.size()},
                               Index(blocks[kSamples].size() / sizeof(float)));
  if (!octree) return corrupt_field(octree.error().message);
  if (blocks[kSamples].size() != octree->samples().size_bytes())
    return corrupt_field(fmt::format("it has {} bytes of samples, its octree has {}",
                                     blocks[kSamples].size(), octree->samples().size_bytes()));
  const std::span<const float> samples = values_of<float>(blocks[kSamples]);
  const float max_mm = float(frame.band_mm) * kSampleSlack;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!(std::abs(samples[i]) <= max_mm))  // Also rejects NaN.
      return corrupt_field(fmt::format("sample {} is {}", i, samples[i]));
    octree->samples()[i] = samples[i];
  }
  return octree;
}

Result<DenseSamples> read_dense(const FieldFrame& frame, const Blocks& blocks) {
  const auto n = std::size_t(frame.resolution) + 1;
  if (blocks[kSamples].size() != n * n * n * sizeof(float))
    return corrupt_field(fmt::format("it has {} bytes of samples", blocks[kSamples].size()));
  const std::span<const float> samples = values_of<float>(blocks[kSamples]);
  const float max_mm = float(frame.band_mm) * kSampleSlack;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (std::isfinite(samples[i]) && std::abs(samples[i]) > max_mm)
      return corrupt_field(fmt::format("sample {} is {}", i, samples[i]));
  return DenseSamples(frame.resolution, {samples.begin(), samples.end()});
}

/// \pre check_blocks_belong() holds.
Result<field::DistanceField::Samples> read_samples(const Header& header, const FieldFrame& frame,
                                                   const Blocks& blocks,
                                                   std::shared_ptr<const void> owner) {
  const auto storage = Storage(header.storage);
  if (storage == Storage::kBricks) return read_bricks(frame, blocks, std::move(owner));
  if (storage == Storage::kOctree) return read_octree(frame, blocks);
  return read_dense(frame, blocks);
}

/// Max distance of values beyond the band [cells]: 4.4 (build_distance_field.cpp) plus rounding.
constexpr double kSplineReach = 4.5;

Result<SparseLattice> read_lattice(const FieldFrame& frame, const Blocks& blocks) {
  const std::span<const std::int32_t> numbers = values_of<std::int32_t>(blocks[kSmoothBricks]);
  const std::span<const float> values = values_of<float>(blocks[kSmoothValues]);
  if (values.size_bytes() != blocks[kSmoothValues].size() ||
      numbers.size_bytes() != blocks[kSmoothBricks].size() ||
      values.size() != numbers.size() * SparseLattice::kBrickPoints)
    return corrupt_field(fmt::format("its smooth lattice has {} bricks and {} bytes of values",
                                     numbers.size(), blocks[kSmoothValues].size()));
  const std::int64_t side = SparseLattice::bricks_per_side(frame.resolution);
  std::int64_t previous = -1;
  for (const std::int32_t brick : numbers) {
    if (brick <= previous || brick >= side * side * side)
      return corrupt_field(fmt::format("brick {} follows brick {}", brick, previous));
    previous = brick;
  }
  SparseLattice lattice(frame.resolution, {numbers.begin(), numbers.end()}, 0.0F);
  const auto max_mm = float(frame.band_mm + kSplineReach * frame.cell_mm);
  for (std::size_t i = 0; i < values.size(); ++i) {  // NaN means no value.
    if (std::abs(values[i]) > max_mm)
      return corrupt_field(fmt::format("smooth value {} is {}", i, values[i]));
    lattice.values()[i] = values[i];
  }
  return lattice;
}

}  // namespace

std::string encode_field(const field::DistanceField& field) {
  const FieldFrame& frame = field.frame();
  Header header{};
  std::memcpy(header.magic, kFieldMagic.data(), kFieldMagic.size());
  header.version = kVersion;
  header.resolution = frame.resolution;
  for (int k = 0; k < 3; ++k) header.origin_mm[k] = frame.origin_B[k];
  header.cell_mm = frame.cell_mm;
  header.band_mm = frame.band_mm;
  header.tolerance_mm = frame.tolerance_mm;
  header.closed = frame.closed ? 1 : 0;
  header.smooth = field.is_smooth() ? 1 : 0;
  if (field.source()) set_source(*field.source(), header);

  Blocks blocks;
  std::string letters;
  if (const auto* bricks = std::get_if<BrickSamples>(&field.samples())) {
    header.storage = std::uint32_t(Storage::kBricks);
    blocks[kBrickTable] = bytes_of(bricks->bricks());
    blocks[kCodes] = bricks->codes();
  } else if (const auto* octree = std::get_if<Octree>(&field.samples())) {
    header.storage = std::uint32_t(Storage::kOctree);
    letters = octree->codes();
    blocks[kTree] = bytes_of(std::span<const char>(letters));
    blocks[kSamples] = bytes_of(octree->samples());
  } else {
    header.storage = std::uint32_t(Storage::kDense);
    blocks[kSamples] =
        bytes_of(std::span<const float>(std::get<DenseSamples>(field.samples()).values()));
  }
  if (const auto& smooth = field.smooth_lattice()) {
    blocks[kSmoothBricks] = bytes_of(smooth->brick_numbers());
    blocks[kSmoothValues] = bytes_of(smooth->values());
  }

  std::size_t size = sizeof(header);
  for (std::size_t b = 0; b < kBlockCount; ++b) {
    header.bytes[b] = blocks[b].size();
    size += aligned(blocks[b].size());
  }
  std::string bytes(size, '\0');
  std::size_t begin = sizeof(header);
  for (const auto& block : blocks) {
    if (!block.empty()) std::memcpy(bytes.data() + begin, block.data(), block.size());
    begin += aligned(block.size());
  }
  header.checksum =
      checksum_of(header, std::as_bytes(std::span<const char>(bytes)).subspan(sizeof(header)));
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

Result<field::DistanceField> decode_field(std::span<const std::byte> bytes,
                                          std::shared_ptr<const void> owner) {
  // Blocks are aligned to 64 bytes in the file, and their numbers are used in place.
  LEFORT_CHECK(reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::uint64_t) == 0);
  if (bytes.size() < kFieldMagic.size() ||
      std::memcmp(bytes.data(), kFieldMagic.data(), kFieldMagic.size()) != 0)
    return fail(ErrorCode::kFileUnsupported,
                "the file does not begin with lefortDF, so it is not a distance field");
  Header header{};
  if (bytes.size() < sizeof(header))
    return corrupt_field(
        fmt::format("it has {} bytes, the header alone has {}", bytes.size(), sizeof(header)));
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.version != kVersion)
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format("the distance field file has version {}, this program reads version {}; "
                    "build it again with `lefort field build`",
                    header.version, kVersion));
  const std::uint32_t found = checksum_of(header, bytes.subspan(sizeof(header)));
  if (found != header.checksum)
    return corrupt_field(
        fmt::format("its checksum is {:08x}, expected {:08x}: it was truncated or changed", found,
                    header.checksum));
  LEFORT_TRY(const Blocks blocks, find_blocks(header, bytes));
  LEFORT_TRY(const FieldFrame frame, frame_of(header));
  LEFORT_TRY_VOID(check_blocks_belong(header, blocks));
  LEFORT_TRY(auto samples,
             read_samples(header, frame, blocks, owner));  // Blocks are also read below.
  std::optional<SparseLattice> smooth;
  if (header.smooth == 1) {
    LEFORT_TRY(smooth, read_lattice(frame, blocks));
  }
  return field::DistanceField(frame, std::move(samples), std::move(smooth), source_of(header));
}

Result<void> write_field(const std::filesystem::path& path, const field::DistanceField& field) {
  if (path.extension() != ".field")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("distance field file {} must end in .field", path.string()));
  return write_text(path, encode_field(field));
}

Result<field::DistanceField> read_field(const std::filesystem::path& path) {
  LEFORT_TRY(MappedFile file, map_file(path));
  const std::span<const std::byte> bytes = file.bytes;
  auto field = decode_field(bytes, std::move(file.owner));
  if (!field)
    return fail(field.error().code, fmt::format("{}: {}", path.string(), field.error().message));
  return field;
}

}  // namespace lefort::io
