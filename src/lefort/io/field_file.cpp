#include <lefort/io/field_file.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace lefort::io {

namespace {

using field::FieldFrame;
using field::SparseLattice;

// The file, little-endian, without padding:
//   header   magic, version, and the frame and counts below
//   codes    one letter per octree node (NodeCode), parents first
//   samples  float, mm, in the order of Octree::sample_points()
//   bricks   int32, numbers of the bricks of the smooth lattice, ascending
//   values   float, the coefficients of each brick
//   crc      uint32, CRC-32 of all bytes before it
static_assert(std::endian::native == std::endian::little,
              "values are copied as they lie in memory");

constexpr std::string_view kMagic = "lefortDF";
constexpr std::uint32_t kVersion = 1;
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t(1) << 33;
constexpr int kMaxResolution = 1024;
constexpr double kMaxCoordinate_mm = 1e7;

struct Header {
  char magic[8];
  std::uint32_t version;
  std::int32_t resolution;
  double origin_mm[3];
  double cell_mm;
  double band_mm;
  double tolerance_mm;
  std::uint64_t closed;  // 0 or 1.
  std::uint64_t code_count;
  std::uint64_t sample_count;
  std::uint64_t brick_count;
};
static_assert(sizeof(Header) == 96 && std::is_trivially_copyable_v<Header>);

constexpr std::size_t kBrickBytes =
    sizeof(std::int32_t) + SparseLattice::kBrickPoints * sizeof(float);

tl::unexpected<Error> corrupt(const std::string& what) {
  return fail(ErrorCode::kFileCorrupt, "the distance field file is damaged: " + what);
}

std::uint32_t checksum_of(std::string_view bytes) {
  return std::uint32_t(
      ::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

template <class T>
void append(std::string& bytes, std::span<const T> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// Moves `count` values from the front of `bytes`. \pre they are there.
template <class T>
std::vector<T> take(std::string_view& bytes, std::uint64_t count) {
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return values;
}

Result<Header> read_header(std::string_view bytes) {
  if (bytes.substr(0, kMagic.size()) != kMagic)
    return fail(ErrorCode::kFileUnsupported,
                "the file does not begin with lefortDF, as distance fields do");
  Header header{};
  if (bytes.size() < sizeof(header) + sizeof(std::uint32_t))
    return corrupt(
        fmt::format("it has {} bytes, its header alone has {}", bytes.size(), sizeof(header)));
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.version != kVersion)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the distance field file has version {}, this program reads version {}",
                            header.version, kVersion));
  return header;
}

/// Counts are compared with the size of the file before anything is allocated by them.
Result<void> check_size_and_checksum(const Header& header, std::string_view bytes) {
  const std::uint64_t size = bytes.size();
  const bool too_many = header.code_count > size || header.sample_count > size / sizeof(float) ||
                        header.brick_count > size / kBrickBytes;
  const std::uint64_t expected =
      too_many ? 0
               : sizeof(Header) + header.code_count + header.sample_count * sizeof(float) +
                     header.brick_count * kBrickBytes + sizeof(std::uint32_t);
  if (size != expected)
    return corrupt(fmt::format("it has {} bytes, its header says otherwise", size));
  std::uint32_t stored = 0;
  std::memcpy(&stored, bytes.data() + size - sizeof(stored), sizeof(stored));
  const std::uint32_t found = checksum_of(bytes.substr(0, size - sizeof(stored)));
  if (found != stored)
    return corrupt(fmt::format("its checksum is {:08x}, it should be {:08x}", found, stored));
  return {};
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
    return corrupt(fmt::format("its resolution is {}", frame.resolution));
  if (!(frame.origin_B.cwiseAbs().maxCoeff() <= kMaxCoordinate_mm && frame.origin_B.allFinite()))
    return corrupt("its origin is not finite");
  if (!(frame.cell_mm > 0.0 && frame.cell_mm <= kMaxCoordinate_mm))
    return corrupt(fmt::format("its cells are {} mm wide", frame.cell_mm));
  if (!(frame.band_mm > 0.0 && frame.band_mm <= frame.cell_mm * frame.resolution))
    return corrupt(fmt::format("its band is {} mm wide", frame.band_mm));
  if (!(frame.tolerance_mm >= 0.0 && frame.tolerance_mm <= kMaxCoordinate_mm))
    return corrupt(fmt::format("its tolerance is {} mm", frame.tolerance_mm));
  if (header.closed > 1) return corrupt("it does not say whether its surface is closed");
  return frame;
}

Result<field::Octree> read_octree(const Header& header, std::string_view& bytes) {
  std::string codes(bytes.substr(0, header.code_count));
  bytes.remove_prefix(header.code_count);
  auto octree = field::Octree::decode(header.resolution, std::move(codes));
  if (!octree) return corrupt(octree.error().message);
  if (octree->samples().size() != header.sample_count)
    return corrupt(fmt::format("it has {} samples, its octree has {}", header.sample_count,
                               octree->samples().size()));
  const auto samples = take<float>(bytes, header.sample_count);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i])) return corrupt(fmt::format("sample {} is {}", i, samples[i]));
    octree->samples()[i] = samples[i];
  }
  return octree;
}

