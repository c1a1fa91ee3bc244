#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/io/internal/write_nrrd.h>

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <new>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {
namespace {

static_assert(std::endian::native == std::endian::little);

/// A block is compressed without knowledge of the others, which costs about 0.1 % of the size.
constexpr std::size_t kBlockBytes = std::size_t(1) << 20;
/// Larger levels need more time and make scans smaller by a few percent.
constexpr int kLevel = 4;

struct Type {
  const char* name;
  std::size_t bytes;
};

Type type_of(ScalarType type) {
  switch (type) {
    case ScalarType::kUint8:
      return {"unsigned char", 1};
    case ScalarType::kInt16:
      return {"short", 2};
    case ScalarType::kFloat:
      return {"float", 4};
    default:
      break;
  }
  LEFORT_CHECK(!"this type is not written");
  return {"", 0};
}

/// A value of a key, with the escapes of the format.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n')
      result += "\\n";
    else if (c == '\\')
      result += "\\\\";
    else
      result += c;
  }
  return result;
}

std::string header_of(const RawVolumeView& volume) {
  const image::Grid& grid = volume.grid;
  const Type type = type_of(volume.type);
  std::string text = fmt::format(
      "NRRD0004\ntype: {}\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n"
      "space directions:",
      type.name, grid.size[0], grid.size[1], grid.size[2]);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step_mm = grid.spacing_mm[axis] * grid.direction.col(axis);
    text += fmt::format(" ({},{},{})", step_mm.x(), step_mm.y(), step_mm.z());
  }
  text += "\nkinds: domain domain domain\n";
  if (type.bytes > 1) text += "endian: little\n";
  text += fmt::format("encoding: gzip\nspace origin: ({},{},{})\n", grid.origin_L.x(),
                      grid.origin_L.y(), grid.origin_L.z());
  for (const auto& [key, value] : volume.fields) text += key + ":=" + escaped(value) + "\n";
  return text + "\n";
}

/// Part of a deflate stream that ends at a byte; the last one ends the stream.
std::string deflated(std::span<const unsigned char> bytes, bool is_last) {
  z_stream stream{};
  constexpr int kRaw = -15, kMemory = 8;  // The largest window, without a header.
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kRaw, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  constexpr std::size_t kFlush = 16;  // Bytes of an empty block and its padding.
  std::string packed(deflateBound(&stream, uLong(bytes.size())) + kFlush, '\0');
  stream.next_in = const_cast<Bytef*>(bytes.data());
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = uInt(packed.size());
  const int status = deflate(&stream, is_last ? Z_FINISH : Z_FULL_FLUSH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  LEFORT_CHECK(status == (is_last ? Z_STREAM_END : Z_OK));
  return packed;
}

std::string little_endian(std::uint32_t number) {
  return {reinterpret_cast<const char*>(&number), sizeof(number)};
}

/// Writes bytes as one gzip member (RFC 1952).
void write_gzip(std::ofstream& file, std::span<const unsigned char> bytes) {
  const std::size_t count =
      std::max<std::size_t>((bytes.size() + kBlockBytes - 1) / kBlockBytes, 1);
  std::vector<std::string> packed(count);
  std::vector<uLong> checksums(count);
  const auto block = [&](std::size_t n) {
    const std::size_t first = n * kBlockBytes;
    return bytes.subspan(first, std::min(kBlockBytes, bytes.size() - first));
  };
  parallel_for(Index(count), [&](Index k) {
    const auto n = std::size_t(k);
    packed[n] = deflated(block(n), n + 1 == count);
    checksums[n] = crc32(0, block(n).data(), uInt(block(n).size()));
  });
  constexpr std::array<char, 10> kHeader{'\x1f', '\x8b', 8, 0, 0, 0, 0, 0, 0, '\xff'};
  file.write(kHeader.data(), kHeader.size());
  uLong checksum = crc32(0, nullptr, 0);
  for (std::size_t n = 0; n < count; ++n) {
    file.write(packed[n].data(), std::streamsize(packed[n].size()));
    checksum = crc32_combine(checksum, checksums[n], z_off_t(block(n).size()));
  }
  file << little_endian(std::uint32_t(checksum)) << little_endian(std::uint32_t(bytes.size()));
}

}  // namespace

Result<void> write_nrrd(const std::filesystem::path& file, const RawVolumeView& volume) {
  std::ofstream out(file, std::ios::binary);
  out << header_of(volume);
  const std::size_t size = std::size_t(volume.grid.voxel_count()) * type_of(volume.type).bytes;
  write_gzip(out, {static_cast<const unsigned char*>(volume.values), size});
  out.close();
  if (!out) return fail(ErrorCode::kFileUnwritable, "the disk is full or failing");
  return {};
}

}  // namespace lefort::io