Result<SparseLattice> read_lattice(const Header& header, std::string_view& bytes) {
  auto bricks = take<std::int32_t>(bytes, header.brick_count);
  const std::int64_t side = SparseLattice::bricks_per_side(header.resolution);
  std::int64_t previous = -1;
  for (const std::int32_t brick : bricks) {
    if (brick <= previous || brick >= side * side * side)
      return corrupt(fmt::format("brick {} follows brick {}", brick, previous));
    previous = brick;
  }
  SparseLattice lattice(header.resolution, std::move(bricks), 0.0F);
  const auto values = take<float>(bytes, header.brick_count * SparseLattice::kBrickPoints);
  for (std::size_t i = 0; i < values.size(); ++i) {  // NaN says that there is no coefficient.
    if (std::isinf(values[i])) return corrupt(fmt::format("coefficient {} is infinite", i));
    lattice.values()[i] = values[i];
  }
  return lattice;
}

}  // namespace

std::string encode_field(const field::DistanceField& field) {
  const FieldFrame& frame = field.frame();
  const field::Octree& octree = field.octree();
  const SparseLattice& smooth = field.smooth_lattice();
  Header header{};
  std::memcpy(header.magic, kMagic.data(), kMagic.size());
  header.version = kVersion;
  header.resolution = frame.resolution;
  for (int k = 0; k < 3; ++k) header.origin_mm[k] = frame.origin_B[k];
  header.cell_mm = frame.cell_mm;
  header.band_mm = frame.band_mm;
  header.tolerance_mm = frame.tolerance_mm;
  header.closed = frame.closed ? 1 : 0;
  header.code_count = octree.codes().size();
  header.sample_count = octree.samples().size();
  header.brick_count = std::uint64_t(smooth.brick_count());

  std::string bytes;
  bytes.reserve(sizeof(header) + header.code_count + header.sample_count * sizeof(float) +
                header.brick_count * kBrickBytes + sizeof(std::uint32_t));
  append(bytes, std::span<const Header>(&header, 1));
  bytes += octree.codes();
  append(bytes, octree.samples());
  append(bytes, smooth.brick_numbers());
  append(bytes, smooth.values());
  const std::uint32_t checksum = checksum_of(bytes);
  append(bytes, std::span<const std::uint32_t>(&checksum, 1));
  return bytes;
}

Result<field::DistanceField> decode_field(std::string_view bytes) {
  LEFORT_TRY(const Header header, read_header(bytes));
  LEFORT_TRY_VOID(check_size_and_checksum(header, bytes));
  LEFORT_TRY(const FieldFrame frame, frame_of(header));
  bytes.remove_prefix(sizeof(Header));
  LEFORT_TRY(field::Octree octree, read_octree(header, bytes));
  LEFORT_TRY(SparseLattice smooth, read_lattice(header, bytes));
  return field::DistanceField(frame, std::move(octree), std::move(smooth));
}

Result<void> write_field(const std::filesystem::path& path, const field::DistanceField& field) {
  if (path.extension() != ".field")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("distance field file {} must end in .field", path.string()));
  return write_text(path, encode_field(field));
}

Result<field::DistanceField> read_field(const std::filesystem::path& path) {
  LEFORT_TRY(const std::string bytes, read_text(path, kMaxFileBytes));
  auto field = decode_field(bytes);
  if (!field)
    return fail(field.error().code, fmt::format("{}: {}", path.string(), field.error().message));
  return field;
}

}  // namespace lefort::io
